//! Nominal blade about which points were measured: both sides and the hub.

use nalgebra::Rotation3;
use thiserror::Error;

use super::registration::{NominalFoot, median};
use super::scan::{HeightSample, NominalSurface};
use crate::geometry::blisk::{Blisk, Revolution};
use crate::geometry::edge_strip::BladeEdge;
use crate::geometry::face::Face;
use crate::geometry::flaws::BladeSide;
use crate::geometry::surface::{Foot, SpanwiseFace};
use crate::parallel;
use crate::vector::{Point, Vector};

/// Median distance above which points are not those of this blade, mm.
const OFF_MAX_MM: f64 = 1.0;
/// Median distance up to which no other reading of the points is considered, mm.
const OFF_SOUND_MM: f64 = 0.1;
/// Improvement by another reading of the points that decides for it.
const BETTER_RATIO: f64 = 4.0;
/// Points that are compared with the blade.
const COMPARED: usize = 500;
/// Fewest points on a side that is repaired.
const POINTS_LEAST: usize = 100;
/// Other units: name of the unit of the points, and its factor.
const UNITS: [(&str, f64); 6] = [
    ("inches read as millimetres", 25.4),
    ("metres read as millimetres", 1000.0),
    ("centimetres read as millimetres", 10.0),
    ("millimetres read as inches", 1.0 / 25.4),
    ("millimetres read as metres", 1.0 / 1000.0),
    ("millimetres read as centimetres", 1.0 / 10.0),
];

/// Part of a blade that is repaired.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RepairedPart {
    /// One side, without its edges.
    Side(BladeSide),
    /// Both sides about an edge.
    Edge(BladeEdge),
}

/// One blade of a rotor as nominal surfaces.
pub struct NominalBlade<'f> {
    pressure: NominalSurface<'f>,
    suction: NominalSurface<'f>,
    hub: &'f Revolution,
    blades: u32,
}

/// Reason why measured points cannot be those of the blade to be repaired.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CloudFault {
    /// The points fit if they are read in another unit.
    #[error(
        "the points lie {off_mm:.1} mm off the blade, but fit as {unit}: set `units` in [measured] to that of the points"
    )]
    Unit {
        /// Median distance as they are read.
        off_mm: f64,
        /// Unit that fits.
        unit: &'static str,
    },
    /// The points fit if they are mirrored.
    #[error(
        "the points lie {off_mm:.1} mm off the blade, but their mirror image in {axis} fits: the points or the part's `hand` are mirrored"
    )]
    Mirrored {
        /// Median distance as they are read.
        off_mm: f64,
        /// Axis that is mirrored.
        axis: &'static str,
    },
    /// The points fit another blade of the rotor.
    #[error(
        "the points lie {off_mm:.1} mm off this blade, but fit blade {blade}: set `blade` in [nominal] to {blade}, or measure this one"
    )]
    OtherBlade {
        /// Median distance as they are read.
        off_mm: f64,
        /// Number of the blade that fits.
        blade: u32,
    },
    /// The points fit neither in another unit, nor mirrored, nor another blade.
    #[error(
        "the points lie {off_mm:.1} mm off the blade (median), and neither other units, nor a mirror image, nor another blade fit: give them in the part's frame, z along the rotor's axis"
    )]
    Far {
        /// Median distance.
        off_mm: f64,
    },
    /// Weld stands beyond the tip's face.
    #[error(
        "weld stands {beyond_mm:.2} mm beyond the tip at ({}), and the tip's face is not planned: take off all that stands more than `threshold` beyond it, and measure anew", place(.point)
    )]
    OverTip {
        /// Greatest height above the tip.
        beyond_mm: f64,
        /// Measured point with that height.
        point: Point,
    },
    /// Weld stands in front of an edge, and one side alone is to be repaired.
    #[error(
        "weld stands {beyond_mm:.2} mm in front of the {edge} edge at ({}), and `side = \"{side}\"` plans nothing there: set `side` in [nominal] to \"{edge}\", or take off all that stands more than `threshold` in front of that edge, and measure anew", place(.point)
    )]
    OverEdge {
        /// Greatest height in front of the edge.
        beyond_mm: f64,
        /// Measured point with that height.
        point: Point,
        /// Edge.
        edge: &'static str,
        /// Side that is to be repaired.
        side: &'static str,
    },
    /// Many points stand apart from their neighbours.
    #[error(
        "{percent:.1} % of the points are outliers: they lie more than {off_mm:.2} mm (`threshold`) outside of the heights of their neighbours, the farthest {apart_mm:.2} mm at ({}): take them out, or measure anew", place(.point)
    )]
    Outliers {
        /// Share of the outliers.
        percent: f64,
        /// Distance from which on a point is one.
        off_mm: f64,
        /// Distance of the farthest one.
        apart_mm: f64,
        /// The farthest one.
        point: Point,
    },
    /// Too few points lie on the side that is to be repaired.
    #[error(
        "{found} of {points} points lie on the {side} side, and 100 at least are needed: measure that side, or set `side` in [nominal]"
    )]
    OtherSide {
        /// Points on the side.
        found: usize,
        /// All points.
        points: usize,
        /// Side.
        side: &'static str,
    },
}

fn place(point: &Point) -> String {
    format!("{:.2}, {:.2}, {:.2}", point.x, point.y, point.z)
}

/// Pressure and suction side of the blade with this number, from 1, in the rotor's own frame.
pub fn sides(blisk: &Blisk, blade: u32) -> [Face; 2] {
    let angle_rad = f64::from(blade.saturating_sub(1)) * blisk.pitch_rad();
    let turn = Rotation3::from_axis_angle(&Vector::z_axis(), angle_rad);
    [blisk.pressure.turned(&turn), blisk.suction.turned(&turn)]
}

impl<'f> NominalBlade<'f> {
    /// First blade of a rotor, of which `faces` are the sides: pressure, suction.
    pub fn new([pressure, suction]: [&'f Face; 2], blisk: &'f Blisk) -> Self {
        NominalBlade {
            pressure: NominalSurface::new(SpanwiseFace(pressure)),
            suction: NominalSurface::new(SpanwiseFace(suction)),
            hub: &blisk.hub,
            blades: blisk.blades,
        }
    }

    /// Surface of a side.
    pub fn side(&self, side: BladeSide) -> &NominalSurface<'f> {
        match side {
            BladeSide::Pressure => &self.pressure,
            BladeSide::Suction => &self.suction,
        }
    }

    /// Nearest point of blade and hub to a measured point, with the outward normal there.
    pub fn foot(&self, point: &Point) -> NominalFoot {
        let (_, foot, on) = self.nearest_side(point);
        let hub_mm = self.hub.height_mm(point);
        if hub_mm.abs() < foot.distance_mm {
            let normal = self.hub.normal(point);
            return NominalFoot { point: point - normal * hub_mm, normal };
        }
        on
    }

    fn nearest_side(&self, point: &Point) -> (BladeSide, Foot, NominalFoot) {
        let [pressure, suction] = [&self.pressure, &self.suction].map(|side| side.foot_and_normal(point));
        if suction.0.distance_mm < pressure.0.distance_mm {
            (BladeSide::Suction, suction.0, suction.1)
        } else {
            (BladeSide::Pressure, pressure.0, pressure.1)
        }
    }

    /// Heights above one side of the points that lie nearest to it; `stylus_mm` is subtracted.
    ///
    /// # Errors
    /// There are too few.
    pub fn heights(&self, points: &[Point], side: BladeSide, stylus_mm: f64) -> Result<Vec<HeightSample>, CloudFault> {
        let sample = |point: &Point| {
            let (nearest, foot, on) = self.nearest_side(point);
            let is_hub = self.hub.height_mm(point).abs() < foot.distance_mm;
            let is_of_side = nearest == side && !is_hub && !foot.is_on_border;
            let height_mm = on.normal.dot(&(point - on.point)) - stylus_mm;
            is_of_side.then_some(HeightSample { at: foot.at, height_mm })
        };
        let found = parallel::filter_map(points, &sample);
        let word = if side == BladeSide::Pressure { "pressure" } else { "suction" };
        if found.len() < POINTS_LEAST {
            return Err(CloudFault::OtherSide { found: found.len(), points: points.len(), side: word });
        }
        Ok(found)
    }

    /// Heights above both sides about an edge; `stylus_mm` is subtracted. Points on the hub, beyond the tip and in front of the other edge are not used.
    ///
    /// # Errors
    /// There are too few on one of the sides.
    pub fn edge_heights(
        &self,
        points: &[Point],
        strip: &NominalSurface<'_>,
        stylus_mm: f64,
    ) -> Result<Vec<HeightSample>, CloudFault> {
        let sample = |point: &Point| {
            let (foot, on) = strip.foot_and_normal(point);
            let is_hub = self.hub.height_mm(point).abs() < foot.distance_mm;
            let height_mm = on.normal.dot(&(point - on.point)) - stylus_mm;
            let is_beyond = strip.surface().unfolded(foot.at, &foot.point).beyond_mm > 0.0;
            (!is_hub && !foot.is_on_border).then_some((is_beyond, HeightSample { at: foot.at, height_mm }))
        };
        let found = parallel::filter_map(points, &sample);
        for (is_beyond, side) in [(false, "pressure"), (true, "suction")] {
            let count = found.iter().filter(|(beyond, _)| *beyond == is_beyond).count();
            if count < POINTS_LEAST {
                return Err(CloudFault::OtherSide { found: count, points: points.len(), side });
            }
        }
        Ok(found.into_iter().map(|(_, sample)| sample).collect())
    }

    /// Checks that points are those of this blade, `blade` of the rotor, in its frame and in millimetres. Ball centres lie `stylus_mm` off it.
    ///
    /// # Errors
    /// Names the reading of the points that fits, if one does.
    pub fn check(&self, points: &[Point], blade: u32, stylus_mm: f64) -> Result<(), CloudFault> {
        let every = points.len().div_ceil(COMPARED).max(1);
        let compared: Vec<Point> = points.iter().step_by(every).copied().collect();
        let off_by = |read: &(dyn Fn(&Point) -> Point + Sync)| {
            let off = |point: &Point| {
                let point = read(point);
                let foot = self.foot(&point);
                (foot.normal.dot(&(point - foot.point)) - stylus_mm).abs().min((point - foot.point).norm())
            };
            median(&parallel::map(&compared, &off))
        };
        let off_mm = off_by(&|point| *point);
        if off_mm <= OFF_SOUND_MM {
            return Ok(());
        }
        let units = UNITS.iter().map(|(unit, factor)| (off_by(&|p| p * *factor), CloudFault::Unit { off_mm, unit }));
        let mirrored = ["x", "y", "z"].into_iter().enumerate().map(|(k, axis)| {
            let read = move |point: &Point| {
                let mut other = *point;
                other[k] = -other[k];
                other
            };
            (off_by(&read), CloudFault::Mirrored { off_mm, axis })
        });
        let pitch_rad = core::f64::consts::TAU / f64::from(self.blades);
        let turned = (1..self.blades).map(|k| {
            let turn = Rotation3::from_axis_angle(&Vector::z_axis(), -f64::from(k) * pitch_rad);
            let number = (blade - 1 + k) % self.blades + 1;
            (off_by(&|point| turn * point), CloudFault::OtherBlade { off_mm, blade: number })
        });
        let best = turned.chain(mirrored).chain(units).min_by(|a, b| a.0.total_cmp(&b.0));
        match best {
            Some((other_mm, fault)) if other_mm < off_mm / BETTER_RATIO && other_mm < OFF_MAX_MM => Err(fault),
            _ if off_mm > OFF_MAX_MM => Err(CloudFault::Far { off_mm }),
            _ => Ok(()),
        }
    }
}
