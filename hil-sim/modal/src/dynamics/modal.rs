//! Structure at the point where it is cut, as uncoupled modes.
//!
//! ```text
//! q'' + 2 zeta w q' + w^2 q = s.F        u = sum of s q        w = 2 pi f      (1)
//! s = d / sqrt(m),  m = k / w^2          one mass m on a spring k along d      (2)
//! ```
//!
//! F is the force on the structure, u its displacement, s the mode's shape at that point, normalised to a modal mass of
//! 1 kg.
//!
//! Tool and workpiece together: the cut depends on u = u_T - u_W only, and the forces on them are F and -F. So the
//! modes of both in one list, with unchanged shapes, give the relative displacement.
//!
//! Source: (1) modal superposition with damping that does not couple the modes, as used by Lorong et al., Simulation of a
//! finishing operation, 2012, section 4.2; Coriolis and centrifugal terms of their eq. 1 are left out, as they do in section 4.

use std::f64::consts::TAU;
use std::fmt;

use arcfeed_units::MM_PER_M;
use nalgebra::Vector3;

/// Vibration mode of a structure (tool or workpiece), with its shape at the point where it is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Undamped natural frequency.
    pub frequency_hz: f64,
    /// Damping as a fraction of the critical damping, from 0 to less than 1.
    pub damping_ratio: f64,
    /// Shape s: displacement at the cut per unit of q, in the frame of the forces, in 1/sqrt(kg).
    pub shape: Vector3<f64>,
}

/// Reason why a mode is invalid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModeError {
    /// The frequency is not positive.
    Frequency {
        /// Given value.
        given_hz: f64,
    },
    /// The damping is not from 0 to less than 1.
    Damping {
        /// Given value.
        given_ratio: f64,
    },
    /// The stiffness is not positive.
    Stiffness {
        /// Given value.
        given_n_per_mm: f64,
    },
    /// A shape or direction is not finite, or a direction has no length.
    Shape,
}

impl Mode {
    /// Mode from a modal analysis, with its mass-normalised shape.
    ///
    /// # Errors
    /// The frequency is not positive, the damping is not from 0 to less than 1, or the shape is not finite.
    pub fn new(frequency_hz: f64, damping_ratio: f64, shape: Vector3<f64>) -> Result<Self, ModeError> {
        if !(frequency_hz > 0.0 && frequency_hz.is_finite()) {
            return Err(ModeError::Frequency { given_hz: frequency_hz });
        }
        if !(0.0..1.0).contains(&damping_ratio) {
            return Err(ModeError::Damping { given_ratio: damping_ratio });
        }
        if !shape.iter().all(|s| s.is_finite()) {
            return Err(ModeError::Shape);
        }
        Ok(Mode { frequency_hz, damping_ratio, shape })
    }

    /// Mode from a tap test: its stiffness along `direction`, which may have any length. (2)
    ///
    /// # Errors
    /// The frequency or the stiffness is not positive, the damping is not from 0 to less than 1, or the direction has no length.
    pub fn from_stiffness(
        frequency_hz: f64,
        damping_ratio: f64,
        stiffness_n_per_mm: f64,
        direction: &Vector3<f64>,
    ) -> Result<Self, ModeError> {
        if !(stiffness_n_per_mm > 0.0 && stiffness_n_per_mm.is_finite()) {
            return Err(ModeError::Stiffness { given_n_per_mm: stiffness_n_per_mm });
        }
        let direction = direction.try_normalize(0.0).ok_or(ModeError::Shape)?;
        let root_mass = libm::sqrt(stiffness_n_per_mm * MM_PER_M) / (TAU * frequency_hz);
        Mode::new(frequency_hz, damping_ratio, direction / root_mass)
    }

    /// Angular frequency w.
    pub(super) fn circular_per_s(&self) -> f64 {
        TAU * self.frequency_hz
    }

    /// Right-hand side of (1) for a q that gives u in mm.
    pub(super) fn drive(&self, force_n: &Vector3<f64>) -> f64 {
        self.shape.dot(force_n) * MM_PER_M
    }

    /// Static displacement, mm, of the structure under this force in this mode alone.
    pub fn static_mm(&self, force_n: &Vector3<f64>) -> Vector3<f64> {
        let circular = self.circular_per_s();
        self.shape * (self.drive(force_n) / (circular * circular))
    }

    /// Upper bound of the displacement across Z in this mode alone, for a force of any direction that jumps to this size or alternates with it: a jump
    /// causes at most twice the static displacement, resonance 1 / (2 zeta) times it.
    pub fn swing_max_mm(&self, force_n: f64) -> f64 {
        let (circular, damping_ratio) = (self.circular_per_s(), self.damping_ratio.max(f64::MIN_POSITIVE));
        let static_mm = self.shape.xy().norm() * self.shape.norm() * force_n * MM_PER_M / (circular * circular);
        static_mm * (1.0 + 0.5 / damping_ratio)
    }
}

impl fmt::Display for ModeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ModeError::Frequency { given_hz } => write!(f, "a mode's frequency is positive, not {given_hz} Hz"),
            ModeError::Damping { given_ratio } => write!(f, "damping is from 0 to less than 1, not {given_ratio}"),
            ModeError::Stiffness { given_n_per_mm } => write!(f, "a stiffness is positive, not {given_n_per_mm} N/mm"),
            ModeError::Shape => write!(f, "a mode's shape needs numbers, its direction a length"),
        }
    }
}

impl std::error::Error for ModeError {}
