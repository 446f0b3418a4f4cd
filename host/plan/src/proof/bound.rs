//! How near a piece of a body can come to a piece of the tool over a stretch of the way.
//!
//! Known are the distance d of one point x from the tool, in one pose, and its gradient g. The way is an arc of radius rho (or a line), h long
//! to both sides of the pose, with tangent t and unit normal n to its centre; the points q of the body's piece are no farther than e from x,
//! and g . (q - x) no less than -s. Then for all of them, and all along the stretch
//!
//! ```text
//! distance >= d - e - h                                                                                       (1)
//! distance >= d - s - |g . t| h - max(g . n, 0) h^2 / (2 rho) - k (e + h)^2 / (2 a)                           (2)
//! ```
//!
//! (1) because no distance grows faster than the way. (2) with k = 0 where the tool is seen from without: the distance from a convex solid is
//! a convex function, which lies above its tangent plane; and a ring there is as far as the disc it is part of, elsewhere farther. Seen from within a ring is not
//! convex. But its distance is a convex function of radius and height which falls no faster than the radius grows, so distance and radius
//! together are convex in space, and with the mean of squares as an upper bound of the geometric mean the radius is
//!
//! ```text
//! |q| <= (|q|^2 + |x|^2) / (2 |x|) = |x| + x . (q - x) / |x| + |q - x|^2 / (2 |x|)                            (3)
//! ```
//!
//! hence k = 1, a = |x| the distance from the tool's axis. Where the tool slides along a body, (2) loses only by the square of the
//! pieces' size. Both are our own derivations.

use crate::vector::Vector;

use super::motion::Pose;
use super::section::Section;

/// A point near a section of the tool.
pub struct Near {
    /// Its distance, mm; negative inside.
    pub distance_mm: f64,
    /// How it grows with the point's place: a unit vector.
    pub gradient: Vector,
    /// How far the point is from the tool's axis.
    axis_mm: f64,
    /// Whether the ring is seen from within.
    is_within: bool,
}

/// What a piece of a body is, seen from its middle.
pub struct Extent {
    /// How far it reaches.
    pub radius_mm: f64,
    /// How far it reaches against the gradient.
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
        Near {
            distance_mm: section.distance_mm(axis_mm, place.z),
            gradient: outward * across + Vector::z() * up,
            axis_mm,
            is_within: across < 0.0,
        }
    }

    /// The better of (1) and (2).
    pub fn bound(&self, pose: &Pose, half_mm: f64, extent: &Extent) -> Bound {
        let reach_mm = extent.radius_mm + half_mm;
        let curve_per_mm = if self.is_within { 1.0 / (2.0 * self.axis_mm) } else { 0.0 };
        let along = self.gradient.dot(&pose.tangent).abs();
        let bend_per_mm = self.gradient.dot(&pose.curvature).max(0.0) / 2.0;
        let way_mm = half_mm * (along + bend_per_mm * half_mm + curve_per_mm * reach_mm);
        let piece_mm = extent.sink_mm + curve_per_mm * reach_mm * extent.radius_mm;
        if way_mm + piece_mm < reach_mm {
            Bound { least_mm: self.distance_mm - way_mm - piece_mm, way_mm, piece_mm } // (2)
        } else {
            Bound { least_mm: self.distance_mm - reach_mm, way_mm: half_mm, piece_mm: extent.radius_mm } // (1)
        }
    }
}
