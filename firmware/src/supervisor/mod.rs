//! Supervisor: decides whether the laws may have the override. The fallback is 100 %, and the operator can always
//! reduce it.
//!
//! A pure state machine around [`Controller`]: no I/O, no clock; ages and `dt` are arguments. `docs/safety.md`
//! specifies its behaviour row by row, and its limits. Each tick has the same steps: [`settings`] give the quality of
//! the samples, [`operator`] reads the dial, [`segment_tracking`] follows the segment, the most important event
//! changes the [`state`], and the state moves the level towards its [`target`] through the [ramp](crate::ramp).

pub mod signals;

pub mod input;

pub mod settings;

pub mod segment_tracking;

pub mod operator;

pub mod state;

pub mod report;

pub mod target;

pub mod memory;

use arcfeed_model::job::{Job, OverrideLimits};
use arcfeed_units::fmath;
use arcfeed_units::{MmPerTooth, RevPerMin, Span};

use crate::active::ActiveSegment;
use crate::controller::{Controller, PositionSample};
use crate::progress::PositionFilter;
use crate::ramp::{FeedOverride, Ramp};

use input::{Input, Quality, Work};
use memory::Memory;
use operator::DialTurn;
use report::{Alarm, Reason, Refusal};
use segment_tracking::Change;
use settings::{Settings, SettingsError};
use signals::{Inhibit, Request, Signals};
use state::{Disarm, Event, Hold, State};
use target::Target;

/// Supervisor of one machine: decides at each tick whether the feed laws may set the override, and on its value. Holds
/// only settings; the state is a [`Memory`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor {
    controller: Controller,
    ramp: Ramp,
    settings: Settings,
}

/// Decision of the supervisor at one tick: override, reason and state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Output {
    /// Override to be output.
    pub feed_override: FeedOverride,
    /// State of the supervisor after this tick.
    pub state: State,
    /// Reason of the override.
    pub reason: Reason,
    /// Alarm to be shown to the operator.
    pub alarm: Alarm,
    /// Reason why arming, requested at this tick, was rejected; `None` if it was not requested or was accepted.
    pub refusal: Option<Refusal>,
    /// Feed per tooth at the tool's centre that the law demands, along the path; `None` if no law sets the override,
    /// or if it has no demand.
    pub ipt_center: Option<MmPerTooth>,
}

/// Evaluated inputs of a tick.
#[derive(Clone, Copy, Debug)]
struct Evaluation<'a> {
    quality: Quality,
    turn: DialTurn,
    change: Change,
    /// The segment in execution if a law may act on it: it is followed and its samples are fresh.
    followed: Option<&'a ActiveSegment>,
    /// Signals that have risen since the last tick.
    pressed: Signals,
    spindle: RevPerMin,
    /// Times since the last tick: one for rises and required durations, limited to the longest tick, and one for falls
    /// and time-outs.
    spans: [Span; 2],
}

impl Supervisor {
    /// Supervisor for a job, whose bounds of the override it keeps.
    ///
    /// # Errors
    /// The settings contradict each other, or the bounds of the override are invalid.
    pub fn new(job: &Job, settings: Settings) -> Result<Self, SettingsError> {
        Supervisor::within(&job.limits, settings)
    }

    /// Supervisor for every job with these bounds of the override.
    ///
    /// # Errors
    /// As of [`Supervisor::new`].
    pub fn within(limits: &OverrideLimits, settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        let ramp = Ramp::new(limits).map_err(SettingsError::Limits)?;
        Ok(Supervisor { controller: Controller::new(PositionFilter::Exact), ramp, settings })
    }

    /// The controller that follows the position along segments, for code that needs the same position filter.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The same supervisor with another filter for measured positions.
    #[must_use]
    pub fn with_filter(self, filter: PositionFilter) -> Self {
        Supervisor { controller: Controller::new(filter), ..self }
    }

    /// Time-outs and thresholds of the supervisor.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Decides on the override at one tick; `work` is the segment in execution.
    #[inline(always)]
    pub fn tick(&self, memory: &mut Memory, work: Work<'_>, input: &Input) -> Output {
        let seen = self.evaluate(memory, work, input);
        let event = self.event(memory, work, input, &seen);
        let refusal = memory.refusal(event, seen.pressed);
        let goes_on = matches!((memory.state, event), (State::Running, Event::Work));
        if !goes_on {
            memory.change(event);
        }
        memory.apply_turn(seen.turn);
        // Running on a segment on which a law may act; any event other than `Work` would have left the state.
        let target = match (memory.state, seen.followed) {
            (State::Running, Some(segment)) => Some(self.follow_law(memory, segment, &seen, goes_on)),
            _ => {
                self.move_without_law(memory, &seen);
                None
            }
        };
        let feed_override = self.ramp.round_down(&memory.level);
        // A law that demands no feed holds the axes.
        let halts = feed_override.percent == 0 && target.is_some();
        if halts {
            memory.change(Event::Halt);
        }
        let (reason, ipt_center) = match target {
            Some(target) if !halts => (target.reason, target.ipt_center),
            _ => (Reason::of_state(&memory.state), None),
        };
        memory.counters.count(reason);
        let alarm = Alarm::of(&memory.state, input.signals);
        Output { feed_override, state: memory.state, reason, alarm, refusal, ipt_center }
    }

    /// Evaluates the inputs: quality of the samples, dial, segment and progress, rising edges of requests, and elapsed
    /// time.
    #[inline(always)]
    fn evaluate<'a>(&self, memory: &mut Memory, work: Work<'a>, input: &Input) -> Evaluation<'a> {
        let Settings { take_over_below_percent, take_over_drop_percent, longest_tick, .. } = self.settings;
        let quality = self.settings.quality(&input.position, &input.link);
        let turn = memory.dial.read(input.operator_percent, take_over_below_percent, take_over_drop_percent);
        let (change, followed) = memory.track(work, quality);
        let pressed = input.signals.risen_since(memory.signals);
        memory.signals = input.signals;
        if quality == Quality::Fresh {
            memory.invalid = [0; 2];
        } else {
            memory.count_frames(input);
        }
        let spans @ [dt, _] = [input.measured.dt.min(longest_tick), input.measured.dt];
        memory.state.elapse(quality, memory.dial, spans);
        if let Some(segment) = followed {
            let sample = PositionSample { position: input.measured.position.as_ref(), dt };
            self.controller.follow(&mut memory.control, segment, &sample, change.is_begin());
        }
        Evaluation { quality, turn, change, followed, pressed, spindle: input.measured.spindle, spans }
    }

    /// The most important event of this tick.
    #[inline(always)]
    fn event(&self, memory: &Memory, work: Work<'_>, input: &Input, seen: &Evaluation<'_>) -> Event {
        let can_arm = || seen.quality == Quality::Fresh && memory.state.can_arm(self.settings.resync);
        if let Some(fault) = input.signals.fault() {
            Event::Fault(fault)
        } else if seen.pressed.asks(Request::Reset) && matches!(memory.state, State::Faulted { .. }) {
            Event::Reset
        } else if seen.pressed.asks(Request::Disarm) {
            Event::Disarm
        } else if seen.quality == Quality::Lost {
            Event::Lost(self.settings.loss(&input.position, &input.link))
        } else if seen.turn == DialTurn::TakesOver {
            Event::Reduced { percent: input.operator_percent }
        } else if let Some(condition) = input.signals.refusing() {
            Event::Refuse(condition)
        } else if seen.pressed.asks(Request::Arm) && can_arm() {
            Event::Arm
        } else if let Some(why) = input.inhibiting(work) {
            Event::Inhibit(why)
        } else if input.signals.has(Signals::FEED_HOLD) && memory.tracking.is_followed() {
            Event::Hold
        } else if seen.followed.is_some() {
            Event::Work
        } else if seen.quality == Quality::Stale {
            Event::Stale
        } else {
            Event::Rest
        }
    }

    /// Moves the level towards the law's target, within bounds, operator's share and slew.
    #[inline(always)]
    fn follow_law(&self, memory: &mut Memory, segment: &ActiveSegment, seen: &Evaluation<'_>, goes_on: bool) -> Target {
        let share_ratio = memory.dial.share_ratio();
        let travelled_mm = memory.control.progress().travelled_mm();
        let target = Target::at(travelled_mm, segment, seen.spindle, &self.ramp, share_ratio);
        if seen.change.is_begin() {
            if goes_on && seen.change == Change::Begins {
                memory.level.carry(memory.control.feed_change_ratio(), share_ratio);
            }
            memory.level.fall_to(target.override_ratio);
        }
        self.ramp.slew(&mut memory.level, target.override_ratio, seen.spans);
        let is_there = memory.level.ratio() == target.override_ratio;
        Target { reason: if is_there { target.reason } else { Reason::Law }, ..target }
    }

    /// Moves the level without a law.
    #[inline(always)]
    fn move_without_law(&self, memory: &mut Memory, seen: &Evaluation<'_>) {
        if seen.change != Change::Same && !memory.hands_over_to_dial() {
            memory.level.fall_to(1.0);
        }
        self.move_level(memory, seen.spans);
    }

    fn move_level(&self, memory: &mut Memory, spans: [Span; 2]) {
        let share_ratio = memory.dial.share_ratio();
        let dial_ratio = fmath::min(memory.dial.ratio(), self.ramp.max_ratio());
        let level = &mut memory.level;
        let target_ratio = match memory.state {
            State::Faulted { .. } => return level.stop(),
            State::Running | State::Holding { cause: Hold::ZeroOverride } => return,
            State::Fallback { keep, .. } if keep > Span(0) => return,
            State::Holding { cause: Hold::Feed } => fmath::min(level.ratio(), share_ratio),
            // The override acts on no feed: it waits at the value with which the next block can begin.
            State::Armed | State::Inhibited { why: Inhibit::NoFeed | Inhibit::Rapid } => {
                let ready_ratio = share_ratio * (1.0 - memory.reserve_ratio);
                level.fall_to(ready_ratio);
                ready_ratio
            }
            State::Inhibited { .. } | State::Fallback { .. } | State::Disarmed { by: Disarm::Condition(_) } => {
                share_ratio
            }
            State::Idle | State::Disarmed { by: Disarm::Request | Disarm::Operator { raised: true, .. } } => dial_ratio,
            State::Disarmed { by: Disarm::Operator { raised: false, .. } } => return level.fall_to(dial_ratio),
        };
        self.ramp.slew(level, target_ratio, spans);
    }
}
