//! Rigid motion that lays measured points on the nominal surface.
//!
//! ```text
//! x' = c + R(omega) (x - c) + t,  e_i = n_i.(x'_i - p_i),  p_i nearest nominal point
//! J_i = [(x'_i - c) x n_i, n_i],  d = -(J' W J)^-1 J' W e          until |d| is small                         (1)
//! w_i = (1 - (e_i / c_T)^2)^2,  c_T = 4.685 sigma,  0 beyond                                                  (2)
//! sigma = 1.4826 median |e_i|   while (2) moves,  s^2 = e' W e / (sum w - f),  cov = s^2 (J' W J)^-1          (3)
//! ```
//!
//! with f free unknowns. Directions that are not free stand still: datums hold them. One side of a blade does not determine the shift along the span: an even
//! surplus is then taken for a shift, with residuals that look perfect. So a free direction whose standard deviation is above a limit is refused.
//!
//! Source of (1): Gauss-Newton on distances along the normals. (2): Tukey's biweight. Feng et al. ask for the two models to be matched without a method.

use nalgebra::{DMatrix, DVector, Matrix6, Rotation3, Vector6};
use thiserror::Error;

use crate::vector::{Point, Vector};

/// Length that makes angles comparable with shifts, mm.
const ARM_MM: f64 = 40.0;
/// Largest standard deviation of a free direction, mm; of an angle at the arm.
const DEVIATION_MAX_MM: f64 = 0.02;
/// Length of the last step, mm; of an angle at the arm.
const LAST_STEP_MM: f64 = 1e-9;
/// Limit of the steps.
const STEPS_MAX: usize = 200;
/// c_T over sigma.
const TUKEY_RATIO: f64 = 4.685;
/// Standard deviation over the median of the absolute values, of normal deviates.
const MEDIAN_RATIO: f64 = 1.4826;
/// Least sigma of (2): points without noise keep their weights.
const SIGMA_MIN_MM: f64 = 1e-6;

/// Names of the six unknowns of a motion, in their order: rotations about and shifts along x, y, z.
pub const DIRECTIONS: [&str; 6] = ["omega_x", "omega_y", "omega_z", "x", "y", "z"];

/// Settings of a registration of measured points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegistrationSettings {
    /// Point about which the rotations turn.
    pub centre: Point,
    /// Which of [`DIRECTIONS`] are found from the points; the others are held at 0.
    pub free: [bool; 6],
    /// Whether points far from the nominal part lose their weight (2).
    pub is_robust: bool,
    /// Uncertainty of a measured point: least s of (3) where free directions are judged.
    pub uncertainty_mm: f64,
}

/// Point of the nominal part that is nearest to a measured point, with the outward normal there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalFoot {
    /// Position of the point.
    pub point: Point,
    /// Unit normal, away from the material.
    pub normal: Vector,
}

/// Rigid motion that moves measured points onto the nominal part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// Point about which the rotation turns.
    pub centre: Point,
    /// Rotation vector, rad.
    pub omega_rad: Vector,
    /// Shift after the rotation.
    pub shift_mm: Vector,
}

/// Result of a registration: motion, remaining distances and certainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registration {
    /// Motion that moves the points onto the nominal part.
    pub motion: RigidMotion,
    /// Root of the weighted mean square of the remaining distances.
    pub rms_mm: f64,
    /// s of (3): standard deviation of a point.
    pub deviation_mm: f64,
    /// Standard deviation of each direction over that of a point, with angles at an arm of 40 mm; 0 of directions that are held.
    pub shares: [f64; 6],
    /// Least over greatest singular value of J, with angles at an arm of 40 mm; 1 if nothing is free.
    pub condition: f64,
    /// Number of points that have lost their weight.
    pub outliers: usize,
}

/// Reason why points cannot be registered on the nominal part.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RegistrationError {
    /// There are too few points.
    #[error("{points} points do not determine {free} directions: measure more points, or free fewer directions")]
    TooFew {
        /// Points with a weight.
        points: usize,
        /// Free directions.
        free: usize,
    },
    /// The points do not determine a free direction well enough.
    #[error(
        "the points do not determine `{direction}`: its standard deviation is {deviation_mm:.3} mm{}, and {limit_mm} mm are allowed; measure both edges and the hub as well, or hold `{direction}` at the datum by leaving it out of `free`",
        if .direction.starts_with("omega") { " at 40 mm from the centre" } else { "" }, limit_mm = DEVIATION_MAX_MM
    )]
    Undetermined {
        /// Direction of [`DIRECTIONS`] with the largest standard deviation.
        direction: &'static str,
        /// Standard deviation; of an angle at the arm.
        deviation_mm: f64,
    },
    /// The iteration does not converge.
    #[error(
        "the points do not settle on the nominal part: the last step was {step_mm:.4} mm; check units and frame of the points"
    )]
    Restless {
        /// Length of the last step.
        step_mm: f64,
    },
}

impl Registration {
    /// Standard deviations of the six directions, in rad and mm.
    pub fn deviations(&self) -> [f64; 6] {
        [0, 1, 2, 3, 4, 5].map(|k| self.shares[k] * self.deviation_mm / if k < 3 { ARM_MM } else { 1.0 })
    }
}

impl RigidMotion {
    /// Motion that moves nothing.
    pub fn identity(centre: Point) -> Self {
        RigidMotion { centre, omega_rad: Vector::zeros(), shift_mm: Vector::zeros() }
    }

    /// Moves a point.
    pub fn moved(&self, point: &Point) -> Point {
        self.centre + Rotation3::new(self.omega_rad) * (point - self.centre) + self.shift_mm
    }

    /// Motion after a small further one about the same centre.
    pub fn followed_by(&self, omega_rad: Vector, shift_mm: Vector) -> Self {
        let turn = Rotation3::new(omega_rad);
        let whole = turn * Rotation3::new(self.omega_rad);
        RigidMotion { omega_rad: whole.scaled_axis(), shift_mm: turn * self.shift_mm + shift_mm, ..*self }
    }
}

/// Lays points on the nominal part; `foot` finds its nearest point.
///
/// # Errors
/// The points do not determine what is free: a free direction is less certain than allowed.
pub fn register(
    points: &[Point],
    settings: &RegistrationSettings,
    foot: impl Fn(&Point) -> NominalFoot,
) -> Result<Registration, RegistrationError> {
    let found = fit(points, settings, foot)?;
    let judged_mm = found.shares.map(|share_mm| share_mm * found.deviation_mm.max(settings.uncertainty_mm));
    let worst = (0..6).max_by(|a, b| judged_mm[*a].total_cmp(&judged_mm[*b])).unwrap_or(0);
    if judged_mm[worst] <= DEVIATION_MAX_MM {
        return Ok(found);
    }
    Err(RegistrationError::Undetermined { direction: DIRECTIONS[worst], deviation_mm: judged_mm[worst] })
}

/// Motion and its figures, however uncertain the free directions are.
///
/// # Errors
/// There are too few points, a direction has no influence on any of them, or the steps do not come to rest.
pub fn fit(
    points: &[Point],
    settings: &RegistrationSettings,
    foot: impl Fn(&Point) -> NominalFoot,
) -> Result<Registration, RegistrationError> {
    let free: Vec<usize> = (0..6).filter(|k| settings.free[*k]).collect();
    let mut motion = RigidMotion::identity(settings.centre);
    let mut step_mm = f64::INFINITY;
    for _ in 0..STEPS_MAX {
        let problem = Problem::new(points, &motion, settings, &foot);
        problem.check_count(free.len())?;
        if step_mm <= LAST_STEP_MM || free.is_empty() {
            return Ok(problem.result(motion, &free));
        }
        let step = problem.step(&free)?; // (1)
        step_mm = arm_lengths(&step).norm();
        motion = motion.followed_by(step.fixed_rows::<3>(0).into(), step.fixed_rows::<3>(3).into());
    }
    Err(RegistrationError::Restless { step_mm })
}

/// Small motion in mm: angles at the arm.
fn arm_lengths(step: &Vector6<f64>) -> Vector6<f64> {
    Vector6::from_fn(|k, _| if k < 3 { step[k] * ARM_MM } else { step[k] })
}

/// Linear problem about a motion.
struct Problem {
    /// e
    off_mm: Vec<f64>,
    weights: Vec<f64>,
    /// Rows of J with angles at the arm.
    rows: Vec<Vector6<f64>>,
}

impl Problem {
    fn new(
        points: &[Point],
        motion: &RigidMotion,
        settings: &RegistrationSettings,
        foot: impl Fn(&Point) -> NominalFoot,
    ) -> Self {
        let row = |point: &Point| {
            let moved = motion.moved(point);
            let NominalFoot { point: nearest, normal } = foot(&moved);
            let turn = (moved - settings.centre).cross(&normal) / ARM_MM;
            let row = Vector6::new(turn.x, turn.y, turn.z, normal.x, normal.y, normal.z);
            (normal.dot(&(moved - nearest)), row)
        };
        let (off_mm, rows): (Vec<f64>, Vec<Vector6<f64>>) = points.iter().map(row).unzip();
        let weights = if settings.is_robust { tukey_weights(&off_mm) } else { vec![1.0; off_mm.len()] };
        Problem { off_mm, weights, rows }
    }

    fn check_count(&self, free: usize) -> Result<(), RegistrationError> {
        let points = self.weights.iter().filter(|weight| **weight > 0.0).count();
        if points > free { Ok(()) } else { Err(RegistrationError::TooFew { points, free }) }
    }

    /// J' W J of the free directions; held ones have a unit diagonal.
    fn normal_matrix(&self, free: &[usize]) -> Matrix6<f64> {
        let mut sum = Matrix6::zeros();
        for (row, weight) in self.rows.iter().zip(&self.weights) {
            sum += row * row.transpose() * *weight;
        }
        Matrix6::from_fn(|i, j| {
            let is_free = free.contains(&i) && free.contains(&j);
            if is_free { sum[(i, j)] } else { f64::from(u8::from(i == j)) }
        })
    }

    /// (1), in rad and mm.
    fn step(&self, free: &[usize]) -> Result<Vector6<f64>, RegistrationError> {
        let mut right = Vector6::zeros();
        for ((row, weight), off) in self.rows.iter().zip(&self.weights).zip(&self.off_mm) {
            right -= row * (*weight * off);
        }
        let right = Vector6::from_fn(|k, _| if free.contains(&k) { right[k] } else { 0.0 });
        let solved = self.normal_matrix(free).cholesky().map(|matrix| matrix.solve(&right));
        let undetermined =
            || RegistrationError::Undetermined { direction: DIRECTIONS[free[0]], deviation_mm: f64::INFINITY };
        let solved = solved.filter(|step| step.iter().all(|part| part.is_finite())).ok_or_else(undetermined)?;
        Ok(Vector6::from_fn(|k, _| if k < 3 { solved[k] / ARM_MM } else { solved[k] }))
    }

    fn result(&self, motion: RigidMotion, free: &[usize]) -> Registration {
        let total: f64 = self.weights.iter().sum();
        let square: f64 = self.weights.iter().zip(&self.off_mm).map(|(weight, off)| weight * off * off).sum();
        let s_mm = libm::sqrt(square / (total - free.len() as f64).max(1.0)); // (3)
        let covariance = self.normal_matrix(free).try_inverse().unwrap_or_else(|| Matrix6::repeat(f64::INFINITY));
        let shares = [0, 1, 2, 3, 4, 5].map(|k| if free.contains(&k) { libm::sqrt(covariance[(k, k)]) } else { 0.0 });
        Registration {
            motion,
            rms_mm: libm::sqrt(square / total),
            deviation_mm: s_mm,
            shares,
            condition: self.condition(free),
            outliers: self.weights.iter().filter(|weight| **weight == 0.0).count(),
        }
    }

    fn condition(&self, free: &[usize]) -> f64 {
        if free.is_empty() {
            return 1.0;
        }
        let matrix = self.normal_matrix(free);
        let values =
            DMatrix::from_fn(free.len(), free.len(), |i, j| matrix[(free[i], free[j])]).symmetric_eigenvalues();
        libm::sqrt(values.min().max(0.0) / values.max())
    }
}

/// (2)
fn tukey_weights(off_mm: &[f64]) -> Vec<f64> {
    let sizes = DVector::from_iterator(off_mm.len(), off_mm.iter().map(|off| off.abs()));
    let limit_mm = TUKEY_RATIO * (MEDIAN_RATIO * median(sizes.as_slice())).max(SIGMA_MIN_MM);
    let weight = |off: &f64| {
        let rest = 1.0 - (off / limit_mm) * (off / limit_mm);
        if rest > 0.0 { rest * rest } else { 0.0 }
    };
    off_mm.iter().map(weight).collect()
}

/// Median of values; 0 of none.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => 0.0,
        count if count % 2 == 1 => sorted[middle],
        _ => (sorted[middle - 1] + sorted[middle]) / 2.0,
    }
}
