//! Cut by a tool whose axis is a lattice axis, on a straight move perpendicular to it: three-axis milling at a constant height.
//!
//! At a height of the tool the sweep is that of a disc, less what is in the hole all the way; the way is straight, so the farthest
//! place of it is one of its ends:
//!
//! ```text
//! reached: distance to the way <= R, and distance to one of its ends >= r        (1)
//! ```
//!
//! Along the axis (1) is asked for the heights: [`monotone`](super::monotone). Across it the disc sweeps a [`band`](super::band).
//!
//! Source: own derivation.

use super::band::{Band, Losses};
use super::dexel::{Interval, NOWHERE};
use super::flat::Row;
use super::lattice::Lattice;
use super::monotone::{MonotonePart, Radii};
use super::section::Sweep;

/// Distance from a border of a part beyond which rounding cannot show on which side of it a ray is.
const BORDER_MM: f64 = 1e-4;

/// Part of a tool on a straight move perpendicular to the tool's axis, which is parallel to a lattice axis.
#[derive(Clone, Copy, Debug)]
pub struct Level<'a> {
    part: &'a MonotonePart,
    axis: usize,
    /// Coordinate of the tip along the axis, and that of a millimetre of height.
    tip_mm: f64,
    sign: f64,
    /// Both ends of the way; all coordinates, that along the axis without meaning.
    ends_mm: [[f64; 3]; 2],
    /// The way for lines along the rays or, of rays along the axis, along the columns.
    band: Band,
}

/// Cut of a row of rays that are parallel to the tool's axis.
#[derive(Clone, Debug)]
pub struct AxialRow<'a> {
    level: &'a Level<'a>,
    /// Coordinates of the ends of the way along the columns, and from there to the row.
    columns_mm: [f64; 2],
    offs_mm: [f64; 2],
    /// The way along columns and rows, and divided by the square of its length.
    way_mm: [f64; 2],
    per_way: [f64; 2],
    /// Coordinates of the columns whose rays lose all heights, and these.
    alike: (Interval, Interval),
}

/// Cut of a row of rays perpendicular to the tool's axis, all of which pass at one height of the tool.
#[derive(Clone, Debug)]
pub struct LayerRow {
    band: Band,
    radii: Option<Radii>,
}

/// Cut of a row of rays perpendicular to the tool's axis, which lie one above the other along that axis.
#[derive(Clone, Debug)]
pub struct UprightRow<'a> {
    level: &'a Level<'a>,
    band: Band,
    off_mm: f64,
    near: usize,
    /// Losses of the last ray, after the range of heights with the same losses.
    last: (Interval, Losses),
}

impl<'a> Level<'a> {
    /// Prepares a part of a tool on a sweep, for rays along `ray_axis`; `None` if the tool's axis is not a lattice axis, or the
    /// sweep is not perpendicular to it.
    pub fn new(part: &'a MonotonePart, sweep: &Sweep, ray_axis: usize) -> Option<Self> {
        let axis = (0..3).find(|axis| sweep.axis[*axis].abs() == 1.0)?;
        let is_level = sweep.from_mm[axis] == sweep.to_mm[axis];
        let ends_mm = [sweep.from_mm, sweep.to_mm];
        let line_axis = if ray_axis == axis { Lattice::across(axis)[0] } else { ray_axis };
        let band = Band::new(ends_mm.map(|end_mm| [end_mm[line_axis], end_mm[3 - line_axis - axis]]));
        is_level.then_some(Level { part, axis, tip_mm: sweep.from_mm[axis], sign: sweep.axis[axis], ends_mm, band })
    }

    /// Index of the lattice axis that is parallel to the tool's axis.
    pub fn axis(&self) -> usize {
        self.axis
    }

    /// Part of the row of rays along `ray_axis` at the coordinate `row_mm` that may lose material, widened by a margin;
    /// `None` if no ray of the row can lose any.
    pub fn reach(&self, [ray_axis, column_axis]: [usize; 2], row_mm: f64, margin_mm: f64) -> Option<Row> {
        let Radii { outer_mm, inner_mm } = self.part.extreme_radii();
        let [low_mm, high_mm] = self.part.heights_mm();
        let heights = self.stretch(&Interval::new(low_mm, high_mm));
        let row_axis = 3 - ray_axis - column_axis;
        if row_axis == self.axis {
            let Radii { outer_mm, .. } = self.part.radii(self.height_mm(row_mm), &mut 0)?;
            let within = |axis: usize| {
                let [from_mm, to_mm] = self.ends_mm.map(|end_mm| end_mm[axis]);
                wider(Interval::new(from_mm.min(to_mm), from_mm.max(to_mm)), outer_mm + margin_mm)
            };
            return Some(Row { across: within(column_axis), hollow: None, along: within(ray_axis) });
        }
        let chord = self.band.chord(row_mm, outer_mm)?;
        if ray_axis != self.axis {
            // Only where the part is wide enough to come to the row.
            let [low_mm, high_mm] = self.band.ends_mm().map(|[_, off_mm]| off_mm);
            let off_mm = (low_mm - row_mm).max(row_mm - high_mm).max(0.0);
            let across = wider(self.stretch(&self.part.wide(off_mm)?), margin_mm);
            return Some(Row { across, hollow: None, along: chord });
        }
        // A ray on the hole's border is asked.
        let hollow = inner_mm.and_then(|inner_mm| self.band.hollow(row_mm, (inner_mm - margin_mm).max(0.0)));
        Some(Row { across: chord, hollow, along: heights })
    }

    /// Cut of the row, at the coordinate `row_mm`, of rays parallel to the tool's axis.
    pub fn axial_row(&self, column_axis: usize, row_mm: f64) -> AxialRow<'_> {
        let row_axis = 3 - self.axis - column_axis;
        let [from_mm, to_mm] = self.ends_mm;
        let way_mm = [column_axis, row_axis].map(|axis| to_mm[axis] - from_mm[axis]);
        let square = way_mm[0] * way_mm[0] + way_mm[1] * way_mm[1];
        let narrowest_mm = self.part.narrowest_mm();
        let has_core = narrowest_mm > 0.0 && !self.part.is_hollow();
        let core = if has_core { self.band.chord(row_mm, narrowest_mm) } else { None };
        AxialRow {
            level: self,
            columns_mm: self.ends_mm.map(|end_mm| end_mm[column_axis]),
            offs_mm: self.ends_mm.map(|end_mm| row_mm - end_mm[row_axis]),
            way_mm,
            per_way: if square > 0.0 { way_mm.map(|part| part / square) } else { [0.0; 2] },
            alike: core
                .zip(self.part.wide(narrowest_mm))
                .map_or((NOWHERE, NOWHERE), |(chord, heights)| (wider(chord, -BORDER_MM), self.stretch(&heights))),
        }
    }

    /// Interval that a ray perpendicular to the tool's axis loses, as a function of its column's coordinate, if that interval is the
    /// same at every height of the part; `None` if it is not, or if the part has a hole.
    pub fn layer_loss(&self) -> Option<impl Fn(f64) -> Interval> {
        let Radii { outer_mm, inner_mm: None } = self.part.upright()? else { return None };
        Some(move |column_mm| self.band.chord(column_mm, outer_mm).unwrap_or(NOWHERE))
    }

    /// Whether the part of the tool extends to this coordinate along the tool's axis.
    pub fn is_at(&self, at_mm: f64) -> bool {
        self.part.radii(self.height_mm(at_mm), &mut 0).is_some()
    }

    /// Cut of a row of rays perpendicular to the tool's axis, all at the coordinate `row_mm` along that axis.
    pub fn layer_row(&self, row_mm: f64) -> LayerRow {
        LayerRow { band: self.band, radii: self.part.radii(self.height_mm(row_mm), &mut 0) }
    }

    /// Cut of a row of rays perpendicular to the tool's axis that lie one above the other; `row_mm` is their common coordinate across
    /// both.
    pub fn upright_row(&self, row_mm: f64) -> UprightRow<'_> {
        UprightRow { level: self, band: self.band, off_mm: row_mm, near: 0, last: (NOWHERE, [NOWHERE; 2]) }
    }

    /// Height of a coordinate along the axis.
    #[inline]
    fn height_mm(&self, at_mm: f64) -> f64 {
        (at_mm - self.tip_mm) * self.sign
    }

    /// The stretch along the axis of a stretch of heights.
    #[inline]
    fn stretch(&self, heights: &Interval) -> Interval {
        let [from_mm, to_mm] = [heights.from_mm, heights.to_mm].map(|height_mm| self.tip_mm + height_mm * self.sign);
        Interval::between(from_mm, to_mm)
    }
}

fn wider(interval: Interval, by_mm: f64) -> Interval {
    Interval::new(interval.from_mm - by_mm, interval.to_mm + by_mm)
}

/// Between 0 and 1. As comparisons: what is no number does not occur, and need not be kept.
#[inline]
fn clamped_ratio(part: f64) -> f64 {
    let part = if part > 0.0 { part } else { 0.0 };
    if part < 1.0 { part } else { 1.0 }
}

impl AxialRow<'_> {
    /// Range of column coordinates whose rays all lose the same interval, and that interval; both are empty if there is none.
    pub fn alike(&self) -> (Interval, Interval) {
        self.alike
    }

    /// Interval that the ray at a column's coordinate loses; it ends before it begins if the ray loses nothing. (1)
    #[inline]
    pub fn loss(&self, column_mm: f64) -> Interval {
        let arm_mm = column_mm - self.columns_mm[0];
        let off_mm = self.offs_mm[0];
        let part = clamped_ratio(arm_mm * self.per_way[0] + off_mm * self.per_way[1]);
        let length_mm = |a: f64, b: f64| libm::sqrt(a * a + b * b);
        let nearest_mm = length_mm(arm_mm - part * self.way_mm[0], off_mm - part * self.way_mm[1]);
        let part = self.level.part;
        let mut heights = part.wide(nearest_mm);
        if part.is_hollow() {
            let far_mm = length_mm(arm_mm, off_mm).max(length_mm(column_mm - self.columns_mm[1], self.offs_mm[1]));
            let narrow = part.narrow(far_mm);
            heights = heights.zip(narrow).map(|(wide, narrow)| wide.common(&narrow));
        }
        heights.map_or(NOWHERE, |heights| self.level.stretch(&heights))
    }
}

impl LayerRow {
    /// Intervals that the ray at a column's coordinate loses.
    #[inline]
    pub fn losses(&self, column_mm: f64) -> Losses {
        self.radii.map_or([NOWHERE; 2], |radii| self.band.losses(column_mm, &radii))
    }
}

impl UprightRow<'_> {
    /// Range of column coordinates whose rays all lose the same interval, and that interval; both are empty if there is none.
    pub fn alike(&self) -> (Interval, Interval) {
        let Some(Radii { outer_mm, inner_mm: None }) = self.level.part.upright() else { return (NOWHERE, NOWHERE) };
        let [low_mm, high_mm] = self.level.part.heights_mm();
        let columns = self.level.stretch(&Interval::new(low_mm, high_mm));
        (wider(columns, -BORDER_MM), self.band.chord(self.off_mm, outer_mm).unwrap_or(NOWHERE))
    }

    /// Intervals that the ray at a column's coordinate loses. Calls with neighbouring columns in order are the fastest.
    #[inline]
    pub fn losses(&mut self, column_mm: f64) -> Losses {
        let height_mm = self.level.height_mm(column_mm);
        let (same, losses) = &self.last;
        if same.from_mm <= height_mm && height_mm <= same.to_mm {
            return *losses;
        }
        let part = self.level.part;
        let radii = part.radii(height_mm, &mut self.near);
        let losses = radii.map_or([NOWHERE; 2], |radii| self.band.losses(self.off_mm, &radii));
        self.last = (part.same_radii(self.near).unwrap_or(NOWHERE), losses);
        losses
    }
}
