//! Sends commands and notices to the control task: notices take effect at once, commands in order. None is lost if a
//! queue is full.

use arcfeed_units::{Micros, Nm};
use heapless::Deque;

use crate::spsc::{Consumer, Producer};
use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::supervisor::Supervisor;

use super::messages::{Command, Notice, PlannedMove, TaskStatus};

/// Maximum number of notices that wait for room in the queue.
const NOTICES: usize = 8;

/// Sends commands and notices to the control task, and holds those for which its queues have no place yet.
pub struct Dispatch<'q> {
    commands: Producer<'q, Command>,
    notices: Producer<'q, Notice>,
    status: Consumer<'q, TaskStatus>,
    waiting: Deque<Notice, NOTICES>,
    /// Parameters or settings that wait to be sent.
    pending: Option<Supervisor>,
    run: u32,
}

impl<'q> Dispatch<'q> {
    /// Sender at these ends of the queues; nothing waits.
    pub fn new(
        commands: Producer<'q, Command>,
        notices: Producer<'q, Notice>,
        status: Consumer<'q, TaskStatus>,
    ) -> Self {
        Dispatch { commands, notices, status, waiting: Deque::new(), pending: None, run: 0 }
    }

    /// Whether nothing waits for a place in the queues.
    pub fn is_done(&self) -> bool {
        self.waiting.is_empty() && self.pending.is_none()
    }

    /// Sends what waits, as far as the queues have places.
    pub fn flush(&mut self) {
        while self.notices.ready()
            && let Some(notice) = self.waiting.pop_front()
        {
            let _room = self.notices.enqueue(notice);
        }
        if self.waiting.is_empty()
            && self.commands.ready()
            && let Some(supervisor) = self.pending.take()
        {
            let _room = self.commands.enqueue(Command::Parameters(supervisor));
        }
    }

    /// Sends a notice, which takes effect at the next tick.
    pub fn notify(&mut self, notice: Notice) {
        let at_once = self.waiting.is_empty() && self.notices.enqueue(notice).is_ok();
        if !at_once {
            // Fills only if the control task has stopped.
            let _room = self.waiting.push_back(notice);
        }
    }

    /// Reports to the control task that a valid frame of the host arrived at the time `at`. Left out if other notices
    /// wait or the queue is half full, because frames of the host come again.
    pub fn host_alive(&mut self, at: Micros) {
        if self.waiting.is_empty() && self.notices.len() < self.notices.capacity() / 2 {
            let _room = self.notices.enqueue(Notice::HostAlive(at));
        }
    }

    /// Starts a new run of segments: those that have not ended are discarded.
    pub fn begin_run(&mut self) {
        self.run = self.run.wrapping_add(1);
        self.notify(Notice::Run(self.run));
    }

    /// Sends a supervisor with new parameters or settings; it takes effect after the segments that are in the queue
    /// already.
    pub fn send_parameters(&mut self, supervisor: Supervisor) {
        self.pending = Some(supervisor);
        self.flush();
    }

    /// Adds a segment of the run, with its number `count`. Returns false, and changes nothing, if no slot is free.
    /// With `begins_at` it waits until X, Y and Z are at this position.
    pub fn put(&mut self, count: u32, segment: ActiveSegment, begins_at: Option<[Nm; 3]>) -> bool {
        let planned = PlannedMove { run: self.run, count, begins_at, segment };
        self.commands.enqueue(Command::Segment(planned)).is_ok()
    }

    /// Whether the control task has taken all commands.
    pub fn is_empty(&self) -> bool {
        self.commands.is_empty()
    }

    /// Number of segments that can be added at present.
    pub fn room(&self) -> usize {
        self.capacity().saturating_sub(self.commands.len())
    }

    /// Number of segments that an empty queue holds.
    pub fn capacity(&self) -> usize {
        self.commands.capacity()
    }

    /// The next status of the control task; `None` if there is no new one.
    pub fn status(&mut self) -> Option<TaskStatus> {
        self.status.dequeue()
    }
}
