//! The machine's report once a millisecond, and the controller's view of it.

use arcfeed_model::telemetry::Sample;
use arcfeed_nc::modal::Pose;
use arcfeed_units::{Micros, Nm};

use crate::Control;

/// Resolution of the linear axes' position feedback.
const FEEDBACK_STEP: Nm = Nm(1_000);

/// The machine's report at the time `at`: actual (not commanded) position, count of executed blocks, feed and override.
pub fn sample(control: &Control, at: Micros) -> Sample {
    Sample {
        at,
        position: control.actual_position(),
        block: control.active().map_or(0, |(count, _)| count),
        commanded: control.commanded(),
        override_percent: control.override_percent(),
    }
}

/// Position as the machine's feedback gives it: linear axes rounded to whole micrometres.
pub fn feedback(position: &Pose) -> Pose {
    let step = FEEDBACK_STEP.0;
    let whole = |Nm(nm): Nm| Nm((nm + step / 2).div_euclid(step) * step);
    Pose { linear: position.linear.map(whole), rotary: position.rotary }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feedback_comes_in_whole_steps_on_both_sides_of_zero() {
        let pose = |nm: i64| Pose { linear: [Nm(nm), Nm(0), Nm(0)], ..Pose::default() };
        for (actual, seen) in [(499, 0), (500, 1_000), (-499, 0), (-501, -1_000)] {
            assert_eq!(feedback(&pose(actual)).linear[0], Nm(seen), "{actual}");
        }
    }
}
