//! Depth limit of stable milling by the linear theory of regenerative chatter.
//!
//! Straight teeth at equal distances on a circle, x along the feed, angles phi clockwise from +y, T the time from tooth
//! to tooth:
//!
//! ```text
//! F(t) = -w H(t) (u(t) - u(t - T))                                      (1)
//! H = sum over the teeth in the cut of n a^T,   a = (s, c)              (2)
//! n = (Kt c + Kn s, -Kt s + Kn c),   s = sin phi, c = cos phi
//! q(h) = P (q(0) - qp(0)) + qp(h)                                       (3)
//! ```
//!
//! F is the force on the tool, u its displacement by its modes q (`arcfeed-modal`). In a step h the force is a straight
//! line between its values at both ends, and the modes answer it exactly: P is their free motion, qp the answer to a
//! ramp in (3). The force at the end depends on the displacement there, which is one pair of linear equations. Steps end
//! where a tooth enters or leaves, so they lie at the same places in each tooth's period, and u(t - T) needs no
//! interpolation. A depth is stable if the largest eigenvalue of the map from one tooth's period to the next is below 1 in
//! absolute value.
//!
//! Source: (1), (2) Altintas, Budak, Analytical prediction of stability lobes in milling, CIRP Annals 44 (1995). The map is
//! of the kind of Insperger, Stepan, Updated semi-discretization method for periodic delay-differential equations with
//! discrete delay, IJNME 61 (2004), with the present term in the force instead of the matrix, so that no step needs a matrix
//! exponential.

use std::f64::consts::{PI, TAU};

use arcfeed_modal::dynamics::modal::Mode;
use arcfeed_units::{MM_PER_M, S_PER_MIN};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// Steps in a period of the fastest mode.
const STEPS_A_WAVE: f64 = 120.0;

/// Fewest steps of an interval in the cut.
const STEPS_MIN: f64 = 40.0;

/// Factor between two depths of the search for the first limit.
const RISE: f64 = 1.03;

/// Relative accuracy of a limit as a solution of the discrete map.
const TOLERANCE: f64 = 1e-5;

/// Tooth periods before the eigenvalue is looked for: what dies out quickly is gone.
const SETTLING_PERIODS: usize = 12;

/// Dimension of the subspace in which the eigenvalue is looked for.
const KRYLOV: usize = 30;

/// Part of an eigenvalue's absolute value below which its imaginary part is rounding.
const REAL_RATIO: f64 = 1e-4;

/// Linear model of milling with straight, evenly spaced teeth, for computing the depth limit of stable cutting.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearMilling {
    /// Modes of vibration between tool and workpiece, in a frame with x along the feed and y to its left; components along z are ignored.
    pub modes: Vec<Mode>,
    /// Number of teeth.
    pub teeth: usize,
    /// Specific cutting forces, N/mm2: force per area of the chip along the cut (Kt) and square to it (Kn).
    pub specific_mpa: [f64; 2],
    /// Angles at which a tooth enters the material and leaves it, clockwise from +y.
    pub engaged_rad: [f64; 2],
}

/// Kind of chatter that begins beyond a depth limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChatterKind {
    /// Hopf bifurcation: the vibration has a frequency of its own, unrelated to that of the teeth.
    Hopf,
    /// Period doubling (flip): the vibration repeats with every second tooth.
    Flip,
}

/// Smallest axial depth of cut at which the cut is not stable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthLimit {
    /// Axial depth of cut.
    pub depth_mm: f64,
    /// Kind of chatter beyond that depth.
    pub kind: ChatterKind,
}

/// Step of the map.
struct Step {
    /// Answers of the modes, by the index of the step's length.
    answers: usize,
    /// H at the beginning and at the end; `None` out of the cut.
    cutting: Option<[Matrix2<f64>; 2]>,
}

/// Answer of a mode to a step: free motion, and the state at the end for a drive of 1 at the beginning or at the end.
struct Answer {
    free: Matrix2<f64>,
    first: Vector2<f64>,
    last: Vector2<f64>,
}

/// Map from one tooth's period to the next at one speed.
struct ToothMap<'a> {
    modes: &'a [Mode],
    steps: Vec<Step>,
    /// For each length of a step, the answers of the modes and the compliance at its end.
    answers: Vec<(Vec<Answer>, Matrix2<f64>)>,
}

impl LinearMilling {
    /// Angles at which a tooth enters and leaves the material, for a radial immersion ae/D (0 to 1), in up or down milling.
    pub fn engaged_rad(immersion_ratio: f64, is_up: bool) -> [f64; 2] {
        let edge_rad = libm::acos(1.0 - 2.0 * immersion_ratio.clamp(0.0, 1.0));
        if is_up { [0.0, edge_rad] } else { [PI - edge_rad, PI] }
    }

    /// Smallest unstable axial depth at a spindle speed; `None` if all depths up to `depth_max_mm` are stable.
    pub fn limit(&self, rev_per_min: f64, depth_max_mm: f64) -> Option<DepthLimit> {
        let map = ToothMap::new(self, rev_per_min);
        let is_stable = |depth_mm: f64| map.multiplier(depth_mm).norm() < 1.0;
        let mut stable_mm = self.surely_stable_mm();
        while is_stable(RISE * stable_mm) {
            stable_mm *= RISE;
            if stable_mm >= depth_max_mm {
                return None;
            }
        }
        let mut unstable_mm = RISE * stable_mm;
        while unstable_mm - stable_mm > TOLERANCE * unstable_mm {
            let middle_mm = f64::midpoint(stable_mm, unstable_mm);
            *(if is_stable(middle_mm) { &mut stable_mm } else { &mut unstable_mm }) = middle_mm;
        }
        let multiplier = map.multiplier(unstable_mm);
        let is_real = libm::fabs(multiplier.y) < REAL_RATIO * multiplier.norm();
        let kind = if is_real && multiplier.x < 0.0 { ChatterKind::Flip } else { ChatterKind::Hopf };
        (unstable_mm <= depth_max_mm).then_some(DepthLimit { depth_mm: unstable_mm, kind })
    }

    /// Depth below which the gain of the loop is below 1 at every frequency.
    fn surely_stable_mm(&self) -> f64 {
        let resonance = |mode: &Mode| {
            let circular_per_s = TAU * mode.frequency_hz;
            let shape = mode.shape.xy().norm_squared() * MM_PER_M;
            shape / (2.0 * mode.damping_ratio * circular_per_s * circular_per_s)
        };
        let compliance: f64 = self.modes.iter().map(resonance).sum();
        let [along, across] = self.specific_mpa;
        1.0 / (2.0 * self.teeth as f64 * libm::hypot(along, across) * compliance)
    }

    /// H of the teeth that are in the cut at the middle of an interval, with the first tooth at `phi_rad`.
    fn cutting(&self, phi_rad: f64, middle_rad: f64) -> Matrix2<f64> {
        let [entry_rad, exit_rad] = self.engaged_rad;
        let [along, across] = self.specific_mpa;
        let pitch_rad = TAU / self.teeth as f64;
        let of_tooth = |tooth: usize| {
            let turned_rad = tooth as f64 * pitch_rad;
            if !(entry_rad..exit_rad).contains(&(middle_rad + turned_rad)) {
                return Matrix2::zeros();
            }
            let (s, c) = libm::sincos(phi_rad + turned_rad);
            Vector2::new(along * c + across * s, across * c - along * s) * Vector2::new(s, c).transpose() // (2)
        };
        (0..self.teeth).map(of_tooth).sum()
    }
}

impl<'a> ToothMap<'a> {
    fn new(milling: &'a LinearMilling, rev_per_min: f64) -> Self {
        let pitch_rad = TAU / milling.teeth as f64;
        let rad_per_s = TAU * rev_per_min / S_PER_MIN;
        let fastest_hz = milling.modes.iter().map(|mode| mode.frequency_hz).fold(0.0, f64::max);
        let mut borders: Vec<f64> = milling.engaged_rad.iter().map(|angle| angle.rem_euclid(pitch_rad)).collect();
        borders.extend([0.0, pitch_rad]);
        borders.sort_unstable_by(f64::total_cmp);
        let (mut steps, mut answers) = (Vec::new(), Vec::new());
        for border in borders.windows(2) {
            let [from_rad, to_rad] = [border[0], border[1]];
            let (span_rad, middle_rad) = (to_rad - from_rad, f64::midpoint(from_rad, to_rad));
            if span_rad < 1e-9 {
                continue;
            }
            let is_cutting = milling.cutting(middle_rad, middle_rad) != Matrix2::zeros();
            let waves = span_rad / rad_per_s * fastest_hz;
            let count = if is_cutting { libm::ceil(waves * STEPS_A_WAVE).max(STEPS_MIN) } else { 1.0 };
            let of_modes: Vec<Answer> =
                milling.modes.iter().map(|mode| Answer::new(mode, span_rad / rad_per_s / count)).collect();
            let compliances = milling.modes.iter().zip(&of_modes);
            let compliance = compliances.map(|(mode, answer)| {
                let shape = mode.shape.xy();
                shape * shape.transpose() * (answer.last.x * MM_PER_M)
            });
            let compliance = compliance.sum();
            for step in 0..count as usize {
                let at = |end: usize| milling.cutting(from_rad + span_rad * (step + end) as f64 / count, middle_rad);
                steps.push(Step { answers: answers.len(), cutting: is_cutting.then(|| [at(0), at(1)]) });
            }
            answers.push((of_modes, compliance));
        }
        ToothMap { modes: &milling.modes, steps, answers }
    }

    /// Length of a state: of each mode its displacement and velocity; then the tool's displacement at both ends of each
    /// step in the cut, one tooth ago.
    fn dimension(&self) -> usize {
        2 * self.modes.len() + 4 * self.steps.iter().filter(|step| step.cutting.is_some()).count()
    }

    /// State one tooth later at this depth.
    fn apply(&self, depth_mm: f64, state: &DVector<f64>) -> DVector<f64> {
        let mut next = state.clone();
        let mut modes: Vec<Vector2<f64>> =
            (0..self.modes.len()).map(|mode| Vector2::new(state[2 * mode], state[2 * mode + 1])).collect();
        let mut place = 2 * self.modes.len();
        for Step { answers, cutting } in &self.steps {
            let (answers, compliance) = &self.answers[*answers];
            let Some([first, last]) = cutting else {
                modes.iter_mut().zip(answers).for_each(|(state, answer)| *state = answer.free * *state);
                continue;
            };
            let before = [0, 2].map(|end| Vector2::new(state[place + end], state[place + end + 1]));
            let begin_mm = self.displacement_mm(&modes);
            let force_n = first * (before[0] - begin_mm) * depth_mm; // (1)
            for ((state, answer), mode) in modes.iter_mut().zip(answers).zip(self.modes) {
                let drive = mode.shape.xy().dot(&force_n) * MM_PER_M;
                *state = answer.free * *state + answer.first * drive; // (3)
            }
            // (1) at the end, where the displacement is that of the modes so far and of the force itself.
            let right_n = last * (before[1] - self.displacement_mm(&modes)) * depth_mm;
            let system = Matrix2::identity() + last * compliance * depth_mm;
            let force_n = system.try_inverse().map_or(right_n, |inverse| inverse * right_n);
            for ((state, answer), mode) in modes.iter_mut().zip(answers).zip(self.modes) {
                *state += answer.last * (mode.shape.xy().dot(&force_n) * MM_PER_M); // (3)
            }
            for (end, displacement_mm) in [(0, begin_mm), (2, self.displacement_mm(&modes))] {
                (next[place + end], next[place + end + 1]) = (displacement_mm.x, displacement_mm.y);
            }
            place += 4;
        }
        for (mode, state) in modes.iter().enumerate() {
            (next[2 * mode], next[2 * mode + 1]) = (state.x, state.y);
        }
        next
    }

    fn displacement_mm(&self, modes: &[Vector2<f64>]) -> Vector2<f64> {
        self.modes.iter().zip(modes).map(|(mode, state)| mode.shape.xy() * state.x).sum()
    }

    /// Largest eigenvalue at a depth: real and imaginary part.
    fn multiplier(&self, depth_mm: f64) -> Vector2<f64> {
        let dimension = self.dimension();
        // Any state that no mode is blind to.
        let mut state = DVector::from_fn(dimension, |row, _| libm::cos(1.0 + 0.7 * row as f64));
        for _ in 0..SETTLING_PERIODS {
            state = self.apply(depth_mm, &state).normalize();
        }
        let size = KRYLOV.min(dimension);
        let mut basis = vec![state];
        let mut projected = DMatrix::zeros(size, size);
        for column in 0..size {
            let mut image = self.apply(depth_mm, &basis[column]);
            // Twice: once leaves the rounding of what was taken away.
            for _ in 0..2 {
                for (row, vector) in basis.iter().enumerate() {
                    let part = vector.dot(&image);
                    projected[(row, column)] += part;
                    image.axpy(-part, vector, 1.0);
                }
            }
            let length = image.norm();
            if column + 1 == size || length < 1e-12 {
                projected = projected.resize(column + 1, column + 1, 0.0);
                break;
            }
            projected[(column + 1, column)] = length;
            basis.push(image / length);
        }
        let values = projected.complex_eigenvalues();
        let pairs = values.iter().map(|value| Vector2::new(value.re, value.im));
        pairs.max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or_default()
    }
}

impl Answer {
    /// Answer of a mode to a step of this length.
    fn new(mode: &Mode, step_s: f64) -> Self {
        let (circular_per_s, zeta) = (TAU * mode.frequency_hz, mode.damping_ratio);
        let (loss_per_s, square) = (zeta * circular_per_s, circular_per_s * circular_per_s);
        let ring_per_s = circular_per_s * libm::sqrt(1.0 - zeta * zeta);
        let decay = libm::exp(-loss_per_s * step_s);
        let (sine, cosine) = libm::sincos(ring_per_s * step_s);
        let (s, c) = (decay * sine / ring_per_s, decay * cosine);
        let free = Matrix2::new(c + loss_per_s * s, s, -square * s, c - loss_per_s * s);
        // Answer qp to a drive that rises by 1 in the step, and to one that is 1 all along.
        let lag = 2.0 * zeta / (square * circular_per_s * step_s);
        let slope = 1.0 / (square * step_s);
        let [ramp_begin, ramp_end] = [Vector2::new(-lag, slope), Vector2::new(1.0 / square - lag, slope)];
        let last = ramp_end - free * ramp_begin; // (3)
        let constant = Vector2::new(1.0 / square, 0.0);
        let whole = constant - free * constant; // (3)
        Answer { free, first: whole - last, last }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn a_step_answers_a_ramp_as_many_small_steps_of_constant_drive_do() {
        let mode = Mode::from_stiffness(500.0, 0.05, 1e3, &Vector3::x()).expect("a mode");
        let (step_s, count) = (4e-4, 20_000);
        let [first, last] = [0.7, -1.3];
        let mut state = Vector2::new(1e-3, 0.2);
        let whole = Answer::new(&mode, step_s);
        let wanted = whole.free * state + whole.first * first + whole.last * last;
        let small = Answer::new(&mode, step_s / f64::from(count));
        for part in 0..count {
            let drive = first + (last - first) * (f64::from(part) + 0.5) / f64::from(count);
            state = small.free * state + (small.first + small.last) * drive;
        }
        assert!((state - wanted).amax() < 1e-9 * wanted.amax(), "{state} for {wanted}");
    }
}
