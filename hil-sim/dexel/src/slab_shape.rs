//! One slab of a tool on a straight sweep of any direction: bounds of what it can cut of a ray, so that few rays need the conics of
//! [`section`](super::section).
//!
//! Source: own derivation.

use arcfeed_kinematics::vector::{Vector, difference, dot, length, scaled, sum};

use super::dexel::Interval;
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
    pub flat: Option<SlabSweep>,
    axis: Vector,
    motion_mm: Vector,
    /// The tip halfway.
    halfway_mm: Vector,
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
        let half_rise_mm = dot(motion_mm, sweep.axis).abs() / 2.0;
        let half_way_mm = length(motion_mm) / 2.0;
        let low = across.map(|axis| sweep.from_mm[axis] + motion_mm[axis] / 2.0 + low_mm * sweep.axis[axis]);
        SlabShape {
            section: Section::new(slab, sweep, ray_axis),
            line_mm: [low, across.map(|axis| (high_mm - low_mm) * sweep.axis[axis])],
            near_mm: radius_mm + half_way_mm + MARGIN_MM,
            hole_mm: slab.inner_mm.map_or(0.0, |inner| (inner[0].min(inner[1]) - MARGIN_MM).max(0.0)),
            flat: SlabSweep::new(slab, sweep, MARGIN_MM),
            axis: sweep.axis,
            motion_mm,
            halfway_mm: sum(sweep.from_mm, scaled(motion_mm, 0.5)),
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

    /// Whether a piece of a ray stays in the slab's hole over the whole way. The distance of a point from the axis is a convex function
    /// of the place on the ray and on the way, so it is largest at the ends of both.
    pub fn spares(&self, mut ray_point_mm: Vector, ray_axis: usize, piece: &Interval) -> bool {
        let half = scaled(self.motion_mm, 0.5);
        [piece.from_mm, piece.to_mm].iter().all(|at_mm| {
            ray_point_mm[ray_axis] = *at_mm;
            let arm = difference(ray_point_mm, self.halfway_mm);
            [difference(arm, half), sum(arm, half)].iter().all(|arm| {
                let height_mm = dot(*arm, self.axis);
                dot(*arm, *arm) - height_mm * height_mm < self.hole_mm * self.hole_mm
            })
        })
    }

    /// Part of `along` in which a ray may meet the slab, which does not reach beyond `along`.
    pub fn stretch(&self, ray_axis: usize, ray_point_mm: &Vector, along: &Interval) -> Option<Interval> {
        let [low_mm, high_mm] = self.heights_mm;
        let along_u = self.axis[ray_axis];
        // From the tip, halfway, to the ray's point at 0.
        let mut w = [0, 1, 2].map(|axis| ray_point_mm[axis] - self.halfway_mm[axis]);
        w[ray_axis] = -self.halfway_mm[ray_axis];
        let height_mm = dot(w, self.axis);
        let mut stretch = *along;
        if along_u.abs() > STEEP_RATIO {
            let ends = [(low_mm - height_mm) / along_u, (high_mm - height_mm) / along_u];
            stretch = stretch.common(&Interval::new(ends[0].min(ends[1]), ends[0].max(ends[1])));
        }
        let square = 1.0 - along_u * along_u;
        if square > STEEP_RATIO {
            let half = w[ray_axis] - height_mm * along_u;
            let rest = dot(w, w) - height_mm * height_mm - self.near_mm * self.near_mm;
            let root = libm::sqrt(half * half - square * rest);
            if root.is_nan() {
                return None;
            }
            stretch = stretch.common(&Interval::new((-half - root) / square, (-half + root) / square));
        }
        (stretch.length_mm() > 0.0).then_some(stretch)
    }
}
