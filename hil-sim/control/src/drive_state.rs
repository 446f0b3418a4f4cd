//! State of the drives, and the conditions that the control waits for: axes in position, spindle speed reached.
//!
//! A rapid ends at rest, and the next block waits until all axes are in position (parameter 1601#5, NCI, at 0). With
//! speed arrival (parameter 3708#0, SAR) the first cutting feed after a rapid, an S or a change of M3, M4, M5 waits
//! until the spindle has its speed; if the S is in the block of a move that flows, the axes brake on that move. A
//! cutting feed that has begun continues, even if the load slows the spindle. A dwell begins when the axes are in
//! position.
//!
//! Without data of the drives the axes have their commanded positions, and nothing waits. Not modelled: the position
//! check before M, S, T functions after cutting feed, the time 3740 before SAR is checked, the spindle in canned
//! cycles.
//!
//! Source: time of the SAR check, Fanuc Power Mate i-H/D connection manual B-63443EN/02 p. 197.

use arcfeed_nc::block::{Block, parse_line};
use arcfeed_nc::modal::{Pose, ProgramStop};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_nc::settings::Reading;
use arcfeed_units::{Micros, MmPerMin, S_PER_MIN};

use crate::drives::limits::AXES;
use crate::drives::servo::PositionLoops;
use crate::drives::spindle::{SpindleRotation, SpindleState};

use super::Control;
use super::action::{Action, ReadBlock};
use super::path::to_pose;
use super::settings::{ControlSettings, Switches};

/// Drives of the axes and of the spindle in a simulated control, with what the control waits for. Keeps its state between calls.
#[derive(Debug)]
pub struct DriveState {
    loops: Option<PositionLoops>,
    spindle: Option<SpindleState>,
    feed: MmPerMin,
    /// Whether the last move begun is a rapid.
    is_rapid: bool,
    /// Whether the next cutting feed waits for the spindle.
    awaits_spindle: bool,
}

impl DriveState {
    /// Drives at rest at the origin; only those for which the settings have data are simulated.
    pub fn new(settings: &ControlSettings) -> Self {
        DriveState {
            loops: settings.servo.map(|servo| PositionLoops::new(servo, [0.0; AXES])),
            spindle: settings.spindle.map(SpindleState::new),
            feed: MmPerMin(0.0),
            is_rapid: false,
            awaits_spindle: false,
        }
    }

    /// Records that the control has begun this move: whether it is a rapid, and whether it waits for the spindle.
    pub fn begin(&mut self, segment: &Segment) {
        self.is_rapid = segment.path == Path::Rapid;
        self.awaits_spindle = self.is_rapid || self.awaits_spindle && self.is_waited_for();
    }

    /// Simulates one period, at the end of which the axes are commanded to `axes`, with the feed `commanded`.
    pub fn step(&mut self, axes: &[f64; AXES], commanded: MmPerMin, dt: Micros) {
        self.feed = commanded;
        if let Some(loops) = &mut self.loops {
            loops.step(axes, dt.to_s());
            self.feed = MmPerMin((loops.follow(f64::from(commanded.0) / S_PER_MIN, dt.to_s()) * S_PER_MIN) as f32);
        }
        if let Some(spindle) = &mut self.spindle {
            spindle.step(dt.to_s());
        }
    }

    /// Applies the S and M functions (M3, M4, M5) of a block to the spindle.
    pub fn apply_block(&mut self, block: &ReadBlock, switches: &Switches) {
        let Some(spindle) = self.spindle.as_mut().filter(|_| block.action != Action::Nothing) else { return };
        let before = spindle.commanded_rev_per_min();
        if let Ok(parsed) = parse_line(&block.text, Reading::Lenient) {
            command(spindle, &parsed.block, switches);
        }
        self.awaits_spindle |= spindle.commanded_rev_per_min() != before;
    }

    /// Stops the spindle if `stop` is M2 or M30, as the ladder of a machine does; also used at a reset.
    pub fn end(&mut self, stop: ProgramStop) {
        if let (Some(spindle), ProgramStop::End) = (&mut self.spindle, stop) {
            spindle.set_rotation(SpindleRotation::Stop);
        }
    }

    /// Whether the move in execution must wait because the spindle has not reached its commanded speed.
    pub fn holds(&self) -> bool {
        self.awaits_spindle && !self.is_rapid && self.is_waited_for()
    }

    /// Whether the move in execution ends at rest because the next block waits: it is a rapid, and the next block waits for axes in
    /// position or for the spindle.
    pub fn stops_at_block_end(&self) -> bool {
        self.is_rapid && (self.loops.is_some() || self.is_waited_for())
    }

    fn is_waited_for(&self) -> bool {
        self.spindle.as_ref().is_some_and(SpindleState::is_waited_for)
    }
}

impl Control {
    /// Actual position of the axes, in whole nanometres and microdegrees; it lags behind the commanded position.
    pub fn actual_position(&self) -> Pose {
        self.drive_state.loops.as_ref().map_or(self.position(), |loops| to_pose(&loops.axes()))
    }

    /// Actual position, unrounded: X, Y, Z in mm, A, B, C in degrees.
    pub fn actual_axes(&self) -> [f64; AXES] {
        self.drive_state.loops.as_ref().map_or(*self.axes(), PositionLoops::axes)
    }

    /// Whether the axes pass exactly through the corners between blocks: neither rounding nor lag is simulated.
    pub fn meets_corners(&self) -> bool {
        self.settings.drives.is_none() && self.settings.servo.is_none()
    }

    /// Feed along the path at which the axes actually move: the commanded feed, delayed by their lag.
    pub fn followed_feed(&self) -> MmPerMin {
        self.drive_state.feed
    }

    /// Whether all axes are in position: their lag is within the tolerance. Always true without data of the servos.
    pub fn is_in_position(&self) -> bool {
        self.drive_state.loops.as_ref().is_none_or(PositionLoops::is_in_position)
    }

    /// State of the spindle; `None` if the spindle is not simulated.
    pub fn spindle(&self) -> Option<&SpindleState> {
        self.drive_state.spindle.as_ref()
    }

    /// State of the spindle, to set its cutting load; `None` if the spindle is not simulated.
    pub fn spindle_mut(&mut self) -> Option<&mut SpindleState> {
        self.drive_state.spindle.as_mut()
    }

    /// Time, s, after which the lag of the axes has settled to `ratio` after a sudden change of commanded speed; 0 without servos.
    pub fn settling_s(&self, ratio: f64) -> f64 {
        self.settings.servo.map_or(0.0, |servo| servo.settling_s(ratio))
    }

    /// Whether the next block waits for the axes to be in position.
    pub(super) fn awaits_position(&self) -> bool {
        self.drive_state.is_rapid && !self.is_in_position()
    }
}

fn command(spindle: &mut SpindleState, block: &Block, switches: &Switches) {
    let is_cut_off = block.delete.is_some_and(|switch| switches.deletes(switch));
    let count = if is_cut_off { block.delete_from } else { block.words.len() };
    for word in block.words.iter().take(count) {
        match (word.letter, word.number.as_whole()) {
            (b'S', _) => spindle.set_speed(word.number.scaled(1) as f64),
            (b'M', Some(3)) => spindle.set_rotation(SpindleRotation::Clockwise),
            (b'M', Some(4)) => spindle.set_rotation(SpindleRotation::CounterClockwise),
            (b'M', Some(5)) => spindle.set_rotation(SpindleRotation::Stop),
            _ => {}
        }
    }
}
