//! Programs executed under limits of all axes, and what their axes did.

use arcfeed_control::drives::limits::{AXES, AxisLimits, DriveLimits};
use arcfeed_control::{Control, ControlSettings, Preset};
use arcfeed_units::{LengthUnit, Micros};

pub const STEP: Micros = Micros::from_ms(1);
/// A program that takes longer than this hangs.
const LONGEST: Micros = Micros::from_ms(3_600_000);

/// Positions of all axes, a millisecond apart.
pub struct Motion {
    pub axes: Vec<[f64; AXES]>,
}

/// Largest values of each axis.
#[derive(Debug, Default)]
pub struct Greatest {
    pub speed: [f64; AXES],
    pub acceleration: [f64; AXES],
    pub jerk: [f64; AXES],
}

/// A mid-size machine: 12 m/min, 0.5 m/s2, 20 m/s3; rotary axes 3600 deg/min, 300 deg/s2, 10 000 deg/s3.
pub fn drives() -> DriveLimits {
    let linear = AxisLimits { speed_mm_per_s: 200.0, acceleration_mm_per_s2: 500.0, jerk_mm_per_s3: 20_000.0 };
    let rotary = AxisLimits { speed_mm_per_s: 60.0, acceleration_mm_per_s2: 300.0, jerk_mm_per_s3: 10_000.0 };
    let axes = [linear, linear, linear, rotary, rotary, rotary];
    DriveLimits { axes, tolerance_mm: 0.01, tolerance_deg: 0.01 }
}

pub fn settings(drives: DriveLimits) -> ControlSettings {
    ControlSettings { drives: Some(drives), operator_restart: None, ..Preset::Fanuc31i.settings(LengthUnit::Mm) }
}

impl Motion {
    /// Runs a program from memory; `percent` is the override of each millisecond.
    pub fn of(program: &str, settings: ControlSettings, percent: impl Fn(u64) -> u8) -> Self {
        let mut control = Control::from_memory(settings, format!("{program}\nM30\n").as_bytes());
        let (mut axes, mut now) = (vec![*control.axes(); 3], Micros(0));
        while !control.is_over() {
            now = now.after(STEP);
            control.step(now, STEP, percent(now.0 / 1_000));
            axes.push(*control.axes());
            assert!(now < LONGEST, "at {:?}", control.axes());
        }
        assert_eq!(control.alarm(), None, "{program}");
        axes.extend([*control.axes(); 3]);
        Motion { axes }
    }

    /// Periods in which an axis moved.
    pub fn seconds(&self) -> f64 {
        self.axes.windows(2).filter(|at| at[0] != at[1]).count() as f64 * STEP.to_s()
    }

    pub fn greatest(&self) -> Greatest {
        let mut greatest = Greatest::default();
        let t = STEP.to_s();
        for at in self.axes.windows(4) {
            for axis in 0..AXES {
                let [p, q, r, s] = [at[0][axis], at[1][axis], at[2][axis], at[3][axis]];
                let most = |of: &mut [f64; AXES], value: f64| of[axis] = of[axis].max(value.abs());
                most(&mut greatest.speed, (s - r) / t);
                most(&mut greatest.acceleration, (s - 2.0 * r + q) / (t * t));
                most(&mut greatest.jerk, (s - 3.0 * r + 3.0 * q - p) / (t * t * t));
            }
        }
        greatest
    }

    /// Fails where an axis was beyond what it can do. A stop is met to 1e-10 mm, which is up to 1 mm/s3 of jerk in differences; the rest is
    /// rounding in differences.
    pub fn keeps(&self, drives: &DriveLimits, what: &str) {
        let greatest = self.greatest();
        for (axis, limits) in drives.axes.iter().enumerate() {
            let over = [
                greatest.speed[axis] / limits.speed_mm_per_s - 1.0,
                greatest.acceleration[axis] / limits.acceleration_mm_per_s2 - 1.0,
                (greatest.jerk[axis] - 1.0) / limits.jerk_mm_per_s3 - 1.0,
            ];
            assert!(over.iter().all(|over| *over <= 1e-6), "{what}: axis {axis}: {over:?} over its limits");
        }
    }
}
