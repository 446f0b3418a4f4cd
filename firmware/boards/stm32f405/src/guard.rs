//! The supervisor around the tick, with the block in work found from the position. Pure; all that this board uses of
//! [`arcfeed_firmware::supervisor`] to decide is here.
//!
//! The queue follows the axes with a progress of its own: the supervisor's stands still, at what it was on a segment before,
//! while samples are stale or the segment in work is one whose beginning it did not see; and the queue must get past that
//! one for the next to begin.

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller::{self, Controller};
use arcfeed_firmware::queue::SegmentQueue;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::{Settings, SettingsError};
use arcfeed_firmware::supervisor::{Output, Supervisor};
use arcfeed_shared::job::Job;

/// Blocks at hand: the one in work, and some for short ones behind it.
const AT_HAND: usize = 4;

/// Supervisor, queue and what they remember.
#[derive(Debug)]
pub struct Guard {
    supervisor: Supervisor,
    memory: Memory,
    controller: Controller,
    followed: controller::State,
    entered: Option<u32>,
    queue: SegmentQueue<AT_HAND>,
}

impl Guard {
    /// A guard for a job, with the default settings.
    ///
    /// # Errors
    /// Bounds of the override that make no sense.
    pub fn new(job: &Job) -> Result<Self, SettingsError> {
        let supervisor = Supervisor::new(job, Settings::default())?;
        Ok(Guard {
            supervisor,
            memory: Memory::default(),
            controller: Controller::new(job).map_err(SettingsError::Limits)?,
            followed: controller::State::default(),
            entered: None,
            queue: SegmentQueue::new(),
        })
    }

    /// Whether a block can be pushed.
    pub fn has_room(&self) -> bool {
        !self.queue.is_full()
    }

    /// Adds a block behind the others; lost if there is no room.
    pub fn push(&mut self, segment: ActiveSegment) {
        self.queue.push(segment);
    }

    /// Whether the laws have the override or get it back by themselves: no time to set zero.
    pub fn is_engaged(&self) -> bool {
        self.memory.state().is_engaged()
    }

    /// Forgets all blocks: the program begins anew. At least one tick must come before the next block.
    pub fn restart(&mut self) {
        self.queue = SegmentQueue::new();
        self.followed = controller::State::default();
        self.entered = None;
    }

    /// One tick.
    pub fn tick(&mut self, input: &Input) -> Output {
        let output = self.supervisor.tick(&mut self.memory, self.queue.in_work(), input);
        self.follow(&input.measured);
        output
    }

    /// Moves along the block in work, and on to the next at its end.
    fn follow(&mut self, measured: &controller::Input) {
        let Some((count, segment)) = self.queue.in_work() else { return };
        if self.entered != Some(count) {
            self.controller.begin(&mut self.followed, segment, measured);
            self.entered = Some(count);
        } else {
            self.controller.tick(&mut self.followed, segment, measured);
        }
        self.queue.leave_if_done(&self.followed, measured.position.as_ref());
    }
}
