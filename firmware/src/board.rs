//! The seam to the hardware. A chip, an emulated board and the simulator are told apart by nothing else.

use crate::controller::{ActiveSegment, Controller, Input, Output, State};
use crate::ramp::FeedOverride;

/// What the controller needs from its surroundings.
pub trait Board {
    /// Takes the inputs of this tick.
    fn measure(&mut self);
    /// What was measured: position, spindle speed and the time since the last tick. Lent, as a copy costs the tick more
    /// than its use.
    fn input(&self) -> &Input;
    /// The segment being executed and its running count, or `None` while nothing is.
    fn segment(&self) -> Option<(u32, &ActiveSegment)>;
    /// Puts the override out.
    fn set_override(&mut self, feed_override: FeedOverride);
}

/// Which segment the controller is on, and its state.
#[derive(Clone, Copy, Debug, Default)]
pub struct Task {
    active: Option<u32>,
    state: State,
}

impl Task {
    /// One tick: measure, decide, put out. Answers what was decided, or `None` with nothing to execute.
    pub fn run(&mut self, controller: &Controller, board: &mut impl Board) -> Option<Output> {
        board.measure();
        let Some((count, segment)) = board.segment() else {
            self.active = None;
            board.set_override(FeedOverride::PROGRAMMED);
            return None;
        };
        let output = if self.active == Some(count) {
            controller.tick(&mut self.state, segment, board.input())
        } else {
            self.active = Some(count);
            controller.begin(&mut self.state, segment, board.input())
        };
        board.set_override(output.feed_override);
        Some(output)
    }
}
