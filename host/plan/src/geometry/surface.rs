//! Smooth surfaces over a rectangle of two parameters, and their points nearest to a point in space.
//!
//! ```text
//! S = Q - r(u, v),  g = (S.r_u, S.r_v)
//! [E - S.r_uu  F - S.r_uv; F - S.r_uv  G - S.r_vv] (du, dv)' = g                                              (1)
//! [E F; F G] (du, dv)' = g            where the matrix of (1) is not positive                                 (2)
//! g' [E F; F G]^-1 g <= e^2           the part of S in the tangent plane is no longer than e                  (3)
//! ```
//!
//! Source: Feng et al., *Tool path planning in milling of repaired blades of blisks*, eqs 1 to 3, for which (2) alone is meant: it multiplies the
//! error by distance times normal curvature and finds nothing where that is above 1. (1) is Newton's step on the same problem. The step is halved
//! while the distance grows. At a border of the patch the parameter beyond it stands still.

use super::face::{Face, Jet};
use crate::vector::{Point, Vector};

/// e of (3), mm.
const TANGENT_MM: f64 = 1e-10;
/// Limit of the steps, more than a search needs.
const STEPS_MAX: usize = 200;
/// Limit of the halvings of one step.
const HALVINGS_MAX: usize = 40;

/// Point of a surface as distances along the surface count from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unfolded {
    /// Point in space, with the part of the surface beyond an edge turned over about the edge.
    pub point: Point,
    /// Distance from the edge, mm, negative before it; minus infinity on a surface without one.
    pub beyond_mm: f64,
}

/// Foot: point of a surface that is nearest to a given point in space.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    /// Parameters u and v of the foot.
    pub at: [f64; 2],
    /// Position of the foot.
    pub point: Point,
    /// Distance between both points, mm, not negative.
    pub distance_mm: f64,
    /// Whether the foot lies on the border of the surface.
    pub is_on_border: bool,
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
pub trait Surface: Sync {
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

    /// Nearest point to a point in space, found by iteration from the parameters `seed`.
    fn foot(&self, point: &Point, seed: [f64; 2]) -> Foot {
        let ranges = self.ranges();
        let inside = |at: [f64; 2]| [0, 1].map(|k: usize| at[k].clamp(ranges[k][0], ranges[k][1]));
        let mut at = inside(seed);
        let mut jet = self.jet(at);
        for _ in 0..STEPS_MAX {
            let Some(step) = step(&jet, point, at, ranges) else { break };
            let square = (point - jet.point).norm_squared();
            let shorter = (0..HALVINGS_MAX).find_map(|halvings| {
                let share = libm::ldexp(1.0, -(halvings as i32));
                let next = inside([at[0] + step[0] * share, at[1] + step[1] * share]);
                let there = self.jet(next);
                ((point - there.point).norm_squared() < square).then_some((next, there))
            });
            let Some((next, there)) = shorter else { break };
            (at, jet) = (next, there);
        }
        let is_on_border = [0, 1].iter().any(|k: &usize| at[*k] <= ranges[*k][0] || at[*k] >= ranges[*k][1]);
        Foot { at, point: jet.point, distance_mm: (point - jet.point).norm(), is_on_border }
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

/// Step (1) or (2); `None` at the nearest point (3).
fn step(jet: &Jet, point: &Point, at: [f64; 2], ranges: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let away = point - jet.point;
    let gradient = [away.dot(&jet.u), away.dot(&jet.v)];
    let is_held = [0, 1]
        .map(|k: usize| (at[k] <= ranges[k][0] && gradient[k] < 0.0) || (at[k] >= ranges[k][1] && gradient[k] > 0.0));
    let metric = [jet.u.norm_squared(), jet.u.dot(&jet.v), jet.v.norm_squared()];
    let bend = [away.dot(&jet.uu), away.dot(&jet.uv), away.dot(&jet.vv)];
    let hessian = [0, 1, 2].map(|k: usize| metric[k] - bend[k]);
    match is_held {
        [true, true] => None,
        [false, false] => step_inside(gradient, metric, hessian),
        [first_held, _] => {
            let k = usize::from(first_held);
            let (square, curved) = (metric[2 * k], hessian[2 * k]);
            if gradient[k] * gradient[k] <= TANGENT_MM * TANGENT_MM * square {
                return None;
            }
            let mut step = [0.0; 2];
            step[k] = gradient[k] / if curved > 0.0 { curved } else { square };
            Some(step)
        }
    }
}

fn step_inside(gradient: [f64; 2], metric: [f64; 3], hessian: [f64; 3]) -> Option<[f64; 2]> {
    let [u, v] = gradient;
    let solved = |[a, b, c]: [f64; 3]| {
        let determinant = a * c - b * b;
        let [a, b, c] = [a, b, c].map(|entry| entry / determinant);
        (determinant != 0.0).then_some([c * u - b * v, a * v - b * u])
    };
    let is_positive = |[a, b, c]: [f64; 3]| a > 0.0 && a * c - b * b > 0.0;
    let flat = solved(metric)?;
    if flat[0] * u + flat[1] * v <= TANGENT_MM * TANGENT_MM {
        return None; // (3)
    }
    let newton = if is_positive(hessian) { solved(hessian) } else { None };
    Some(newton.unwrap_or(flat)) // (1), (2)
}
