//! Hardware interface: a chip, an emulated board and the simulator differ only in its implementation.

use crate::ramp::FeedOverride;
use crate::supervisor::input::{Input, Work};
use crate::supervisor::memory::Memory;
use crate::supervisor::{Output, Supervisor};

/// Hardware that the controller needs, implemented once for each chip, emulator or simulator.
pub trait Board {
    /// Reads the inputs at the beginning of a tick; [`Board::input`] then returns them.
    fn measure(&mut self);
    /// Inputs that [`Board::measure`] has read. By reference, because a copy would take the tick longer than their
    /// use.
    fn input(&self) -> &Input;
    /// The segment in execution, with a number that is different for each segment; `None` if none is in execution.
    fn work(&self) -> Work<'_>;
    /// Passes the override of this tick to the control.
    fn set_override(&mut self, feed_override: FeedOverride);
}

/// The feed controller's work at each control tick, with its state between ticks. By default as after power-on: 0 %,
/// from where the override rises to the operator's dial.
#[derive(Clone, Copy, Debug, Default)]
pub struct Task {
    memory: Memory,
}

impl From<Memory> for Task {
    /// A task that continues from this memory.
    fn from(memory: Memory) -> Self {
        Task { memory }
    }
}

impl Task {
    /// State of the supervisor, which decides whether the feed laws may set the override.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Runs one tick: reads the inputs, decides on the override, sets the output. Returns the decision.
    pub fn run(&mut self, supervisor: &Supervisor, board: &mut impl Board) -> Output {
        board.measure();
        let output = supervisor.tick(&mut self.memory, board.work(), board.input());
        board.set_override(output.feed_override);
        output
    }
}

#[cfg(test)]
mod tests;
