//! Lower bound of the distance between a piece of a body and a piece of the tool over an interval of the path.
//!
//! Known are the distance d of one point x from the tool, in one pose, and its growth: c with the distance a of x from
//! the tool's axis, in all by the gradient g. The path is an arc with tangent t and curvature n (towards its centre,
//! one over its radius), or a line, and extends h to both sides of the pose. The points of the piece are at most e from
//! x, at most f seen along the axis, and g . (q - x) >= -s. No distance grows faster than the path:
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
//! Over the path, tau along it, delta is t tau + n tau^2 / 2 with b^2 <= tau^2 and n's part in (1 - cos). So, with the
//! cross products between path and piece separated,
//!
//! ```text
//! distance >= d - s - |g . t| h - max(g . n - c / a, 0) h^2 / 2 + c (f^2 / 2 + f h) / a           c < 0: from within   (4)
//! distance >= d - s - |g . t| h - max(g . n, 0) h^2 / 2                                           c >= 0               (5)
//! distance >= d - s - |g . t| h - max(g . n - c T / m, 0) h^2 / 2 - c f h / m                     c >= 0, m = a + f + h (6)
//! T = u^2 (1 - k^2 / 3) - |u w| k,   u, w = t sideways of x and along it,   k = |n| h
//! ```
//!
//! (4) and (6) lose nothing of second order where the tool turns about the very point that it is near to, as it does on
//! most of its path here. Our own derivation.

use crate::vector::Vector;

use super::motion::Pose;
use super::section::Section;

/// Point near a section of the tool, with its distance and gradient.
pub struct NearPoint {
    /// Distance of the point from the tool, mm; negative inside; d in (1).
    pub distance_mm: f64,
    /// Gradient of this distance, a unit vector; g in (4) to (6).
    pub gradient: Vector,
    /// Distance of the point from the tool's axis, mm; a.
    axis_mm: f64,
    /// Unit vector from the axis to the point.
    outward: Vector,
    /// c
    across: f64,
}

/// Size of a piece of a body around its middle point x, in three measures.
pub struct Extent {
    /// Largest distance of the piece's points from x, mm; e in (1).
    pub radius_mm: f64,
    /// The same, seen along the tool's axis (distances square to it), mm; f in (4) and (6).
    pub across_mm: f64,
    /// Length by which the piece's points are nearer to the tool than x, along the gradient of the distance, mm; s in (4) to (6).
    pub sink_mm: f64,
}

/// Lower bound of a distance, and how much of it is due to the lengths of path and piece.
pub struct DistanceBound {
    /// Lower bound of the distance, mm.
    pub least_mm: f64,
    /// Loss by the path.
    pub way_mm: f64,
    /// Loss by the piece of the body.
    pub piece_mm: f64,
}

impl NearPoint {
    /// Point given relative to the middle of the tool's bottom.
    pub fn new(section: &Section, place: &Vector) -> Self {
        let axis_mm = libm::hypot(place.x, place.y);
        let [across, up] = section.slope(axis_mm, place.z);
        let outward = if axis_mm > 0.0 { Vector::new(place.x, place.y, 0.0) / axis_mm } else { Vector::x() };
        let gradient = outward * across + Vector::z() * up;
        NearPoint { distance_mm: section.distance_mm(axis_mm, place.z), gradient, axis_mm, outward, across }
    }

    /// Best of the bounds (1) and (4) to (6), for an interval of `half_mm` to both sides.
    pub fn bound(&self, pose: &Pose, half_mm: f64, extent: &Extent) -> DistanceBound {
        let (way_mm, piece_mm) = if self.across < 0.0 {
            self.inner_losses_mm(pose, half_mm, extent.across_mm)
        } else {
            self.outer_losses_mm(pose, half_mm, extent.across_mm)
        };
        let along_mm = half_mm * self.gradient.dot(&pose.tangent).abs();
        let (way_mm, piece_mm) = (way_mm + along_mm, piece_mm + extent.sink_mm);
        if way_mm + piece_mm < half_mm + extent.radius_mm {
            DistanceBound { least_mm: self.distance_mm - way_mm - piece_mm, way_mm, piece_mm }
        } else {
            let (way_mm, piece_mm) = (half_mm, extent.radius_mm);
            DistanceBound { least_mm: self.distance_mm - way_mm - piece_mm, way_mm, piece_mm } // (1)
        }
    }

    /// Second-order losses of (4) by path and piece; the mixed term is split equally.
    fn inner_losses_mm(&self, pose: &Pose, half_mm: f64, across_mm: f64) -> (f64, f64) {
        let per_mm = -self.across / self.axis_mm;
        let bend_per_mm = (self.gradient.dot(&pose.curvature) + per_mm).max(0.0);
        let both_mm = per_mm * across_mm * half_mm / 2.0;
        (bend_per_mm * half_mm * half_mm / 2.0 + both_mm, per_mm * across_mm * across_mm / 2.0 + both_mm)
    }

    /// The same for the better of (5) and (6).
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
