//! The control task: each tick it reads commands and notices from its queues, follows the position and decides on the
//! override.

use arcfeed_model::job::OverrideLimits;
use arcfeed_units::{Micros, Span};

use arcfeed_firmware::controller;
use arcfeed_firmware::output::telemetry::record::TelemetryRecord;
use arcfeed_firmware::queue::Follower;
use arcfeed_firmware::supervisor::input::{Freshness, Input};
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::report::Refusal;
use arcfeed_firmware::supervisor::settings::{Settings, SettingsError};
use arcfeed_firmware::supervisor::signals::{BoardFault, Request, Signals};
use arcfeed_firmware::supervisor::state::State;
use arcfeed_firmware::supervisor::{Output, Supervisor};

use super::messages::{Command, Notice, TaskQueues, TaskStatus};
use super::sensors::Sensors;

/// Source of the board's segments: the host, or the DNC line that it taps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Supply {
    /// From a host on the link. The laws can be armed only while valid frames of the host arrive.
    Link,
    /// From the tapped DNC line; no host is needed.
    Tap,
}

/// The work at each control tick: reads commands and notices from the main loop, follows the position, and decides on
/// the override. Starts in the idle state at 0 %, from where the override rises to the operator's dial.
pub struct ControlTask<'q> {
    queues: TaskQueues<'q>,
    supply: Supply,
    supervisor: Supervisor,
    memory: Memory,
    follower: Follower,
    run: u32,
    /// Whether the first segment of the run has begun.
    has_begun: bool,
    executed: u32,
    epoch: u16,
    last: Option<Micros>,
    host: Host,
    /// A fault found at the start or by the command handler; passed once to the supervisor, which latches it.
    fault: Option<BoardFault>,
    request: Signals,
    refusal: Option<Refusal>,
}

/// Knowledge about the host.
#[derive(Clone, Copy, Debug, Default)]
struct Host {
    heard: Option<Micros>,
    /// Whether the host was lost after it was heard.
    is_lost: bool,
    /// Whether the host has changed; true for one tick.
    is_gone: bool,
}

impl<'q> ControlTask<'q> {
    /// Task without a job. `fault` is a fault that was found at the start, such as a watchdog reset or corrupt
    /// parameters in flash.
    ///
    /// # Errors
    /// The settings of the supervisor contradict each other.
    pub fn new(
        queues: TaskQueues<'q>,
        supply: Supply,
        settings: Settings,
        fault: Option<BoardFault>,
    ) -> Result<Self, SettingsError> {
        Ok(ControlTask {
            queues,
            supply,
            supervisor: Supervisor::within(&OverrideLimits::default(), settings)?,
            memory: Memory::default(),
            follower: Follower::default(),
            run: 0,
            has_begun: false,
            executed: 0,
            epoch: 1,
            last: None,
            host: Host::default(),
            fault,
            request: Signals::NONE,
            refusal: None,
        })
    }

    /// Runs one tick at the time `now` with these measured values; returns the decision.
    pub fn tick(&mut self, now: Micros, sensors: &Sensors) -> Output {
        self.take_notices();
        self.take_commands();
        let input = self.input(now, sensors);
        let before = self.memory.state();
        let front = match self.queues.commands.peek() {
            Some(Command::Segment(planned)) => {
                self.has_begun = self.has_begun || planned.can_begin(sensors.position.as_ref());
                self.has_begun.then_some((planned.count, &planned.segment))
            }
            Some(Command::Parameters(_)) | None => None,
        };
        let segment = front.map(|(_, segment)| segment);
        let output = self.supervisor.tick(&mut self.memory, self.follower.in_work(segment), &input);
        let record = TelemetryRecord::new(now, front, &output);
        let is_in_work = front.is_some();
        let controller = self.supervisor.controller();
        if segment.is_some_and(|segment| self.follower.follow(controller, segment, &input.measured)) {
            let _done = self.queues.commands.dequeue();
            self.executed = self.executed.wrapping_add(1);
        }
        if is_taken_away(&before, &output.state) || self.host.is_gone {
            self.epoch = self.epoch.wrapping_add(1);
        }
        self.host.is_gone = false;
        self.send_status(record, &output, is_in_work);
        output
    }

    /// State of the supervisor, which decides whether the laws may set the override, with its counters.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Number of segments that have ended since the start; wraps around.
    pub fn executed(&self) -> u32 {
        self.executed
    }

    fn take_notices(&mut self) {
        while let Some(notice) = self.queues.notices.dequeue() {
            match notice {
                Notice::HostAlive(at) => (self.host.heard, self.host.is_lost) = (Some(at), false),
                Notice::HostLost => self.host.is_lost = true,
                Notice::HostChanged => self.host = Host { heard: None, is_lost: true, is_gone: true },
                Notice::Run(run) => self.begin_run(run),
                Notice::Arm(epoch) if epoch == self.epoch => self.set_request(Request::Arm),
                // Stale: requested before the last fallback, which that person has not seen.
                Notice::Arm(_) => {}
                Notice::Disarm => self.set_request(Request::Disarm),
                Notice::Fault(fault) => self.fault = Some(fault),
            }
        }
    }

    /// Applies parameters at the front of the queue and drops segments of earlier runs.
    fn take_commands(&mut self) {
        while let Some(order) = self.queues.commands.peek() {
            match order {
                Command::Parameters(supervisor) => self.supervisor = *supervisor,
                Command::Segment(planned) if planned.is_before(self.run) => {}
                Command::Segment(planned) => {
                    let run = planned.run;
                    return self.begin_run(run);
                }
            }
            let _taken = self.queues.commands.dequeue();
        }
    }

    fn begin_run(&mut self, run: u32) {
        if run != self.run {
            (self.run, self.has_begun) = (run, false);
            self.follower.restart();
        }
    }

    fn set_request(&mut self, request: Request) {
        self.request = self.request.with(Signals::of_request(request));
    }

    fn input(&mut self, now: Micros, sensors: &Sensors) -> Input {
        let dt = self.last.map_or(Span(0), |last| now.since(last).into());
        self.last = Some(now);
        let fault = self.fault.take().map_or(Signals::NONE, Signals::of_fault);
        let request = core::mem::take(&mut self.request);
        Input {
            measured: controller::Measurement { position: sensors.position, spindle: sensors.spindle, dt },
            position: sensors.freshness,
            link: match self.supply {
                Supply::Link => self.host.freshness(now, self.supervisor.settings().lost_after_frames),
                Supply::Tap => Freshness::NOW,
            },
            operator_percent: sensors.operator_percent,
            signals: sensors.signals.with(fault).with(request),
        }
    }

    fn send_status(&mut self, record: TelemetryRecord, output: &Output, is_in_work: bool) {
        self.refusal = output.refusal.or(self.refusal);
        let status = TaskStatus {
            record,
            state: output.state,
            alarm: output.alarm,
            epoch: self.epoch,
            executed: self.executed,
            is_in_work,
            refusal: self.refusal,
        };
        // Dropped if the queue is full: the next status repeats it.
        if self.queues.status.enqueue(status).is_ok() {
            self.refusal = None;
        }
    }
}

impl Host {
    /// Age and invalid frames: a lost host counts as having sent too many invalid frames in a row.
    fn freshness(&self, now: Micros, lost_after_frames: u8) -> Freshness {
        let age = self.heard.map_or(Span(u32::MAX), |heard| now.since(heard).into());
        Freshness { age, invalid_in_row: if self.is_lost { lost_after_frames } else { 0 } }
    }
}

/// Whether the laws have lost the override, or the state that excludes them has changed.
fn is_taken_away(before: &State, now: &State) -> bool {
    !now.is_engaged() && *now != State::Idle && core::mem::discriminant(before) != core::mem::discriminant(now)
}
