//! Sensor values of a board, and the machine line of a board without sensors of its own.

use arcfeed_link::message::moves::pose;
use arcfeed_link::message::table::{Sample, Setpoint};
use arcfeed_nc::modal::Pose;
use arcfeed_units::{Micros, RevPerMin, Span};

use arcfeed_firmware::output::line_code::LineCode;
use arcfeed_firmware::supervisor::Output;
use arcfeed_firmware::supervisor::input::Freshness;
use arcfeed_firmware::supervisor::signals::Signals;

use super::report::state_code;

/// Measured values of a board, from which the control task decides at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Position of the tool's centre in workpiece coordinates; `None` before the first sample.
    pub position: Option<Pose>,
    /// Age and validity of the position.
    pub freshness: Freshness,
    /// Measured spindle speed; 0 if unknown.
    pub spindle: RevPerMin,
    /// Position of the operator's override dial, %.
    pub operator_percent: u8,
    /// Conditions of the control, buttons, and faults of the board.
    pub signals: Signals,
}

/// Receiver of the samples that a simulated or remote machine sends to a board without sensors of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MachineLine {
    last: Sensors,
    heard: Option<Micros>,
    /// Time of the latest sample by the machine's clock.
    latest: Option<u64>,
}

impl Default for MachineLine {
    fn default() -> Self {
        MachineLine::new()
    }
}

impl MachineLine {
    /// Receiver before the first sample: the position has the maximum age, and the dial is at 0 %.
    pub const fn new() -> Self {
        let last = Sensors {
            position: None,
            freshness: Freshness { age: Span(u32::MAX), invalid_in_row: 0 },
            spindle: RevPerMin(0.0),
            operator_percent: 0,
            signals: Signals::NONE,
        };
        MachineLine { last, heard: None, latest: None }
    }

    /// Processes a sample that arrived at `now`. Returns false, and counts the sample as invalid, if it is invalid or
    /// not later than an earlier one; a copy does not give the current position.
    pub fn on_sample(&mut self, now: Micros, sample: &Sample) -> bool {
        let position = sample.linear.map(|linear| pose(linear, sample.rotary)).transpose();
        let is_copy = self.latest.is_some_and(|latest| sample.at <= latest);
        let (Ok(position), Some(signals), false) = (position, Signals::of_machine(sample.signals), is_copy) else {
            self.count_invalid();
            return false;
        };
        self.latest = Some(sample.at);
        if position.is_some() {
            (self.last.position, self.heard) = (position, Some(now));
            self.last.freshness.invalid_in_row = 0;
        }
        self.last.spindle = RevPerMin(sample.spindle.value());
        (self.last.operator_percent, self.last.signals) = (sample.operator_percent, signals);
        true
    }

    /// Counts a frame that could not be read; enough of them in a row count as a loss of the position.
    pub fn count_invalid(&mut self) {
        let invalid = &mut self.last.freshness.invalid_in_row;
        *invalid = invalid.saturating_add(1);
    }

    /// Measured values at the time `now`, from the newest valid sample.
    pub fn sensors(&self, now: Micros) -> Sensors {
        let age = self.heard.map_or(Span(u32::MAX), |heard| now.since(heard).into());
        Sensors { freshness: Freshness { age, ..self.last.freshness }, ..self.last }
    }
}

/// Answer to the machine's sample of the time `at`: the outputs of the tick, and the numbers of bytes that the board
/// has sent before it on the link and on the tapped line.
pub fn setpoint(at: u64, output: &Output, [link_bytes, tap_bytes]: [u32; 2]) -> Setpoint {
    let lines = !LineCode::of(output.feed_override).levels();
    Setpoint { at, lines, state: state_code(&output.state), link_bytes, tap_bytes }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_firmware::ramp::FeedOverride;
    use arcfeed_firmware::supervisor::report::{Alarm, Reason};
    use arcfeed_firmware::supervisor::signals::{BoardFault, Request};
    use arcfeed_firmware::supervisor::state::{Hold, State};
    use arcfeed_link::message::codes::{ModeCode, StateCode};
    use arcfeed_link::message::fixed::Q40;
    use arcfeed_units::Nm;

    fn sample() -> Sample {
        Sample {
            at: 5,
            mode: ModeCode::Free,
            linear: Some([1_000, -2_000, 3_000]),
            rotary: None,
            spindle: Q40::of(1_000.0_f32).unwrap(),
            operator_percent: 100,
            signals: 0,
            link_bytes: 0,
            tap_bytes: 0,
        }
    }

    #[test]
    fn before_the_first_sample_there_is_no_position_and_the_dial_is_down() {
        let sensors = MachineLine::new().sensors(Micros(7));
        assert_eq!((sensors.position, sensors.operator_percent), (None, 0));
        assert_eq!(sensors.freshness.age, Span(u32::MAX));
    }

    #[test]
    fn a_sample_is_what_it_says_and_grows_old() {
        let mut line = MachineLine::new();
        let signals = Signals::FEED_HOLD.with(Signals::of_request(Request::Arm));
        assert!(line.on_sample(Micros(1_000), &Sample { signals: signals.bits(), ..sample() }));
        let sensors = line.sensors(Micros(4_500));
        assert_eq!(sensors.position.unwrap().linear, [1_000, -2_000, 3_000].map(Nm));
        assert_eq!((sensors.spindle.0, sensors.signals, sensors.freshness.age), (1_000.0, signals, Span(3_500)));
        // Without a new position the rest is news, the position is not.
        line.on_sample(Micros(5_000), &Sample { at: 6, linear: None, operator_percent: 80, ..sample() });
        let sensors = line.sensors(Micros(5_000));
        assert_eq!((sensors.operator_percent, sensors.freshness.age), (80, Span(4_000)));
    }

    #[test]
    fn what_makes_no_sense_is_counted_and_changes_nothing_else() {
        let mut line = MachineLine::new();
        line.on_sample(Micros(0), &sample());
        let before = line.sensors(Micros(9));
        let fault = Signals::of_fault(BoardFault::Watchdog).bits();
        assert!(!line.on_sample(Micros(5), &Sample { signals: fault, ..sample() }), "only the board knows its faults");
        assert!(!line.on_sample(Micros(5), &Sample { linear: Some([i64::MAX; 3]), ..sample() }));
        line.count_invalid();
        let freshness = Freshness { invalid_in_row: 3, ..before.freshness };
        assert_eq!(line.sensors(Micros(9)), Sensors { freshness, ..before });
        line.on_sample(Micros(9), &Sample { at: 6, ..sample() });
        assert_eq!(line.sensors(Micros(9)).freshness, Freshness::NOW);
    }

    #[test]
    fn recorded_samples_that_come_again_and_again_are_no_position() {
        let mut line = MachineLine::new();
        let recorded = (1..=60).map(|at| Sample { at, ..sample() });
        assert!(recorded.clone().all(|sample| line.on_sample(Micros(sample.at), &sample)));
        for (sample, ms) in recorded.cycle().zip(61..1_000) {
            assert!(!line.on_sample(Micros(ms), &sample));
        }
        let freshness = Freshness { age: Span(940), invalid_in_row: u8::MAX };
        assert_eq!(line.sensors(Micros(1_000)).freshness, freshness);
    }

    #[test]
    fn a_setpoint_has_the_lines_that_are_low() {
        let output = Output {
            feed_override: FeedOverride { percent: 117 },
            state: State::Holding { cause: Hold::Feed },
            reason: Reason::Law,
            alarm: Alarm::None,
            refusal: None,
            ipt_center: None,
        };
        let expected = Setpoint { at: 9, lines: 117, state: StateCode::Holding, link_bytes: 1, tap_bytes: 2 };
        assert_eq!(setpoint(9, &output, [1, 2]), expected);
    }
}
