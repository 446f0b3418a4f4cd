//! Selection of the rays that a moving tool can meet, by bounding boxes, so that most rays need no computation.
//!
//! A slab lies in a box about it, which moves with it. At a row of rays only those s count at which the box is on that
//! row; they bound the columns and the stretch of the rays. Of these rays only those are asked that come as close to the
//! slab's axis, halfway along its way, as its radius and half of its way: seen along the rays, the axis is a line; where
//! the axis is one of the lattice's, [`flat`](super::flat) says it exactly. What is left then is the
//! stretch of the ray between the slab's two planes and within that cylinder, if its material is not all in the hole, or outside
//! (`slab_shape`). The same is asked of the rectangle about the material of neighbouring rays before it is of each of them.
//!
//! If the motion is perpendicular to such an axis, all slabs of a monotone part are cut at once: [`level`](super::level). On all other ways the
//! ball of a ball end mill is cut at once too, as what it is: [`ball`](super::ball).

use std::ops::Range;

use arcfeed_kinematics::vector::Vector;

use super::ball::{BallRow, BallSweep};
use super::band::Losses;
use super::dexel::{Dexel, Interval, NOWHERE};
use super::flat::Row;
use super::lattice::Lattice;
use super::level::{AxialRow, LayerRow, Level, UprightRow};
use super::section::Sweep;
use super::slab_shape::{MARGIN_MM, SlabShape};
use super::tool::Tool;

/// Part of a tool on one straight sweep, with its bounding box, prepared for rays of one direction.
#[derive(Clone, Copy, Debug)]
pub struct Pass<'a> {
    ray_axis: usize,
    /// Lowest and highest corner of the box at s = 0.
    corners_mm: [Vector; 2],
    motion_mm: Vector,
    shape: Shape<'a>,
}

/// Shape that a pass moves.
#[expect(clippy::large_enum_variant, reason = "a pass is made in place and read where it is")]
#[derive(Clone, Copy, Debug)]
enum Shape<'a> {
    /// All slabs of a monotone part, on a level.
    Level(Level<'a>),
    /// The ball of a ball end mill, on any way.
    Ball(BallSweep),
    /// One slab, on any way.
    Slab(SlabShape),
}

/// Material that the rays of one row lose in a pass, in the form that suits the direction of the rays and of the row.
#[derive(Clone, Debug)]
pub enum RowCut<'a> {
    /// The rays are parallel to the tool's axis, and the pass is perpendicular to that axis.
    Axial(AxialRow<'a>),
    /// The rays are perpendicular to the tool's axis, all at one height of the tool.
    Layer(LayerRow),
    /// The rays are perpendicular to the tool's axis and lie one above the other.
    Upright(UprightRow<'a>),
    /// The pass moves a ball.
    Ball(BallRow<'a>),
    /// Any other direction: each ray is computed on its own.
    Rays(&'a Pass<'a>),
}

/// Cut that is the same in several rows of rays.
#[derive(Clone, Debug)]
pub struct LayersCut {
    /// Indices of the rows.
    pub rows: Range<usize>,
    /// Index of the column to which the first entry of `losses` belongs.
    pub first: usize,
    /// Interval that the ray of each column loses, from column `first` on; it ends before it begins if the ray loses nothing.
    pub losses: Vec<Interval>,
}

impl LayersCut {
    /// Adds another cut of the same rows and returns true. If the rows differ, or a ray would lose two separate intervals, adds nothing
    /// and returns false.
    pub fn add(&mut self, other: &LayersCut) -> bool {
        let (columns, others) = (self.columns(), other.columns());
        let all = columns.start.min(others.start)..columns.end.max(others.end);
        let is_one = |column: usize| {
            let (one, next) = (self.at(column), other.at(column));
            let is_empty = |loss: &Interval| loss.from_mm > loss.to_mm;
            is_empty(&one) || is_empty(&next) || one.from_mm <= next.to_mm && next.from_mm <= one.to_mm
        };
        if self.rows != other.rows || !all.clone().all(is_one) {
            return false;
        }
        let both = |column: usize| {
            let (one, next) = (self.at(column), other.at(column));
            Interval::new(one.from_mm.min(next.from_mm), one.to_mm.max(next.to_mm))
        };
        self.losses = all.clone().map(both).collect();
        self.first = all.start;
        true
    }

    fn columns(&self) -> Range<usize> {
        self.first..self.first + self.losses.len()
    }

    fn at(&self, column: usize) -> Interval {
        let index = column.checked_sub(self.first);
        index.and_then(|index| self.losses.get(index)).copied().unwrap_or(NOWHERE)
    }
}

/// The rays of one row that a pass can meet, and the part of them that it can meet.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// Columns of the row, in two parts with a hollow between them.
    columns: [Range<usize>; 2],
    /// Coordinates along the rays between which the pass can meet them, the same for all rays of the row.
    pub along: Interval,
}

impl Reach {
    /// The same reach without these columns; the gap between the two ranges becomes part of the reach if it is not among them.
    pub fn without(&self, columns: &Range<usize>) -> Self {
        let [first, last] = self.parts();
        let (start, end) = (first.start, last.end);
        let [low, high] = [columns.start.clamp(start, end), columns.end.clamp(start, end)];
        Reach { columns: [start..low, high..end], along: self.along }
    }

    /// All columns of the row that the pass can meet.
    pub fn columns(&self) -> impl Iterator<Item = usize> {
        self.parts().into_iter().flatten()
    }

    /// The same columns as two ranges, in order; a range may be empty.
    pub fn parts(&self) -> [Range<usize>; 2] {
        self.columns.clone()
    }
}

/// Passes of all parts of a tool over all sweeps, for rays along `ray_axis`. Slabs of the tool that can be cut together are one
/// pass, and so is a ball.
pub fn passes<'a>(tool: &'a Tool, sweeps: &[Sweep], ray_axis: usize) -> Vec<Pass<'a>> {
    let (ball_mm, slabs) = tool.ball_and_slabs();
    let mut passes = Vec::with_capacity(sweeps.len() * tool.slabs().len());
    for sweep in sweeps {
        let pass = |corners_mm, shape| Pass { ray_axis, corners_mm, motion_mm: sweep.motion_mm(), shape };
        let around = |heights_mm, radius_mm| [-1.0, 1.0].map(|side| corner_mm(sweep, heights_mm, radius_mm, side));
        let levels = tool.parts().iter().filter_map(|part| {
            let level = Level::new(part, sweep, ray_axis)?;
            Some(pass(around(part.heights_mm(), part.extreme_radii().outer_mm), Shape::Level(level)))
        });
        let before = passes.len();
        passes.extend(levels);
        if passes.len() == before {
            passes.extend(ball_mm.map(|radius_mm| {
                let ball = BallSweep::new(radius_mm, sweep, ray_axis);
                pass(BallSweep::corners_mm(radius_mm, sweep, MARGIN_MM), Shape::Ball(ball))
            }));
            passes.extend(slabs.iter().map(|slab| {
                let shape = SlabShape::new(slab, sweep, ray_axis);
                pass(around(slab.heights_mm, slab.outer_mm[0].max(slab.outer_mm[1])), Shape::Slab(shape))
            }));
        }
    }
    passes
}

/// Whether a tool on a sweep can meet a box, given by its lowest and highest corner.
pub fn can_meet(tool: &Tool, sweep: &Sweep, corners_mm: &[Vector; 2]) -> bool {
    let slabs = tool.slabs();
    let radius_mm = slabs.iter().flat_map(|slab| slab.outer_mm).fold(0.0, f64::max);
    let low_mm = slabs.iter().map(|slab| slab.heights_mm[0]).fold(f64::INFINITY, f64::min);
    let high_mm = slabs.iter().map(|slab| slab.heights_mm[1]).fold(f64::NEG_INFINITY, f64::max);
    let [lowest_mm, highest_mm] = [-1.0, 1.0].map(|side| corner_mm(sweep, [low_mm, high_mm], radius_mm, side));
    let motion_mm = sweep.motion_mm();
    (0..3).all(|axis| {
        lowest_mm[axis] + motion_mm[axis].min(0.0) <= corners_mm[1][axis]
            && highest_mm[axis] + motion_mm[axis].max(0.0) >= corners_mm[0][axis]
    })
}

/// The lowest or the highest corner of the box around a part of a tool at the start of its way.
fn corner_mm(sweep: &Sweep, heights_mm: [f64; 2], radius_mm: f64, side: f64) -> Vector {
    [0, 1, 2].map(|axis| {
        let along = sweep.axis[axis];
        let ends = heights_mm.map(|height_mm| height_mm * along * side);
        let disc_mm = radius_mm * libm::sqrt((1.0 - along * along).max(0.0));
        sweep.from_mm[axis] + side * (ends[0].max(ends[1]) + disc_mm + MARGIN_MM)
    })
}

impl Pass<'_> {
    /// Lowest and highest corner of the box around this part of the tool where the sweep begins, mm; the motion of the sweep is not in it.
    pub fn box_mm(&self) -> [Vector; 2] {
        self.corners_mm
    }

    /// Indices of the rows of the lattice that the pass can meet.
    pub fn rows(&self, lattice: &Lattice) -> Range<usize> {
        let [_, row_axis] = Lattice::across(self.ray_axis);
        self.cells(lattice, row_axis)
    }

    /// Indices of the cells along `axis` that the pass can meet.
    pub fn cells(&self, lattice: &Lattice, axis: usize) -> Range<usize> {
        let Interval { from_mm, to_mm } = self.extent(axis, [0.0, 1.0]);
        lattice.cells_between(axis, from_mm, to_mm)
    }

    /// Rays that the pass can meet in the row at the coordinate `row_mm`; `None` if there are none.
    pub fn reach(&self, lattice: &Lattice, row_mm: f64) -> Option<Reach> {
        let [column_axis, _] = Lattice::across(self.ray_axis);
        let axes = [self.ray_axis, column_axis];
        let Row { across, hollow, along } = match &self.shape {
            Shape::Level(level) => level.reach(axes, row_mm, MARGIN_MM)?,
            Shape::Ball(ball) => ball.narrowed(self.boxed(row_mm)?, row_mm, MARGIN_MM)?,
            Shape::Slab(SlabShape { flat: Some(flat), .. }) => flat.narrowed(self.boxed(row_mm)?, axes, row_mm)?,
            Shape::Slab(_) => self.boxed(row_mm)?,
        };
        let columns = lattice.cells_between(column_axis, across.from_mm, across.to_mm);
        let hollow = hollow.map(|hollow| lattice.cells_between(column_axis, hollow.from_mm, hollow.to_mm));
        let hollow = hollow.unwrap_or(columns.end..columns.end);
        let parts = [columns.start..hollow.start.min(columns.end), hollow.end.max(columns.start)..columns.end];
        (!columns.is_empty()).then_some(Reach { columns: parts, along })
    }

    /// Part of the row at this coordinate that the box meets; `None` if there is none.
    fn boxed(&self, row_mm: f64) -> Option<Row> {
        let [column_axis, row_axis] = Lattice::across(self.ray_axis);
        let (low_mm, high_mm) = (self.corners_mm[0][row_axis], self.corners_mm[1][row_axis]);
        let motion_mm = self.motion_mm[row_axis];
        let mut during = [0.0_f64, 1.0_f64];
        if motion_mm != 0.0 {
            let ends = [(row_mm - low_mm) / motion_mm, (row_mm - high_mm) / motion_mm];
            during = [during[0].max(ends[0].min(ends[1])), during[1].min(ends[0].max(ends[1]))];
        } else if row_mm < low_mm || row_mm > high_mm {
            return None;
        }
        let [across, along] = [column_axis, self.ray_axis].map(|axis| self.extent(axis, during));
        (during[0] <= during[1]).then_some(Row { across, hollow: None, along })
    }

    /// Material that the rays of the row at the coordinate `row_mm` lose.
    #[inline]
    pub fn row_cut(&self, row_mm: f64) -> RowCut<'_> {
        let [column_axis, row_axis] = Lattice::across(self.ray_axis);
        match &self.shape {
            Shape::Slab(_) => RowCut::Rays(self),
            Shape::Ball(ball) => RowCut::Ball(ball.row(row_mm)),
            Shape::Level(level) if level.axis() == row_axis => RowCut::Layer(level.layer_row(row_mm)),
            Shape::Level(level) if level.axis() == column_axis => RowCut::Upright(level.upright_row(row_mm)),
            Shape::Level(level) => RowCut::Axial(level.axial_row(column_axis, row_mm)),
        }
    }

    /// The cut, if it is the same in all rows that the pass meets, with at most one interval for each ray; `None` otherwise.
    pub fn layers_cut(&self, lattice: &Lattice) -> Option<LayersCut> {
        let [column_axis, row_axis] = Lattice::across(self.ray_axis);
        let Shape::Level(level) = &self.shape else { return None };
        let loss = if level.axis() == row_axis { level.layer_loss()? } else { return None };
        let (columns, column_mm) = (self.cells(lattice, column_axis), lattice.centers_mm(column_axis));
        let (mut rows, row_mm) = (self.cells(lattice, row_axis), lattice.centers_mm(row_axis));
        // The box is wider than the part.
        rows.start += rows.clone().take_while(|row| !level.is_at(row_mm(*row))).count();
        rows.end -= rows.clone().rev().take_while(|row| !level.is_at(row_mm(*row))).count();
        Some(LayersCut { rows, first: columns.start, losses: columns.map(|column| loss(column_mm(column))).collect() })
    }

    /// Intervals that a ray loses on a level, or to a ball; `None` for single slabs.
    fn losses(&self, ray_point_mm: &Vector) -> Option<Losses> {
        let [column_mm, row_mm] = Lattice::across(self.ray_axis).map(|axis| ray_point_mm[axis]);
        match self.row_cut(row_mm) {
            RowCut::Axial(row) => Some([row.loss(column_mm), NOWHERE]),
            RowCut::Layer(row) => Some(row.losses(column_mm)),
            RowCut::Upright(mut row) => Some(row.losses(column_mm)),
            RowCut::Ball(row) => Some([row.loss(column_mm), NOWHERE]),
            RowCut::Rays(_) => None,
        }
    }

    /// Whether a ray through a point comes near enough to the pass to lose material; `dexel` is the material it still has.
    pub fn may_cut(&self, ray_point_mm: &Vector, dexel: &Dexel) -> bool {
        match &self.shape {
            // The loss itself is as fast to compute as this test.
            Shape::Level(_) | Shape::Ball(_) => true,
            Shape::Slab(shape) => match &shape.flat {
                Some(flat) => flat.may_cut(self.ray_axis, ray_point_mm, dexel),
                None => shape.is_near(self.ray_axis, ray_point_mm),
            },
        }
    }

    /// Whether the pass moves a slab whose axis is not one of the lattice's.
    pub fn is_tilted(&self) -> bool {
        matches!(&self.shape, Shape::Slab(shape) if shape.flat.is_none())
    }

    /// Whether any ray of a row, from the one through the first of two points to the one through the second, may lose
    /// material, all of which lies in the interval `extent`.
    pub fn may_cut_between(&self, ray_points_mm: [Vector; 2], extent: &Interval) -> bool {
        match &self.shape {
            Shape::Slab(shape) => shape.may_cut_rectangle(self.ray_axis, ray_points_mm, extent),
            Shape::Level(_) | Shape::Ball(_) => true,
        }
    }

    /// Removes the swept material from one ray of a row that has this reach; returns the removed length, mm.
    pub fn cut(&self, ray_point_mm: Vector, reach: &Reach, dexel: &mut Dexel) -> f64 {
        let Shape::Slab(shape) = &self.shape else {
            return self.losses(&ray_point_mm).into_iter().flatten().map(|loss| dexel.subtract(loss)).sum();
        };
        let mut removed_mm = 0.0;
        // Ends of spans may be off the ends of what is reached by rounding.
        let along = Interval::new(reach.along.from_mm - MARGIN_MM, reach.along.to_mm + MARGIN_MM);
        let stretch = shape.stretch(self.ray_axis, &ray_point_mm, &along, dexel);
        let may_lose = |stretch: &Interval| {
            let mut pieces = dexel.met(stretch);
            pieces.any(|piece| shape.may_cut_piece(self.ray_axis, ray_point_mm, &stretch.common(piece)))
        };
        if let Some(stretch) = stretch.filter(may_lose) {
            shape.section.for_each_span(ray_point_mm, &stretch, |span| removed_mm += dexel.subtract(span));
        }
        removed_mm
    }

    /// Intervals that the pass sweeps on the ray through a point, whether there is material or not.
    pub fn spans(&self, ray_point_mm: Vector) -> Vec<Interval> {
        let Shape::Slab(shape) = &self.shape else {
            return self.losses(&ray_point_mm).into_iter().flatten().filter(|loss| loss.length_mm() > 0.0).collect();
        };
        let mut spans = Vec::new();
        let along = self.extent(self.ray_axis, [0.0, 1.0]);
        shape.section.for_each_span(ray_point_mm, &along, |span| spans.push(span));
        spans
    }

    /// Range of the box along an axis while s is in the range `during`.
    fn extent(&self, axis: usize, during: [f64; 2]) -> Interval {
        let moved = during.map(|s| s * self.motion_mm[axis]);
        Interval {
            from_mm: self.corners_mm[0][axis] + moved[0].min(moved[1]),
            to_mm: self.corners_mm[1][axis] + moved[0].max(moved[1]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_kinematics::vector::{scaled, sum, unit};

    use crate::ball::tests::random;

    #[test]
    fn a_tilted_ball_is_a_ball_however_coarse_its_cones_are() {
        let axis = unit([0.6, 0.2, 0.8]).unwrap();
        let standing = Sweep { from_mm: scaled(axis, -3.0), to_mm: scaled(axis, -3.0), axis };
        let lowest_mm = |height_mm: f64| {
            let tool = Tool::ball(3.0, height_mm, 1.0).unwrap();
            let passes = passes(&tool, &[standing], 2);
            let spans = passes.iter().flat_map(|pass| pass.spans([-1.0, 2.0, 0.0]));
            spans.map(|span| span.from_mm).fold(f64::INFINITY, f64::min)
        };
        // The centre of the ball is the origin.
        assert!((lowest_mm(20.0) + 2.0).abs() < 1e-12, "{}", lowest_mm(20.0));
        // A mill that is lower than its ball has cones only, which are within the ball.
        assert!(lowest_mm(5.0) > -2.0 + 1e-3, "{}", lowest_mm(5.0));
    }

    #[test]
    fn rays_lose_to_a_tilted_ring_what_it_sweeps_and_nothing_in_its_hole() {
        let tool = Tool::ring([12.0, 9.0], 1.0, 8.0, 0.02).unwrap();
        let mut seed = 7;
        let (mut spared, mut cut) = (0, 0);
        for _ in 0..2000 {
            let mut vector = |scale: f64| [0; 3].map(|_: i32| scale * random(&mut seed));
            let (from_mm, motion_mm, axis) = (vector(8.0), vector(1.5), unit(vector(1.0)).unwrap());
            let sweep = Sweep { from_mm, to_mm: sum(from_mm, motion_mm), axis };
            let point_mm = vector(12.0);
            for pass in passes(&tool, &[sweep], 2) {
                let Some(reach) = pass.boxed(point_mm[1]) else { continue };
                let reach = Reach { columns: [0..0, 0..0], along: reach.along };
                let mut dexel = Dexel::One(Interval::new(-6.0, 6.0));
                let mut expected = dexel.clone();
                pass.cut(point_mm, &reach, &mut dexel);
                let may_cut = pass.may_cut_between([point_mm; 2], &Interval::new(-6.0, 6.0));
                assert!(may_cut || dexel.length_mm() == 12.0, "{sweep:?} {point_mm:?}");
                let spans = pass.spans(point_mm);
                spans.iter().for_each(|span| {
                    expected.subtract(*span);
                });
                let Shape::Slab(shape) = &pass.shape else { panic!("a tilted sweep") };
                spared += usize::from(!shape.may_cut_piece(2, point_mm, &Interval::new(-6.0, 6.0)));
                cut += usize::from(dexel.length_mm() < 12.0);
                assert!((dexel.length_mm() - expected.length_mm()).abs() < 1e-6, "{sweep:?} {point_mm:?}");
            }
        }
        assert!(spared > 100 && cut > 100, "{spared} {cut}");
    }
}
