//! Rounding of corners, so that the axes can follow: it joins the path's derivatives where two moves meet.
//!
//! With p the path length from the corner, Dd and Dc the jumps of the first and second derivative there, h the half
//! width:
//!
//! ```text
//! q(p) = moves(p) + h (1 - |x|)^3/6 (Dd + p Dc/2)     x = p/h, |x| < 1      (1)
//! ```
//!
//! The added term removes both jumps, and ends with two derivatives of zero at x = +-1. The path misses the corner by
//! |Dd| h/6, and a change of curvature by at most 0.0088 |Dc| h^2; the first may use three quarters of the tolerance,
//! the second the rest. Each corner of a move may use half of the move. The rule is the same for all axes, X to C.
//!
//! The rounding adds to the derivatives of the moves |Dd|/h and a sixteenth of |Dc| in q'', and |Dd|/h^2 + 3/2 |Dc|/h
//! in q'''; no rounding of this width has a smaller q''' for Dd.
//!
//! Source: rounding by polynomials that join derivatives is common (Beudaert, Lavernhe, Tournier, 5-axis local corner
//! rounding of linear tool path discontinuities, Int. J. Machine Tools & Manufacture 73 (2013), with B-splines); (1) is
//! ours.

use crate::drives::limits::{AXES, Bend, DriveLimits};

use super::path::Travel;

/// Largest half width of a corner, mm.
const HALF_MAX: f64 = 1.0;
/// Jumps of direction and curvature below this are rounding errors of end points.
const STRAIGHT: f64 = 1e-9;
/// Distance by which the path misses a corner, and a change of curvature.
const MISS: f64 = 1.0 / 6.0;
const BEND_MISS: f64 = 0.0088;
/// Fraction of the tolerance for each.
const SHARES: [f64; 2] = [0.75, 0.25];

/// Rounding of the corner between two moves, which keeps the path within the corner tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Junction {
    /// Length of the rounding on each side of the corner, along the path; 0 if the corner is not rounded.
    pub half_mm: f64,
    first: [f64; AXES],
    second: [f64; AXES],
}

impl Junction {
    /// Rounding between two consecutive moves that are executed without a stop between them.
    pub fn new(before: &Travel, after: &Travel, drives: &DriveLimits) -> Self {
        let ([out, bent_out], [into, bent_into]) = (before.derivatives_at(1.0), after.derivatives_at(0.0));
        let first = difference(&into, &out);
        let second = difference(&bent_into, &bent_out);
        let room = 0.5 * before.length_mm.min(after.length_mm);
        let half = if greatest(&first) < STRAIGHT && greatest(&second) < STRAIGHT {
            0.0
        } else {
            let allowed = |tolerance: f64, of: std::ops::Range<usize>| {
                let [corner, bend] = [norm(&first[of.clone()]), norm(&second[of])];
                let of_corner = SHARES[0] * tolerance / (MISS * corner);
                of_corner.min(libm::sqrt(SHARES[1] * tolerance / (BEND_MISS * bend)))
            };
            let linear = allowed(drives.tolerance_mm, 0..3);
            linear.min(allowed(drives.tolerance_deg, 3..AXES)).min(room).min(HALF_MAX)
        };
        Junction { half_mm: half, first, second }
    }

    /// Displacement of the axes, mm or degrees, that the rounding adds to the moves at `way_mm` after the corner (negative: before). (1)
    pub fn rounding(&self, way_mm: f64) -> [f64; AXES] {
        let left = 1.0 - way_mm.abs() / self.half_mm;
        if !left.is_finite() || left <= 0.0 {
            return [0.0; AXES];
        }
        let part = self.half_mm * left * left * left / 6.0;
        std::array::from_fn(|axis| part * (self.first[axis] + 0.5 * way_mm * self.second[axis]))
    }

    /// Bounds of the path's derivatives inside the rounded corner.
    pub fn bend(&self, before: &Travel, after: &Travel) -> Bend {
        let moves = before.bend().or(&after.bend());
        if self.half_mm == 0.0 {
            return moves;
        }
        let Junction { half_mm: half, first, second } = self;
        let second_of = |axis: usize| moves.second[axis] + second[axis].abs() / 16.0 + first[axis].abs() / half;
        let third_of = |axis: usize| moves.third[axis] + (first[axis].abs() / half + 1.5 * second[axis].abs()) / half;
        Bend { first: moves.first, second: std::array::from_fn(second_of), third: std::array::from_fn(third_of) }
    }
}

fn difference(one: &[f64; AXES], other: &[f64; AXES]) -> [f64; AXES] {
    std::array::from_fn(|axis| one[axis] - other[axis])
}

fn norm(of: &[f64]) -> f64 {
    libm::sqrt(of.iter().map(|component| component * component).sum())
}

fn greatest(of: &[f64; AXES]) -> f64 {
    of.iter().fold(0.0, |most, component| most.max(component.abs()))
}
