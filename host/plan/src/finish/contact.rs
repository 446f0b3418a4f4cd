//! Contact between a finishing mill and a surface: its frame, the tool axis by tilt and yaw, and displaced surfaces.
//!
//! With n the unit normal away from the material and f the unit feed direction, square to n:
//!
//! ```text
//! t = R(n, yaw) (n cos tilt + f sin tilt)                                        (1)
//! S' = S + D n,   S'_u = S_u + D_u n + D n_u,   n' = unit(S'_u x S'_v)           (2)
//! n_u = (N_u - n (n . N_u)) / |N|,   N = S_u x S_v,   N_u = S_uu x S_v + S_u x S_uv
//! ```
//!
//! Source: Tournier 2006, section 3 and figure 4: u, f and n lie in one plane at first, then the tilt about the axis square to both, then the yaw
//! about n. The paper prints that axis as f x n and leaves the sense open. Its appendix decides: on the path of strategy 2 (tilt 5 degrees) the
//! axis leans forward of the normal, and in strategy 4 (30, 5 and -20 degrees) the axis turns by 50 degrees less than the normal. A positive tilt
//! leans the tool towards f, as (1) has it. (2) is differential geometry.

use nalgebra::{Rotation3, Unit};

use crate::geometry::face::Face;
use crate::vector::{Point, Vector};

/// Shortest component of a direction that still defines it.
const LEAST: f64 = 1e-9;

/// Contact of a finishing mill with a surface: contact point, normal and feed direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Contact point, C.
    pub point: Point,
    /// Unit normal n of the surface, away from the material.
    pub normal: Vector,
    /// Unit vector f of the feed direction, square to the normal.
    pub feed: Vector,
}

/// Orientation of the tool axis at a contact: tilt from the normal towards the feed direction, and yaw about the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Orientation {
    /// Angle of tilt; positive: the tool leans forward, towards the feed direction.
    pub tilt_rad: f64,
    /// Angle of yaw, by the right-hand rule about the normal.
    pub yaw_rad: f64,
}

/// Displacement of a surface along its normal at one point, with its derivatives by the surface's parameters u and v.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displacement {
    /// Displacement D, positive away from the material, mm.
    pub outward_mm: f64,
    /// Derivative of D by u, mm.
    pub by_u: f64,
    /// Derivative of D by v, mm.
    pub by_v: f64,
}

impl Contact {
    /// Contact at a point. The normal need not be a unit vector, nor the feed direction be square to it; `None` if they do not define a frame.
    pub fn new(point: Point, normal: &Vector, feed: &Vector) -> Option<Self> {
        let normal = normal.try_normalize(LEAST)?;
        let feed = (feed - normal * feed.dot(&normal)).try_normalize(LEAST * feed.norm())?;
        Some(Contact { point, normal, feed })
    }

    /// Tool axis, from the tip to the holder. (1)
    pub fn axis(&self, orientation: &Orientation) -> Vector {
        let (sin, cos) = libm::sincos(orientation.tilt_rad);
        let yaw = Rotation3::from_axis_angle(&Unit::new_unchecked(self.normal), orientation.yaw_rad);
        yaw * (self.normal * cos + self.feed * sin) // (1)
    }

    /// Tilt and yaw, relative to this contact's normal and feed direction, that give this tool axis by (1). Of the two solutions, the
    /// one whose tilt is 0 or positive.
    pub fn orientation(&self, axis: &Vector) -> Orientation {
        let across = self.normal.cross(&self.feed);
        let [along, beside, up] = [self.feed, across, self.normal].map(|direction| direction.dot(axis));
        let off = libm::hypot(along, beside);
        let yaw_rad = if off > LEAST { libm::atan2(beside, along) } else { 0.0 };
        Orientation { tilt_rad: libm::atan2(off, up), yaw_rad }
    }
}

/// Point and unit normal of a blade's side that is displaced along its normals. (2)
pub fn displaced(face: &Face, u: f64, v: f64, by: &Displacement) -> (Point, Vector) {
    let jet = face.jet(u, v);
    let across = jet.u.cross(&jet.v);
    let length = across.norm();
    let sense = libm::copysign(1.0, across.dot(&face.normal(u, v)));
    let normal = across * (sense / length);
    let along_normal = |derivative: Vector| (derivative - normal * normal.dot(&derivative)) * (sense / length);
    let normal_u = along_normal(jet.uu.cross(&jet.v) + jet.u.cross(&jet.uv));
    let normal_v = along_normal(jet.uv.cross(&jet.v) + jet.u.cross(&jet.vv));
    let surface_u = jet.u + normal * by.by_u + normal_u * by.outward_mm; // (2)
    let surface_v = jet.v + normal * by.by_v + normal_v * by.outward_mm;
    let turned = surface_u.cross(&surface_v) * sense;
    (jet.point + normal * by.outward_mm, turned.try_normalize(0.0).unwrap_or(normal))
}
