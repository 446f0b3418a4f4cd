//! How near a piece of a body can come to a piece of the tool over a stretch of the way.
//!
//! Known are the distance d of one point x from the tool, in one pose, and how it grows: c with the distance a of x from the tool's axis,
//! altogether by the gradient g. The way is an arc with tangent t and curvature n (towards its centre, one over its radius), or a line, h long to both sides
//! of the pose. The points of the piece are no farther than e from x, no farther than f seen along the axis, and g . (q - x) >= -s. No distance grows faster
//! than the way:
//!
//! ```text
//! distance >= d - e - h                                                                                       (1)
//! ```
//!
//! In the half plane through the axis a tool's section is convex, so there the distance lies above its tangent: in space it is at least
//! d + g . delta but for how the distance from the axis, b = |delta| off across it and b_t of that sideways, leaves its own tangent:
//!
//! ```text
//! sqrt((a + b_r)^2 + b_t^2) - a - b_r <= b^2 / (2 a)           mean of squares above geometric mean            (2)
//!                                     >= b_t^2 / (2 (a + b))                                                  (3)
//! ```
//!
//! Over the way, tau along it, delta is t tau + n tau^2 / 2 with b^2 <= tau^2 and n's part in (1 - cos), so, with cross products between way and piece
//! apart,
//!
//! ```text
//! distance >= d - s - |g . t| h - max(g . n - c / a, 0) h^2 / 2 + c (f^2 / 2 + f h) / a           c < 0: from within   (4)
//! distance >= d - s - |g . t| h - max(g . n, 0) h^2 / 2                                           c >= 0               (5)
//! distance >= d - s - |g . t| h - max(g . n - c T / m, 0) h^2 / 2 - c f h / m                     c >= 0, m = a + f + h (6)
//! T = u^2 (1 - k^2 / 3) - |u w| k,   u, w = t sideways of x and along it,   k = |n| h
//! ```
//!
//! (4) and (6) lose nothing of second order where the tool turns about the very point that it is near to, as it does on most of its way
//! here. Our own derivation.

use crate::vector::Vector;

use super::motion::Pose;
use super::section::Section;

/// A point near a section of the tool.
pub struct Near {
    /// d, mm; negative inside.
    pub distance_mm: f64,
    /// g, a unit vector.
    pub gradient: Vector,
    /// a
    axis_mm: f64,
    /// From the axis to the point, a unit vector.
    outward: Vector,
    /// c
    across: f64,
}

/// What a piece of a body is, seen from its middle.
pub struct Extent {
    /// e
    pub radius_mm: f64,
    /// f
    pub across_mm: f64,
    /// s
    pub sink_mm: f64,
}

/// A lower bound, and what it loses by the lengths of way and piece.
pub struct Bound {
    /// No point is nearer, mm.
    pub least_mm: f64,
    /// By the way.
    pub way_mm: f64,
    /// By the piece of the body.
    pub piece_mm: f64,
}

impl Near {
    /// A point by its place relative to the middle of the tool's bottom.
    pub fn new(section: &Section, place: &Vector) -> Self {
        let axis_mm = libm::hypot(place.x, place.y);
        let [across, up] = section.slope(axis_mm, place.z);
        let outward = if axis_mm > 0.0 { Vector::new(place.x, place.y, 0.0) / axis_mm } else { Vector::x() };
        let gradient = outward * across + Vector::z() * up;
        Near { distance_mm: section.distance_mm(axis_mm, place.z), gradient, axis_mm, outward, across }
    }

    /// The best of (1) and (4) to (6), for a stretch of so much to both sides.
    pub fn bound(&self, pose: &Pose, half_mm: f64, extent: &Extent) -> Bound {
        let (way_mm, piece_mm) = if self.across < 0.0 {
            self.inner_losses_mm(pose, half_mm, extent.across_mm)
        } else {
            self.outer_losses_mm(pose, half_mm, extent.across_mm)
        };
        let along_mm = half_mm * self.gradient.dot(&pose.tangent).abs();
        let (way_mm, piece_mm) = (way_mm + along_mm, piece_mm + extent.sink_mm);
        if way_mm + piece_mm < half_mm + extent.radius_mm {
            Bound { least_mm: self.distance_mm - way_mm - piece_mm, way_mm, piece_mm }
        } else {
            let (way_mm, piece_mm) = (half_mm, extent.radius_mm);
            Bound { least_mm: self.distance_mm - way_mm - piece_mm, way_mm, piece_mm } // (1)
        }
    }

    /// What (4) loses by second order, a half of what both make for each.
    fn inner_losses_mm(&self, pose: &Pose, half_mm: f64, across_mm: f64) -> (f64, f64) {
        let per_mm = -self.across / self.axis_mm;
        let bend_per_mm = (self.gradient.dot(&pose.curvature) + per_mm).max(0.0);
        let both_mm = per_mm * across_mm * half_mm / 2.0;
        (bend_per_mm * half_mm * half_mm / 2.0 + both_mm, per_mm * across_mm * across_mm / 2.0 + both_mm)
    }

    /// The same of the better of (5) and (6).
    fn outer_losses_mm(&self, pose: &Pose, half_mm: f64, across_mm: f64) -> (f64, f64) {
        let toward_per_mm = self.gradient.dot(&pose.curvature);
        let plain_mm = toward_per_mm.max(0.0) * half_mm * half_mm / 2.0;
        let turn_rad = pose.curvature.norm() * half_mm;
        let (sideways, radial) = (self.outward.cross(&pose.tangent).z.abs(), self.outward.dot(&pose.tangent).abs());
        let sideways = sideways * (sideways * (1.0 - turn_rad * turn_rad / 3.0) - radial * turn_rad);
        let per_mm = self.across / (self.axis_mm + across_mm + half_mm);
        let both_mm = per_mm * across_mm * half_mm;
        let bent_mm = (toward_per_mm - per_mm * sideways.max(0.0)).max(0.0) * half_mm * half_mm / 2.0;
        if plain_mm < bent_mm + both_mm { (plain_mm, 0.0) } else { (bent_mm + both_mm / 2.0, both_mm / 2.0) }
    }
}
