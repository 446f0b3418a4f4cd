//! Lag of the axes behind their commands: a position loop with velocity feed-forward for each.
//!
//! The drive converts the lag e = c - p of the position p behind the command c into a speed, without delay and without
//! limit:
//!
//! ```text
//! p' = K e + f c'        e' = (1 - f) c' - K e                          (1)
//! e(T) = e(0) d + (1 - f) (c(T) - c(0)) (1 - d)/(K T),  d = exp(-K T)   (2)
//! ```
//!
//! with the loop gain K and the ratio f of feed-forward. (2) solves (1) exactly for a command that is linear within the
//! period T, like the interpolator's. Consequences of (1):
//!
//! ```text
//! speed v, settled:        e = (1 - f) v/K                              (3)
//! command at rest:         e(t) = e(0) exp(-K t)                        (4)
//! circle at w rad/s:       r' = r sqrt((1 + (f w/K)^2)/(1 + (w/K)^2))   (5)
//! without feed-forward:    each axis is late by the angle atan(w/K)     (6)
//! ```
//!
//! With equal gains a straight line stays straight and a circle a circle. With unequal gains the path misses a line by
//! v (1 - f)(1/K_x - 1/K_y) sin(2a)/2 at its angle a, and a circle becomes an ellipse at about 45 degrees.
//!
//! Valid where the velocity loop is much faster than K, and while no motor is at its limit of torque. Not modelled: backlash,
//! friction at reversals, elastic ball screws, position gain switched at standstill.
//!
//! Source: controls define the gain by (3) without feed-forward (Beckhoff TwinCAT CNC, "Position controller gain");
//! that the loop is the proportional one of (1) throughout is assumed; the rest follows from (1). Figures:
//! docs/servo.md.

use super::limits::AXES;

/// Position loop of one axis; for a rotary axis, in degrees instead of mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisServo {
    /// Loop gain K, larger than 0; Fanuc's parameter 1825 has it in hundredths of 1/s.
    pub gain_per_s: f64,
    /// Ratio of velocity feed-forward f, 0 to 1; Fanuc's parameter 2092 has it in hundredths of a per cent.
    pub feed_forward_ratio: f64,
    /// Largest lag at which the axis counts as in position; Fanuc's parameter 1826.
    pub in_position_mm: f64,
}

/// Position loops of all axes of a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo {
    /// Loops of X, Y, Z, A, B, C.
    pub axes: [AxisServo; AXES],
}

/// Simulated position loops, with the actual positions of the axes. Keeps its state between calls.
#[derive(Clone, Debug, PartialEq)]
pub struct PositionLoops {
    servo: Servo,
    commanded: [f64; AXES],
    lag: [f64; AXES],
    /// Lag of a point that moves at the commanded feed.
    path_lag_mm: f64,
}

impl PositionLoops {
    /// Loops with all axes at rest at the commanded position.
    pub fn new(servo: Servo, commanded: [f64; AXES]) -> Self {
        PositionLoops { servo, commanded, lag: [0.0; AXES], path_lag_mm: 0.0 }
    }

    /// Simulates a period of `dt_s` in which the commanded position moves to `commanded` (mm, degrees) at constant speed.
    pub fn step(&mut self, commanded: &[f64; AXES], dt_s: f64) {
        let axes = self.servo.axes.iter().zip(commanded).zip(self.commanded.iter_mut().zip(&mut self.lag));
        for ((servo, to), (from, lag)) in axes {
            *lag = servo.lag_after(*lag, to - *from, dt_s);
            *from = *to;
        }
    }

    /// Mean actual speed along the path in a period, mm/s, with the command at `feed_mm_per_s` in it. The commands of earlier
    /// periods have an effect through the lag; the loop is that of the slowest of X, Y, Z.
    pub fn follow(&mut self, feed_mm_per_s: f64, dt_s: f64) -> f64 {
        let before_mm = self.path_lag_mm;
        self.path_lag_mm = self.servo.slowest().lag_after(before_mm, feed_mm_per_s * dt_s, dt_s);
        feed_mm_per_s - (self.path_lag_mm - before_mm) / dt_s
    }

    /// Actual positions of the axes: X, Y, Z in mm, A, B, C in degrees.
    pub fn axes(&self) -> [f64; AXES] {
        std::array::from_fn(|axis| self.commanded[axis] - self.lag[axis])
    }

    /// Lag of each axis: commanded minus actual position, mm or degrees.
    pub fn lag(&self) -> &[f64; AXES] {
        &self.lag
    }

    /// Whether the lag of every axis is within its in-position tolerance.
    pub fn is_in_position(&self) -> bool {
        self.servo.axes.iter().zip(&self.lag).all(|(servo, lag)| libm::fabs(*lag) <= servo.in_position_mm)
    }
}

impl AxisServo {
    /// Lag after a period in which the command moves by `way_mm`, at constant speed.
    fn lag_after(&self, lag_mm: f64, way_mm: f64, dt_s: f64) -> f64 {
        let periods = self.gain_per_s * dt_s;
        let settled_mm = (1.0 - self.feed_forward_ratio) * way_mm / periods; // (3)
        lag_mm * libm::exp(-periods) - settled_mm * libm::expm1(-periods) // (2)
    }
}

impl Servo {
    /// Settings with the same loop for all axes.
    pub fn of_all(axis: AxisServo) -> Self {
        Servo { axes: [axis; AXES] }
    }

    /// Time, s, after which the change of every axis's lag by a sudden change of its speed has decayed to `ratio` of the speed over K. (4)
    pub fn settling_s(&self, ratio: f64) -> f64 {
        let of_axis = |servo: &AxisServo| libm::log((1.0 - servo.feed_forward_ratio) / ratio) / servo.gain_per_s;
        self.axes.iter().map(of_axis).fold(0.0, f64::max)
    }

    /// Loop of X, Y, Z with the smallest gain.
    fn slowest(&self) -> &AxisServo {
        let [x, y, z, ..] = &self.axes;
        [y, z].into_iter().fold(x, |slow, axis| if axis.gain_per_s < slow.gain_per_s { axis } else { slow })
    }
}
