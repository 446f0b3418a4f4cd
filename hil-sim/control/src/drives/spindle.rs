//! Response of the spindle to S, M3, M4 and M5: it accelerates and decelerates, and loses speed under load.
//!
//! ```text
//! towards the commanded speed:     dn/dt = +-a,  a of running up or down    (1)
//! under a load q of the rated:     N = n (1 - s),  s' = (D q - s)/t         (2)
//! s(T) = D q + (s(0) - D q) exp(-T/t)                                       (3)
//! arrived:                         |N - commanded| <= b |commanded|         (4)
//! ```
//!
//! (1) is linear, not a lag: a drive accelerates at its limit of torque, and the inertia is always the same. That holds
//! up to the base speed; above it a drive has constant power and is slower, which is not modelled. M4 turns the other
//! way: negative speeds. A reversal decelerates to rest, then accelerates.
//!
//! (2) is static droop D at the rated load with the time t of the speed loop; t = 0 is an ideal loop. A drive with an
//! integral part recovers the speed after a while: set D = 0; its dip is not modelled.
//!
//! Source: (1), (2) are assumed, as no manual gives a time law; drives signal speed arrival by (4). docs/servo.md.

/// Data of a spindle and its drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleDrive {
    /// Acceleration away from rest, rev/min per second.
    pub run_up_rev_per_min_s: f64,
    /// Deceleration towards rest, rev/min per second.
    pub run_down_rev_per_min_s: f64,
    /// Droop D, 0 to 1: relative loss of speed at the rated load.
    pub droop_ratio: f64,
    /// Time constant t with which the droop develops, not negative; 0: at once.
    pub droop_s: f64,
    /// Tolerance b of speed arrival, as a fraction of the commanded speed.
    pub arrival_ratio: f64,
    /// Whether cutting feed waits for speed arrival: Fanuc's parameter 3708#0, SAR.
    pub waits_for_arrival: bool,
}

/// State of the spindle. Speeds in rev/min, negative counter-clockwise (M4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleState {
    drive: SpindleDrive,
    speed: f64,
    rotation: SpindleRotation,
    ramped: f64,
    lost: f64,
    load: f64,
}

/// Commanded rotation: M3, M4, M5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpindleRotation {
    /// M3, clockwise.
    Clockwise,
    /// M4, counter-clockwise.
    CounterClockwise,
    /// M5, stop.
    Stop,
}

impl SpindleState {
    /// Spindle at rest, with the commanded speed 0 and M5.
    pub fn new(drive: SpindleDrive) -> Self {
        SpindleState { drive, speed: 0.0, rotation: SpindleRotation::Stop, ramped: 0.0, lost: 0.0, load: 0.0 }
    }

    /// Sets the commanded speed (S), without sign; the rotation gives its sense.
    pub fn set_speed(&mut self, rev_per_min: f64) {
        self.speed = rev_per_min;
    }

    /// Commands the rotation: M3, M4 or M5.
    pub fn set_rotation(&mut self, rotation: SpindleRotation) {
        self.rotation = rotation;
    }

    /// Sets the present cutting load, as a fraction of the rated load.
    pub fn set_load(&mut self, ratio: f64) {
        self.load = ratio;
    }

    /// Simulates a period of `dt_s`.
    pub fn step(&mut self, dt_s: f64) {
        self.ramped = self.ramp(self.ramped, dt_s);
        let end = self.drive.droop_ratio * self.load;
        self.lost = end + (self.lost - end) * libm::exp(-dt_s / self.drive.droop_s); // (3)
    }

    /// Actual speed; negative counter-clockwise (M4).
    pub fn rev_per_min(&self) -> f64 {
        self.ramped * (1.0 - self.lost) // (2)
    }

    /// Commanded speed; negative counter-clockwise (M4), 0 at M5.
    pub fn commanded_rev_per_min(&self) -> f64 {
        match self.rotation {
            SpindleRotation::Clockwise => self.speed,
            SpindleRotation::CounterClockwise => -self.speed,
            SpindleRotation::Stop => 0.0,
        }
    }

    /// Whether the spindle has reached the commanded speed; for a commanded stop, whether it has stopped.
    pub fn has_arrived(&self) -> bool {
        let commanded = self.commanded_rev_per_min();
        libm::fabs(self.rev_per_min() - commanded) <= self.drive.arrival_ratio * libm::fabs(commanded) // (4)
    }

    /// Whether cutting feed must wait: the drive has speed arrival, and the spindle has not reached its commanded speed.
    pub fn is_waited_for(&self) -> bool {
        self.drive.waits_for_arrival && !self.has_arrived()
    }

    /// Speed without load after a period, from a speed. (1)
    fn ramp(&self, from: f64, dt_s: f64) -> f64 {
        let to = self.commanded_rev_per_min();
        let slowest = if from * to < 0.0 { 0.0 } else { to };
        let is_down = libm::fabs(slowest) < libm::fabs(from);
        let rate = if is_down { self.drive.run_down_rev_per_min_s } else { self.drive.run_up_rev_per_min_s };
        let way = slowest - from;
        let needed_s = libm::fabs(way) / rate;
        if needed_s > dt_s {
            return from + libm::copysign(rate * dt_s, way);
        }
        if slowest == to { to } else { self.ramp(0.0, dt_s - needed_s) }
    }
}
