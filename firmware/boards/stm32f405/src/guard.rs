//! The supervisor of the tick, with the block in execution found from the position. Pure; contains all decisions of
//! this board by [`arcfeed_firmware::supervisor`].

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::queue::Follower;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::{Settings, SettingsError};
use arcfeed_firmware::supervisor::{Output, Supervisor};
use arcfeed_model::job::Job;
use heapless::spsc::Consumer;

/// A prepared block, with the number of the run of the program to which it belongs.
pub type Prepared = (u32, ActiveSegment);

/// Feed controller of the board: supervisor and queue of prepared blocks, with their state.
pub struct Guard<'q> {
    supervisor: Supervisor,
    memory: Memory,
    follower: Follower,
    blocks: Consumer<'q, Prepared>,
    run: u32,
}

impl<'q> Guard<'q> {
    /// Controller for a job, with the default settings of the supervisor and this queue of blocks.
    ///
    /// # Errors
    /// The bounds of the override in the job are invalid.
    pub fn new(job: &Job, blocks: Consumer<'q, Prepared>) -> Result<Self, SettingsError> {
        let supervisor = Supervisor::new(job, Settings::default())?;
        Ok(Guard { supervisor, memory: Memory::default(), follower: Follower::default(), blocks, run: 0 })
    }

    /// Number of the current run of the program; blocks of other runs are discarded.
    pub fn run(&self) -> u32 {
        self.run
    }

    /// Whether the laws are armed; the program's zero must not be set then.
    pub fn is_engaged(&self) -> bool {
        self.memory.state().is_engaged()
    }

    /// Starts a new run of the program; blocks of earlier runs are discarded.
    pub fn restart(&mut self) {
        self.run = self.run.wrapping_add(1);
        self.follower.restart();
    }

    /// Runs one control tick with these inputs; returns the decision.
    pub fn tick(&mut self, input: &Input) -> Output {
        while self.blocks.peek().is_some_and(|(run, _)| *run != self.run) {
            let _of_another_run = self.blocks.dequeue();
        }
        let front = self.blocks.peek().map(|(_, segment)| segment);
        let output = self.supervisor.tick(&mut self.memory, self.follower.in_work(front), input);
        let controller = self.supervisor.controller();
        if front.is_some_and(|segment| self.follower.follow(controller, segment, &input.measured)) {
            let _done = self.blocks.dequeue();
        }
        output
    }
}
