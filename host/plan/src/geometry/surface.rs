//! Smooth surfaces over a rectangle of two parameters.

use crate::vector::{Point, Vector};

use super::face::{Face, Jet};

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
}

/// Side of a blade with its parameters in the order of the repair's source: the first from the root (0) to the tip (1), the second from the
/// leading (0) to the trailing edge (1).
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
