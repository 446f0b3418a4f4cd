//! Limits of a machine's drives, and the corner tolerance of the control.

use arcfeed_units::S_PER_MIN;
use serde::Deserialize;

/// Drive limits of one axis; for a rotary axis, degrees in place of mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Greatest speed, mm/s.
    pub speed_mm_per_s: f64,
    /// Greatest acceleration, mm/s^2.
    pub acceleration_mm_per_s2: f64,
    /// Greatest jerk, mm/s^3.
    pub jerk_mm_per_s3: f64,
}

/// Drives of a machine, if its file describes all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drives {
    /// X, Y, Z.
    pub linear: [Drive; 3],
    /// Rotary axes, from the part to the tool.
    pub rotary: [Drive; 2],
    /// Corner tolerance: largest distance between the path and a programmed corner.
    pub tolerance: Tolerance,
}

/// Corner tolerance: greatest distance between path and programmed corner.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Tolerance {
    /// Tolerance of the linear axes, mm.
    #[serde(rename = "linear")]
    pub linear_mm: f64,
    /// Tolerance of the rotary axes, degrees.
    #[serde(rename = "rotary")]
    pub rotary_deg: f64,
}

/// Position loops of a machine file, equal for all axes.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Loops {
    /// Loop gain.
    #[serde(rename = "gain")]
    pub gain_per_s: f64,
    /// Velocity feed-forward, 0 to 1.
    #[serde(rename = "feed_forward", default)]
    pub feed_forward_ratio: f64,
    /// Greatest lag of an axis that is in position, mm or degrees.
    #[serde(rename = "in_position", default = "in_position")]
    pub in_position_mm: f64,
}

/// Spindle drive of a machine file.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct SpindleRamps {
    /// Acceleration, rev/min per second.
    #[serde(rename = "run_up")]
    pub run_up_rev_per_min_s: f64,
    /// Deceleration, rev/min per second.
    #[serde(rename = "run_down")]
    pub run_down_rev_per_min_s: f64,
    /// Deviation from the commanded speed within which the speed counts as arrived, as a fraction.
    #[serde(rename = "arrival", default = "arrival")]
    pub arrival_ratio: f64,
    /// Cutting feed waits until the speed has arrived.
    #[serde(default)]
    pub waits: bool,
}

fn in_position() -> f64 {
    0.01
}

fn arrival() -> f64 {
    0.05
}

impl Loops {
    /// Whether the values are in range.
    pub fn are_possible(&self) -> bool {
        let positive = [self.gain_per_s, self.in_position_mm].into_iter().all(|value| value > 0.0 && value.is_finite());
        positive && (0.0..=1.0).contains(&self.feed_forward_ratio)
    }
}

impl SpindleRamps {
    /// Whether the values are in range.
    pub fn are_possible(&self) -> bool {
        let positive = [self.run_up_rev_per_min_s, self.run_down_rev_per_min_s, self.arrival_ratio];
        positive.into_iter().all(|value| value > 0.0 && value.is_finite())
    }
}

/// Fault in the drive values of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveError {
    /// The axis with this index (X, Y, Z, then the rotary axes in the order of the file) lacks a limit, or has one that
    /// is not above 0.
    Axis(usize),
    /// A tolerance that is not above zero.
    Tolerance,
}

/// Limits of one axis as a file gives them: speed (mm or degrees per minute), acceleration, jerk (mm or degrees, s).
pub type DriveValues = [Option<f64>; 3];

impl Default for Tolerance {
    fn default() -> Self {
        Tolerance { linear_mm: 0.01, rotary_deg: 0.01 }
    }
}

impl Drives {
    /// Drives of X, Y, Z and both rotary axes; `None` if no axis has an acceleration or a jerk.
    ///
    /// # Errors
    /// An axis has an acceleration or a jerk while another has not all three limits, or a value is not above 0.
    pub fn new(values: [DriveValues; 5], tolerance: Tolerance) -> Result<Option<Self>, DriveError> {
        if values.iter().all(|[_, acceleration, jerk]| acceleration.is_none() && jerk.is_none()) {
            return Ok(None);
        }
        if ![tolerance.linear_mm, tolerance.rotary_deg]
            .iter()
            .all(|tolerance| *tolerance > 0.0 && tolerance.is_finite())
        {
            return Err(DriveError::Tolerance);
        }
        let drive = |axis: usize| {
            let [speed, acceleration, jerk] = values[axis];
            let positive = |value: Option<f64>| value.filter(|value| *value > 0.0 && value.is_finite());
            let per_min = positive(speed).ok_or(DriveError::Axis(axis))?;
            Ok(Drive {
                speed_mm_per_s: per_min / S_PER_MIN,
                acceleration_mm_per_s2: positive(acceleration).ok_or(DriveError::Axis(axis))?,
                jerk_mm_per_s3: positive(jerk).ok_or(DriveError::Axis(axis))?,
            })
        };
        let linear = [drive(0)?, drive(1)?, drive(2)?];
        Ok(Some(Drives { linear, rotary: [drive(3)?, drive(4)?], tolerance }))
    }

    /// These drives with other maximum speeds, in mm or degrees per minute; `None` keeps the present one.
    #[must_use]
    pub fn with_speeds(mut self, per_min: [Option<f64>; 5]) -> Self {
        for (drive, speed) in self.linear.iter_mut().chain(&mut self.rotary).zip(per_min) {
            drive.speed_mm_per_s = speed.map_or(drive.speed_mm_per_s, |speed| speed / S_PER_MIN);
        }
        self
    }
}

impl std::fmt::Display for DriveError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            DriveError::Axis(_) => f.write_str(
                "an axis has an acceleration or a jerk, so each needs `max_feed`, `acceleration` and `jerk`, above zero",
            ),
            DriveError::Tolerance => f.write_str("the tolerances of corners must be above zero"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXIS: DriveValues = [Some(6_000.0), Some(500.0), Some(20_000.0)];

    #[test]
    fn drives_are_given_for_all_axes_or_of_none() {
        let tolerance = Tolerance::default();
        assert_eq!(Drives::new([[Some(6_000.0), None, None]; 5], tolerance), Ok(None));
        let drives = Drives::new([AXIS; 5], tolerance).unwrap().unwrap();
        assert!((drives.rotary[1].speed_mm_per_s - 100.0).abs() < 1e-12);
        for missing in 0..3 {
            let mut values = [AXIS; 5];
            values[4][missing] = None;
            assert_eq!(Drives::new(values, tolerance), Err(DriveError::Axis(4)));
            values[4][missing] = Some(0.0);
            assert_eq!(Drives::new(values, tolerance), Err(DriveError::Axis(4)));
        }
        let none = Tolerance { linear_mm: 0.0, rotary_deg: 0.01 };
        assert_eq!(Drives::new([AXIS; 5], none), Err(DriveError::Tolerance));
    }
}
