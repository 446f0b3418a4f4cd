//! One slab of a tool on a straight sweep of any direction: bounds of what it can cut of a ray, so that few rays need the conics of
//! [`section`](super::section).
//!
//! Source: own derivation.

use arcfeed_kinematics::vector::{Vector, difference, dot, length, scaled, sum};

use super::dexel::{Dexel, Interval};
use super::flat::SlabSweep;
use super::lattice::Lattice;
use super::section::{Section, Sweep};
use super::slab::Slab;

/// By how much boxes are wider than what they hold, for rounding.
pub const MARGIN_MM: f64 = 1e-7;

/// Below this a ray counts as lying in a plane, or along an axis.
const STEEP_RATIO: f64 = 1e-3;

/// One slab, and which rays it may cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlabShape {
    pub section: Section,
    /// The line that is the axis as seen along the rays, halfway: its lower end, to its upper end, and how near it is near.
    line_mm: [[f64; 2]; 2],
    near_mm: f64,
    /// Distance from the axis within which the hole spares everything; 0 without a hole.
    hole_mm: f64,
    /// Distance from the axis from which on nothing is cut.
    outer_mm: f64,
    pub flat: Option<SlabSweep>,
    axis: Vector,
    /// The tip halfway, and half of the way across the axis.
    halfway_mm: Vector,
    half_across_mm: Vector,
    /// The slab's planes, wider by half of the way along the axis.
    heights_mm: [f64; 2],
}

impl SlabShape {
    /// Prepares a slab on a sweep for rays along `ray_axis`.
    pub fn new(slab: &Slab, sweep: &Sweep, ray_axis: usize) -> Self {
        let radius_mm = slab.outer_mm[0].max(slab.outer_mm[1]);
        let motion_mm = sweep.motion_mm();
        let across = Lattice::across(ray_axis);
        let [low_mm, high_mm] = slab.heights_mm;
        let half_mm = scaled(motion_mm, 0.5);
        let half_across_mm = across_axis(half_mm, sweep.axis);
        let half_rise_mm = dot(half_mm, sweep.axis).abs();
        let half_way_mm = length(half_mm);
        let low = across.map(|axis| sweep.from_mm[axis] + motion_mm[axis] / 2.0 + low_mm * sweep.axis[axis]);
        SlabShape {
            section: Section::new(slab, sweep, ray_axis),
            line_mm: [low, across.map(|axis| (high_mm - low_mm) * sweep.axis[axis])],
            near_mm: radius_mm + half_way_mm + MARGIN_MM,
            hole_mm: slab.inner_mm.map_or(0.0, |inner| (inner[0].min(inner[1]) - MARGIN_MM).max(0.0)),
            flat: SlabSweep::new(slab, sweep, MARGIN_MM),
            outer_mm: radius_mm + MARGIN_MM,
            axis: sweep.axis,
            halfway_mm: sum(sweep.from_mm, half_mm),
            half_across_mm,
            heights_mm: [low_mm - half_rise_mm - MARGIN_MM, high_mm + half_rise_mm + MARGIN_MM],
        }
    }

    /// Whether a ray comes as near to the slab's axis as its radius and half of its way.
    pub fn is_near(&self, ray_axis: usize, ray_point_mm: &Vector) -> bool {
        let across = Lattice::across(ray_axis);
        let [low, line] = self.line_mm;
        let arm = [ray_point_mm[across[0]] - low[0], ray_point_mm[across[1]] - low[1]];
        let square = line[0] * line[0] + line[1] * line[1];
        let along = arm[0] * line[0] + arm[1] * line[1];
        let part = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
        let off = [arm[0] - part * line[0], arm[1] - part * line[1]];
        off[0] * off[0] + off[1] * off[1] <= self.near_mm * self.near_mm
    }

    /// Whether a piece of a ray may lose material to the slab, wherever it lies between the slab's planes.
    pub fn may_cut_piece(&self, ray_axis: usize, ray_point_mm: Vector, piece: &Interval) -> bool {
        let [first, last] = self.ends_across(ray_axis, ray_point_mm, piece);
        let line = difference(last, first);
        // No number where the ray is parallel to the axis.
        let part = -dot(first, line) / dot(line, line);
        let nearest = sum(first, scaled(line, if part > 0.0 { part.min(1.0) } else { 0.0 }));
        !self.misses(&[first, last], nearest)
    }

    /// Whether a rectangle may lose material to the slab: the piece `extent` of all rays of a row between two of them,
    /// which go through these points.
    pub fn may_cut_rectangle(&self, ray_axis: usize, ray_points_mm: [Vector; 2], extent: &Interval) -> bool {
        let heights_mm = ray_points_mm.map(|point_mm| dot(self.arm_mm(ray_axis, point_mm, 0.0), self.axis));
        let heights_mm = [heights_mm[0].min(heights_mm[1]), heights_mm[0].max(heights_mm[1])];
        let piece = self.between_planes(heights_mm, self.axis[ray_axis], extent);
        if piece.from_mm >= piece.to_mm {
            return false;
        }
        let [[a, b], [c, d]] = ray_points_mm.map(|point_mm| self.ends_across(ray_axis, point_mm, &piece));
        !self.misses(&[a, b, c, d], sum(sum(a, b), sum(c, d)))
    }

    /// From the slab's axis halfway to both ends of a piece of a ray, across the axis.
    fn ends_across(&self, ray_axis: usize, ray_point_mm: Vector, piece: &Interval) -> [Vector; 2] {
        [piece.from_mm, piece.to_mm].map(|at_mm| across_axis(self.arm_mm(ray_axis, ray_point_mm, at_mm), self.axis))
    }

    /// From the tip halfway to the place of a ray at this coordinate along it.
    fn arm_mm(&self, ray_axis: usize, mut ray_point_mm: Vector, at_mm: f64) -> Vector {
        ray_point_mm[ray_axis] = at_mm;
        difference(ray_point_mm, self.halfway_mm)
    }

    /// Whether all points between `corners` (from the axis halfway, across it) stay in the slab's hole over the whole way, or outside of the
    /// slab. The distance of a point from the axis is a convex function of the point and of the place on the way, so it is largest at
    /// corners and ends. Points that are all farther in one direction than the slab ever comes are outside: any direction `toward` will do.
    fn misses(&self, corners: &[Vector], toward: Vector) -> bool {
        let half = self.half_across_mm;
        let is_in_hole = |corner: &Vector| {
            let [one, other] = [difference(*corner, half), sum(*corner, half)];
            dot(one, one).max(dot(other, other)) < self.hole_mm * self.hole_mm
        };
        let farthest = self.outer_mm * length(toward) + dot(half, toward).abs();
        corners.iter().all(is_in_hole) || corners.iter().all(|corner| dot(*corner, toward) > farthest)
    }

    /// Part of `along` in which a ray with this material may meet the slab; it does not reach beyond `along`.
    pub fn stretch(&self, ray_axis: usize, ray_point_mm: &Vector, along: &Interval, dexel: &Dexel) -> Option<Interval> {
        let along_u = self.axis[ray_axis];
        let w = self.arm_mm(ray_axis, *ray_point_mm, 0.0);
        let height_mm = dot(w, self.axis);
        let stretch = self.between_planes([height_mm, height_mm], along_u, along);
        if !dexel.meets(&stretch) {
            return None;
        }
        let square = 1.0 - along_u * along_u;
        if square <= STEEP_RATIO {
            return Some(stretch);
        }
        let half = w[ray_axis] - height_mm * along_u;
        let rest = dot(w, w) - height_mm * height_mm - self.near_mm * self.near_mm;
        let root = libm::sqrt(half * half - square * rest);
        if root.is_nan() {
            return None;
        }
        let stretch = stretch.common(&Interval::new((-half - root) / square, (-half + root) / square));
        (stretch.length_mm() > 0.0).then_some(stretch)
    }

    /// Part of `along` that is between the slab's planes on rays that have at 0 the lowest, the highest, or a height between.
    fn between_planes(&self, [lowest_mm, highest_mm]: [f64; 2], along_u: f64, along: &Interval) -> Interval {
        if along_u.abs() <= STEEP_RATIO {
            return *along;
        }
        let [low_mm, high_mm] = self.heights_mm;
        let per_height = 1.0 / along_u;
        along.common(&Interval::between((low_mm - highest_mm) * per_height, (high_mm - lowest_mm) * per_height))
    }
}

/// Part of a vector across an axis of length 1.
fn across_axis(vector: Vector, axis: Vector) -> Vector {
    difference(vector, scaled(axis, dot(vector, axis)))
}
