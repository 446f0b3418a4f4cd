//! How the axes follow their commands: a position loop with velocity feed-forward for each.
//!
//! The drive turns the lag e = c - p of the position p behind the command c into a speed, without delay and without limit:
//!
//! ```text
//! p' = K e + f c'        e' = (1 - f) c' - K e                          (1)
//! e(T) = e(0) d + (1 - f) (c(T) - c(0)) (1 - d)/(K T),  d = exp(-K T)   (2)
//! ```
//!
//! with the loop gain K and the ratio f of feed-forward. (2) solves (1) without error for a command that is linear within the
//! period T, as the interpolator's is. What follows from (1):
//!
//! ```text
//! speed v, settled:        e = (1 - f) v/K                              (3)
//! command at rest:         e(t) = e(0) exp(-K t)                        (4)
//! circle at w rad/s:       r' = r sqrt((1 + (f w/K)^2)/(1 + (w/K)^2))   (5)
//! without feed-forward:    each axis is late by the angle atan(w/K)     (6)
//! ```
//!
//! With equal gains a straight line stays straight and a circle a circle. With unequal ones a line is missed by
//! (e_x - e_y) sin 2a/2 at its angle a, and a circle becomes an ellipse at 45 degrees.
//!
//! Valid where the velocity loop is much faster than K, and while no motor is at its limit of torque. Not modelled: backlash,
//! friction at reversals, elastic ball screws, position gain switched at standstill.
//!
//! Source: (1) is the velocity-type position loop of the textbooks, Altintas, Manufacturing Automation (2nd ed., 2012),
//! chapter 5, in its limit of an ideal velocity loop; (2) to (6) are derived here. Figures: docs/servo.md.

use super::limits::AXES;

/// The position loop of one axis; of a rotary axis, degrees for mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisServo {
    /// K, greater than 0: Fanuc's parameter 1825 has it in hundredths.
    pub gain_per_s: f64,
    /// f, 0 to 1: Fanuc's parameter 2092 has it in hundredths of a per cent.
    pub feed_forward_ratio: f64,
    /// The axis is in position when its lag is no greater: Fanuc's parameter 1826.
    pub in_position_mm: f64,
}

/// The position loops of a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo {
    /// X, Y, Z, A, B, C.
    pub axes: [AxisServo; AXES],
}

/// Where the axes are; state.
#[derive(Clone, Debug, PartialEq)]
pub struct PositionLoops {
    servo: Servo,
    commanded: [f64; AXES],
    lag: [f64; AXES],
}

impl PositionLoops {
    /// At rest where they are commanded to.
    pub fn new(servo: Servo, commanded: [f64; AXES]) -> Self {
        PositionLoops { servo, commanded, lag: [0.0; AXES] }
    }

    /// A period in which the command goes on to `commanded`, at constant speed: mm and degrees.
    pub fn step(&mut self, commanded: &[f64; AXES], dt_s: f64) {
        let axes = self.servo.axes.iter().zip(commanded).zip(self.commanded.iter_mut().zip(&mut self.lag));
        for ((servo, to), (from, lag)) in axes {
            let periods = servo.gain_per_s * dt_s;
            let settled = (1.0 - servo.feed_forward_ratio) * (to - *from) / periods; // (3)
            *lag = *lag * libm::exp(-periods) - settled * libm::expm1(-periods); // (2)
            *from = *to;
        }
    }

    /// Where the axes are: X, Y, Z in mm, A, B, C in degrees.
    pub fn axes(&self) -> [f64; AXES] {
        std::array::from_fn(|axis| self.commanded[axis] - self.lag[axis])
    }

    /// How far each is behind its command.
    pub fn lag(&self) -> &[f64; AXES] {
        &self.lag
    }

    /// Whether every axis is in position.
    pub fn is_in_position(&self) -> bool {
        self.servo.axes.iter().zip(&self.lag).all(|(servo, lag)| libm::fabs(*lag) <= servo.in_position_mm)
    }
}

impl Servo {
    /// The same loop for all axes.
    pub fn of_all(axis: AxisServo) -> Self {
        Servo { axes: [axis; AXES] }
    }

    /// The time after which no axis has more than `ratio` left of a sudden change of its command's speed. (4)
    pub fn settling_s(&self, ratio: f64) -> f64 {
        let of_axis = |servo: &AxisServo| libm::log((1.0 - servo.feed_forward_ratio) / ratio) / servo.gain_per_s;
        self.axes.iter().map(of_axis).fold(0.0, f64::max)
    }
}
