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

/// Sender of commands and notices to the control task, with what waits for room. Keeps its state between calls.
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
    /// A dispatcher that has sent nothing.
    pub fn new(
        commands: Producer<'q, Command>,
        notices: Producer<'q, Notice>,
        status: Consumer<'q, TaskStatus>,
    ) -> Self {
        Dispatch { commands, notices, status, waiting: Deque::new(), pending: None, run: 0 }
    }

    /// Whether nothing waits for room.
    pub fn is_done(&self) -> bool {
        self.waiting.is_empty() && self.pending.is_none()
    }

    /// Sends waiting notices and commands, as far as there is room.
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

    /// Sends a notice.
    pub fn notify(&mut self, notice: Notice) {
        let at_once = self.waiting.is_empty() && self.notices.enqueue(notice).is_ok();
        if !at_once {
            // Fills only if the control task has stopped.
            let _room = self.waiting.push_back(notice);
        }
    }

    /// Registers a sign of life of the host. Other notices have priority, as signs of life repeat.
    pub fn host_alive(&mut self, at: Micros) {
        if self.waiting.is_empty() && self.notices.len() < self.notices.capacity() / 2 {
            let _room = self.notices.enqueue(Notice::HostAlive(at));
        }
    }

    /// Starts a new run: discards unfinished segments.
    pub fn begin_run(&mut self) {
        self.run = self.run.wrapping_add(1);
        self.notify(Notice::Run(self.run));
    }

    /// Sends parameters and settings; they take effect after the segments queued so far.
    pub fn send_parameters(&mut self, supervisor: Supervisor) {
        self.pending = Some(supervisor);
        self.flush();
    }

    /// Adds a segment of this run. Returns false without effect if there is no room.
    pub fn put(&mut self, count: u32, segment: ActiveSegment, begins_at: Option<[Nm; 3]>) -> bool {
        let planned = PlannedMove { run: self.run, count, begins_at, segment };
        self.commands.enqueue(Command::Segment(planned)).is_ok()
    }

    /// Whether no command waits for the control task.
    pub fn is_empty(&self) -> bool {
        self.commands.is_empty()
    }

    /// Free slots for segments.
    pub fn room(&self) -> usize {
        self.capacity().saturating_sub(self.commands.len())
    }

    /// Number of segments that an empty queue holds.
    pub fn capacity(&self) -> usize {
        self.commands.capacity()
    }

    /// The next status of the control task.
    pub fn status(&mut self) -> Option<TaskStatus> {
        self.status.dequeue()
    }
}
