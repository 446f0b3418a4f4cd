//! Smooth surfaces over a rectangle of two parameters.

use crate::vector::{Point, Vector};

use super::face::{Face, Jet};

/// Point of a surface as distances along the surface count from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unfolded {
    /// Point in space, with the part of the surface beyond an edge turned over about the edge.
    pub point: Point,
    /// Distance from the edge, mm, negative before it; minus infinity on a surface without one.
    pub beyond_mm: f64,
}

impl From<&Point> for Unfolded {
    /// Point of a surface without an edge.
    fn from(point: &Point) -> Self {
        Unfolded { point: *point, beyond_mm: f64::NEG_INFINITY }
    }
}

impl Jet {
    /// Length of the derivative by the second parameter of the surface displaced by `height_mm` along `u x v`.
    pub fn speed_mm(&self, height_mm: f64) -> f64 {
        if height_mm == 0.0 {
            return self.v.norm();
        }
        let across = self.u.cross(&self.v);
        let (length, normal) = (across.norm(), across.normalize());
        let turned = self.uv.cross(&self.v) + self.u.cross(&self.vv);
        (self.v + (turned - normal * normal.dot(&turned)) * (height_mm / length)).norm()
    }
}

/// Smooth surface over a rectangle of two parameters.
pub trait Surface {
    /// Point with its derivatives up to the second.
    fn jet(&self, at: [f64; 2]) -> Jet;

    /// Ranges of both parameters, lower ends first.
    fn ranges(&self) -> [[f64; 2]; 2];

    /// +1 if the first derivative cross the second one points away from the material, otherwise -1.
    fn outward(&self) -> f64;

    /// Point and unit normal, away from the material.
    fn point_and_normal(&self, at: [f64; 2]) -> (Point, Vector) {
        let jet = self.jet(at);
        (jet.point, jet.u.cross(&jet.v).normalize() * self.outward())
    }

    /// Height above the surface at which distances along the second parameter are measured, mm; above 0 on a surface over an edge, on which
    /// the normal turns while the point hardly moves.
    fn gauge_mm(&self) -> f64 {
        0.0
    }

    /// Whether the surface runs over an edge.
    fn is_over_edge(&self) -> bool {
        self.gauge_mm() > 0.0
    }

    /// Speed along the second parameter of the point at a height above the surface, mm.
    fn speed_mm(&self, at: [f64; 2], height_mm: f64) -> f64 {
        self.jet(at).speed_mm(height_mm * self.outward())
    }

    /// Point from which distances along the surface are measured in space.
    fn unfolded(&self, _at: [f64; 2], point: &Point) -> Unfolded {
        Unfolded::from(point)
    }
}

/// Side of a blade with its parameters in the order of Feng et al., the paper on repaired blades: the first from the root (0) to the tip
/// (1), the second from the leading (0) to the trailing edge (1).
#[derive(Clone, Copy, Debug)]
pub struct SpanwiseFace<'f>(pub &'f Face);

impl Surface for SpanwiseFace<'_> {
    fn jet(&self, [u, v]: [f64; 2]) -> Jet {
        let jet = self.0.jet(v, u);
        Jet { u: jet.v, v: jet.u, uu: jet.vv, vv: jet.uu, ..jet }
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        [[0.0, 1.0]; 2]
    }

    fn outward(&self) -> f64 {
        -self.0.outward()
    }
}
