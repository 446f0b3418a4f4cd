//! The side of the tick: takes what the desk has put into its queues, follows the position, decides.

use arcfeed_shared::job::OverrideLimits;
use arcfeed_shared::units::{Micros, Span};

use crate::controller;
use crate::output::telemetry::record::TelemetryRecord;
use crate::queue::Follower;
use crate::supervisor::input::{Freshness, Input};
use crate::supervisor::memory::Memory;
use crate::supervisor::report::Refusal;
use crate::supervisor::settings::{Settings, SettingsError};
use crate::supervisor::signals::{BoardFault, Request, Signals};
use crate::supervisor::state::State;
use crate::supervisor::{Output, Supervisor};

use super::order::{Order, TickerQueues, Told, Word};
use super::sensors::Sensors;

/// Where segments come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Supply {
    /// From a host: while it is not heard, nothing can be armed.
    Link,
    /// From the tapped line: nobody has to be heard.
    Tap,
}

/// What runs at every tick; state. It boots idle: 0 %, rising to the dial.
pub struct Ticker<'q> {
    queues: TickerQueues<'q>,
    supply: Supply,
    supervisor: Supervisor,
    memory: Memory,
    follower: Follower,
    run: u32,
    /// Whether the run's first segment has begun.
    has_begun: bool,
    executed: u32,
    epoch: u16,
    last: Option<Micros>,
    host: Host,
    /// What the start found, or the desk; told to the supervisor once, which keeps it.
    fault: Option<BoardFault>,
    request: Signals,
    refusal: Option<Refusal>,
}

/// What is known of the host.
#[derive(Clone, Copy, Debug, Default)]
struct Host {
    heard: Option<Micros>,
    /// Heard, but not to be relied on.
    is_lost: bool,
    /// Another one than before, for one tick.
    is_gone: bool,
}

impl<'q> Ticker<'q> {
    /// A ticker without parameters; `fault` is what the start found: a watchdog that bit, parameters in flash that are
    /// corrupt.
    ///
    /// # Errors
    /// Settings that make no sense.
    pub fn new(
        queues: TickerQueues<'q>,
        supply: Supply,
        settings: Settings,
        fault: Option<BoardFault>,
    ) -> Result<Self, SettingsError> {
        Ok(Ticker {
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

    /// One tick.
    pub fn tick(&mut self, now: Micros, sensors: &Sensors) -> Output {
        self.take_words();
        self.take_orders();
        let input = self.input(now, sensors);
        let before = self.memory.state();
        let front = match self.queues.orders.peek() {
            Some(Order::Segment(ahead)) => {
                self.has_begun = self.has_begun || ahead.can_begin(sensors.position.as_ref());
                self.has_begun.then_some((ahead.count, &ahead.segment))
            }
            Some(Order::Parameters(_)) | None => None,
        };
        let segment = front.map(|(_, segment)| segment);
        let output = self.supervisor.tick(&mut self.memory, self.follower.in_work(segment), &input);
        let record = TelemetryRecord::new(now, front, &output);
        let is_in_work = front.is_some();
        let controller = self.supervisor.controller();
        if segment.is_some_and(|segment| self.follower.follow(controller, segment, &input.measured)) {
            let _done = self.queues.orders.dequeue();
            self.executed = self.executed.wrapping_add(1);
        }
        if is_taken_away(&before, &output.state) || self.host.is_gone {
            self.epoch = self.epoch.wrapping_add(1);
        }
        self.host.is_gone = false;
        self.tell(record, &output, is_in_work);
        output
    }

    /// The supervisor's memory: who has the override, how often what happened.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Segments done since the start; wraps.
    pub fn executed(&self) -> u32 {
        self.executed
    }

    fn take_words(&mut self) {
        while let Some(word) = self.queues.words.dequeue() {
            match word {
                Word::Heard(at) => (self.host.heard, self.host.is_lost) = (Some(at), false),
                Word::Lost => self.host.is_lost = true,
                Word::Gone => self.host = Host { heard: None, is_lost: true, is_gone: true },
                Word::Run(run) => self.begin_run(run),
                Word::Arm(epoch) if epoch == self.epoch => self.ask(Request::Arm),
                // Of a time before the override was last taken away: that person has not seen it.
                Word::Arm(_) => {}
                Word::Disarm => self.ask(Request::Disarm),
                Word::Fault(fault) => self.fault = Some(fault),
            }
        }
    }

    /// Takes parameters that have come to the front, and lets segments of past runs go. No more than the queue holds.
    fn take_orders(&mut self) {
        while let Some(order) = self.queues.orders.peek() {
            match order {
                Order::Parameters(supervisor) => self.supervisor = *supervisor,
                Order::Segment(ahead) if ahead.is_before(self.run) => {}
                Order::Segment(ahead) => {
                    let run = ahead.run;
                    return self.begin_run(run);
                }
            }
            let _taken = self.queues.orders.dequeue();
        }
    }

    fn begin_run(&mut self, run: u32) {
        if run != self.run {
            (self.run, self.has_begun) = (run, false);
            self.follower.restart();
        }
    }

    fn ask(&mut self, request: Request) {
        self.request = self.request.with(Signals::of_request(request));
    }

    fn input(&mut self, now: Micros, sensors: &Sensors) -> Input {
        let dt = self.last.map_or(Span(0), |last| now.since(last).into());
        self.last = Some(now);
        let fault = self.fault.take().map_or(Signals::NONE, Signals::of_fault);
        let request = core::mem::take(&mut self.request);
        Input {
            measured: controller::Input { position: sensors.position, spindle: sensors.spindle, dt },
            position: sensors.freshness,
            link: match self.supply {
                Supply::Link => self.host.freshness(now, self.supervisor.settings().lost_after_frames),
                Supply::Tap => Freshness::NOW,
            },
            operator_percent: sensors.operator_percent,
            signals: sensors.signals.with(fault).with(request),
        }
    }

    fn tell(&mut self, record: TelemetryRecord, output: &Output, is_in_work: bool) {
        self.refusal = output.refusal.or(self.refusal);
        let told = Told {
            record,
            state: output.state,
            alarm: output.alarm,
            epoch: self.epoch,
            executed: self.executed,
            is_in_work,
            refusal: self.refusal,
        };
        // With no room, the next one says as much and more.
        if self.queues.told.enqueue(told).is_ok() {
            self.refusal = None;
        }
    }
}

impl Host {
    /// Lost is as good as so many invalid frames in a row.
    fn freshness(&self, now: Micros, lost_after_frames: u8) -> Freshness {
        let age = self.heard.map_or(Span(u32::MAX), |heard| now.since(heard).into());
        Freshness { age, invalid_in_row: if self.is_lost { lost_after_frames } else { 0 } }
    }
}

/// Whether the laws lost the override, or what keeps them from getting it changed.
fn is_taken_away(before: &State, now: &State) -> bool {
    !now.is_engaged() && *now != State::Idle && core::mem::discriminant(before) != core::mem::discriminant(now)
}
