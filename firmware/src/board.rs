//! The seam to the hardware. A chip, an emulated board and the simulator are told apart by nothing else.

use crate::ramp::FeedOverride;
use crate::supervisor::input::{Input, Work};
use crate::supervisor::memory::Memory;
use crate::supervisor::{Output, Supervisor};

/// What the controller needs from its surroundings.
pub trait Board {
    /// Takes the inputs of this tick.
    fn measure(&mut self);
    /// What was measured. Lent, as a copy costs the tick more than its use.
    fn input(&self) -> &Input;
    /// The segment being executed and its running count, or `None` while nothing is.
    fn work(&self) -> Work<'_>;
    /// Puts the override out.
    fn set_override(&mut self, feed_override: FeedOverride);
}

/// What runs at every tick, and its state. The default is power-on: 0 %, rising to the operator's dial.
#[derive(Clone, Copy, Debug, Default)]
pub struct Task {
    memory: Memory,
}

impl From<Memory> for Task {
    /// Goes on from there.
    fn from(memory: Memory) -> Self {
        Task { memory }
    }
}

impl Task {
    /// What the supervisor remembers.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// One tick: measure, decide, put out. Answers what was decided.
    pub fn run(&mut self, supervisor: &Supervisor, board: &mut impl Board) -> Output {
        board.measure();
        let output = supervisor.tick(&mut self.memory, board.work(), board.input());
        board.set_override(output.feed_override);
        output
    }
}

#[cfg(test)]
mod tests;
