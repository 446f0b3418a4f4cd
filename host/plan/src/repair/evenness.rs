//! Rigid motion with the greatest least allowance, within the tolerances of the datums.
//!
//! ```text
//! max tau:  D_i + n_i.(t + omega x (q_i - c)) >= tau,  |t_k| <= t_m,  |omega_k| <= w_m                       (1)
//! ```
//!
//! A linear program in seven unknowns, linear in the motion: the caller measures the allowance anew after it and repeats. Ours; shops do it where stock
//! is short. The program is solved on the places that bind it, to which the most violated ones are added until none is left.

use microlp::{ComparisonOp, OptimizationDirection, Problem, SolveOutcome, Variable};

use crate::vector::{Point, Vector};

/// Violation below which a place does not bind, mm.
const SLACK_MM: f64 = 1e-10;
/// Places of the first program, and places added at a time.
const ADDED: usize = 64;

/// Point of the nominal surface, with the allowance that is measured there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AllowancePlace {
    /// Position q of the point.
    pub point: Point,
    /// Unit normal n, away from the material.
    pub normal: Vector,
    /// Measured allowance D.
    pub allowance_mm: f64,
}

/// Largest motion of the part that the tolerances of its datums allow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DatumTolerance {
    /// Largest shift t_m along each axis.
    pub shift_mm: f64,
    /// Largest rotation w_m about each axis.
    pub turn_rad: f64,
}

/// Motion of the part, within the tolerances of its datums, after which the least allowance is greatest. (1)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvenMotion {
    /// Rotation vector omega.
    pub omega_rad: Vector,
    /// Shift t.
    pub shift_mm: Vector,
    /// Least allowance tau after the motion.
    pub least_mm: f64,
}

/// Motion about `centre` with the greatest least allowance; `None` without places, or if the program is not solved.
pub fn most_even(places: &[AllowancePlace], centre: &Point, tolerance: &DatumTolerance) -> Option<EvenMotion> {
    let mut binding: Vec<usize> = (0..places.len()).step_by(places.len().div_ceil(ADDED).max(1)).collect();
    loop {
        let motion = solve(places, &binding, centre, tolerance)?;
        let mut violated: Vec<(f64, usize)> = (0..places.len())
            .map(|at| (motion.allowance_mm(&places[at], centre), at))
            .filter(|(left_mm, at)| *left_mm < motion.least_mm - SLACK_MM && !binding.contains(at))
            .collect();
        if violated.is_empty() {
            return Some(motion);
        }
        violated.sort_by(|a, b| a.0.total_cmp(&b.0));
        binding.extend(violated.iter().take(ADDED).map(|(_, at)| *at));
    }
}

impl EvenMotion {
    /// Allowance, mm, of a point after the motion, to first order in it.
    pub fn allowance_mm(&self, place: &AllowancePlace, centre: &Point) -> f64 {
        let moved = self.shift_mm + self.omega_rad.cross(&(place.point - centre));
        place.allowance_mm + place.normal.dot(&moved)
    }
}

/// (1) on some of the places.
fn solve(
    places: &[AllowancePlace],
    binding: &[usize],
    centre: &Point,
    tolerance: &DatumTolerance,
) -> Option<EvenMotion> {
    let least = binding.iter().map(|at| places[*at].allowance_mm).reduce(f64::min)?;
    let mut program = Problem::new(OptimizationDirection::Maximize);
    let limits = |k: usize| if k < 3 { tolerance.turn_rad } else { tolerance.shift_mm };
    // Unknowns are shares of their limits: angles and shifts are then of one size.
    let shares: Vec<Variable> = (0..6).map(|_| program.add_var(0.0, (-1.0, 1.0))).collect();
    let gain = program.add_var(1.0, (0.0, f64::INFINITY));
    for place in binding.iter().map(|at| &places[*at]) {
        let turn = (place.point - centre).cross(&place.normal);
        let row = [turn.x, turn.y, turn.z, place.normal.x, place.normal.y, place.normal.z];
        let terms = shares.iter().enumerate().map(|(k, share)| (*share, row[k] * limits(k)));
        program.add_constraint(terms.chain([(gain, -1.0)]), ComparisonOp::Ge, least - place.allowance_mm);
    }
    let Ok(SolveOutcome::Solution(solution)) = program.solve() else { return None };
    let value = |k: usize| solution.var_value(shares[k]) * limits(k);
    Some(EvenMotion {
        omega_rad: Vector::new(value(0), value(1), value(2)),
        shift_mm: Vector::new(value(3), value(4), value(5)),
        least_mm: least + solution.var_value(gain),
    })
}
