//! The supervisor around the tick, with the block in work found from the position. Pure; all that this board uses of
//! [`arcfeed_firmware::supervisor`] to decide is here.

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::queue::Follower;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::{Settings, SettingsError};
use arcfeed_firmware::supervisor::{Output, Supervisor};
use arcfeed_shared::job::Job;
use heapless::spsc::Consumer;

/// A prepared block, and the run of the program it belongs to.
pub type Prepared = (u32, ActiveSegment);

/// Supervisor, the blocks ahead and what they remember.
pub struct Guard<'q> {
    supervisor: Supervisor,
    memory: Memory,
    follower: Follower,
    blocks: Consumer<'q, Prepared>,
    run: u32,
}

impl<'q> Guard<'q> {
    /// A guard for a job, with the default settings; blocks come from elsewhere.
    ///
    /// # Errors
    /// Bounds of the override that make no sense.
    pub fn new(job: &Job, blocks: Consumer<'q, Prepared>) -> Result<Self, SettingsError> {
        let supervisor = Supervisor::new(job, Settings::default())?;
        Ok(Guard { supervisor, memory: Memory::default(), follower: Follower::default(), blocks, run: 0 })
    }

    /// Which run's blocks are taken.
    pub fn run(&self) -> u32 {
        self.run
    }

    /// Whether the laws have the override or get it back by themselves: no time to set zero.
    pub fn is_engaged(&self) -> bool {
        self.memory.state().is_engaged()
    }

    /// The program begins anew: blocks of the runs till now are forgotten.
    pub fn restart(&mut self) {
        self.run = self.run.wrapping_add(1);
        self.follower.restart();
    }

    /// One tick.
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
