//! Hardware interface: a chip, an emulated board and the simulator differ only in its implementation.

use crate::ramp::FeedOverride;
use crate::supervisor::input::{Input, Work};
use crate::supervisor::memory::Memory;
use crate::supervisor::{Output, Supervisor};

/// Hardware that the controller needs.
pub trait Board {
    /// Reads the inputs of this tick.
    fn measure(&mut self);
    /// Measured inputs, by reference: a copy would cost the tick more than its use.
    fn input(&self) -> &Input;
    /// The segment in execution and its count; `None` if there is none.
    fn work(&self) -> Work<'_>;
    /// Sets the override at the output.
    fn set_override(&mut self, feed_override: FeedOverride);
}

/// Task of a tick, with its state. The default is power-on: 0 %, rising to the operator's dial.
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
    /// Memory of the supervisor.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Runs one tick: measures, decides, sets the output. Returns the decision.
    pub fn run(&mut self, supervisor: &Supervisor, board: &mut impl Board) -> Output {
        board.measure();
        let output = supervisor.tick(&mut self.memory, board.work(), board.input());
        board.set_override(output.feed_override);
        output
    }
}

#[cfg(test)]
mod tests;
