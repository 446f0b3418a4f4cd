//! Whether the laws may have the override at all: 100 % is safe, and the operator has the last word down.
//!
//! A pure state machine around [`Controller`]: no I/O, no clock; ages and `dt` are arguments. What it does row by row, and what
//! it does not promise, is in `docs/safety.md`. Each tick goes the same way: [`settings`] judge the samples, [`operator`]
//! reads the dial, [`sight`] watches the segment, the most important event moves the [`state`], and the state moves the
//! level within the [`limits`] that nothing gets around.

pub mod signals;

pub mod input;

pub mod settings;

pub mod sight;

pub mod operator;

pub mod limits;

pub mod state;

pub mod report;

pub mod memory;

use arcfeed_shared::job::{Job, OverrideLimits};
use arcfeed_shared::units::{MmPerTooth, Span};

use crate::active::ActiveSegment;
use crate::controller::{self, Controller};
use crate::progress::PositionFilter;
use crate::ramp::FeedOverride;

use input::{Input, Quality, Work};
use limits::Limits;
use memory::Memory;
use operator::Turn;
use report::{Alarm, Reason, Refusal};
use settings::{Settings, SettingsError};
use sight::Change;
use signals::{Inhibit, Request, Signals};
use state::{Disarm, Event, Hold, State};

/// The supervisor of one machine; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor {
    controller: Controller,
    limits: Limits,
    settings: Settings,
}

/// What a tick decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// The override to put out.
    pub feed_override: FeedOverride,
    /// Who has it.
    pub state: State,
    /// Why it is what it is.
    pub reason: Reason,
    /// Whether somebody should look.
    pub alarm: Alarm,
    /// Why an arming asked for at this tick was refused.
    pub refusal: Option<Refusal>,
    /// The feed per tooth at the centre that the law wants, along the path; while running.
    pub ipt_center: Option<MmPerTooth>,
}

/// What a tick sees before it decides.
#[derive(Clone, Copy, Debug)]
struct Seen {
    quality: Quality,
    turn: Turn,
    change: Change,
    /// Buttons that were up before.
    pressed: Signals,
}

impl Supervisor {
    /// A supervisor for a job.
    ///
    /// # Errors
    /// Settings or bounds of the override that make no sense.
    pub fn new(job: &Job, settings: Settings) -> Result<Self, SettingsError> {
        Supervisor::within(&job.limits, settings)
    }

    /// A supervisor for every job with these bounds.
    ///
    /// # Errors
    /// As of [`Supervisor::new`].
    pub fn within(limits: &OverrideLimits, settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        let controller = Controller::within(limits).map_err(SettingsError::Limits)?;
        Ok(Supervisor { controller, limits: Limits::new(limits, settings.longest_tick), settings })
    }

    /// The controller in it, for whoever follows the position with its filter.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The same supervisor for positions that are noisy, late or now and then missing.
    #[must_use]
    pub fn with_filter(self, filter: PositionFilter) -> Self {
        Supervisor { controller: self.controller.with_filter(filter), ..self }
    }

    /// What it was told of times and thresholds.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// One tick.
    #[inline(always)]
    pub fn tick(&self, memory: &mut Memory, work: Work<'_>, input: &Input) -> Output {
        let seen = self.look(memory, work, input);
        let event = self.event(memory, work, input, &seen);
        let refusal = memory.refusal(event, seen.pressed);
        let goes_on = matches!((memory.state, event), (State::Running, Event::Work));
        if !goes_on {
            memory.change(event);
        }
        memory.obey(seen.turn);
        let step = match (memory.state, event, work) {
            (State::Running, Event::Work, Some((_, segment))) => {
                Some(self.follow_law(memory, segment, &input.measured, (goes_on, seen.change)))
            }
            _ => {
                self.keep_off(memory, work, input, &seen);
                None
            }
        };
        let feed_override = self.limits.round(&memory.level);
        // A law that wants no feed at all holds the axes.
        let halts = feed_override.percent == 0 && step.is_some();
        if halts {
            memory.change(Event::Halt);
        }
        let (reason, ipt_center) = match step {
            Some(step) if !halts => (Reason::of_law(&step, memory.level.ratio()), step.ipt_center),
            _ => (Reason::of_state(&memory.state), None),
        };
        memory.counters.take(reason);
        let alarm = Alarm::of(&memory.state, input.signals);
        Output { feed_override, state: memory.state, reason, alarm, refusal, ipt_center }
    }

    /// Judges the samples, reads the dial, watches the segment, takes requests by their edge, lets time pass.
    #[inline(always)]
    fn look(&self, memory: &mut Memory, work: Work<'_>, input: &Input) -> Seen {
        let Settings { take_over_below_percent, take_over_drop_percent, longest_tick, .. } = self.settings;
        let quality = self.settings.quality(&input.position, &input.link);
        let turn = memory.dial.read(input.operator_percent, take_over_below_percent, take_over_drop_percent);
        let change = memory.look_at(work, quality);
        let pressed = input.signals.risen_since(memory.signals);
        memory.signals = input.signals;
        memory.count_frames(input);
        memory.state.elapse(quality, memory.dial, input.measured.dt, longest_tick);
        Seen { quality, turn, change, pressed }
    }

    /// The most important thing that happens at this tick.
    #[inline(always)]
    fn event(&self, memory: &Memory, work: Work<'_>, input: &Input, seen: &Seen) -> Event {
        let can_arm = || seen.quality == Quality::Fresh && memory.state.can_arm(self.settings.resync);
        if let Some(fault) = input.signals.fault() {
            Event::Fault(fault)
        } else if seen.pressed.asks(Request::Reset) && matches!(memory.state, State::Faulted { .. }) {
            Event::Reset
        } else if seen.pressed.asks(Request::Disarm) {
            Event::Disarm
        } else if let Quality::Lost(loss) = seen.quality {
            Event::Lost(loss)
        } else if seen.turn == Turn::TakesOver {
            Event::Reduced { percent: input.operator_percent }
        } else if let Some(condition) = input.signals.refusing() {
            Event::Refuse(condition)
        } else if seen.pressed.asks(Request::Arm) && can_arm() {
            Event::Arm
        } else if let Some(why) = input.inhibiting(work) {
            Event::Inhibit(why)
        } else if memory.sight.is_followed() && input.signals.has(Signals::FEED_HOLD) {
            Event::Hold
        } else if seen.quality == Quality::Stale {
            Event::Stale
        } else if memory.sight.is_followed() {
            Event::Work
        } else {
            Event::Rest
        }
    }

    /// The law's step, its wish scaled by the operator's share. The ramp goes on from what was put out; a tick that came
    /// late moves it no further than the longest one.
    #[inline(always)]
    fn follow_law(
        &self,
        memory: &mut Memory,
        segment: &ActiveSegment,
        measured: &controller::Input,
        (goes_on, change): (bool, Change),
    ) -> controller::Output {
        let in_time;
        let measured = if measured.dt > self.settings.longest_tick {
            in_time = controller::Input { dt: self.settings.longest_tick, ..*measured };
            &in_time
        } else {
            measured
        };
        if !goes_on {
            memory.settle_ramp();
        }
        let before_ratio = memory.control.ratio();
        let step = self.controller.step(&mut memory.control, segment, measured, change.is_begin());
        let ratio = memory.control.ratio();
        if change == Change::Begins && goes_on {
            self.carry(memory, before_ratio);
        }
        self.limits.follow(&mut memory.level, ratio * memory.dial.share_ratio(), measured.dt);
        step
    }

    /// The level keeps the feed at a block boundary where the ramp rose from `before_ratio` for it.
    #[inline(never)]
    fn carry(&self, memory: &mut Memory, before_ratio: f32) {
        let ratio = memory.control.ratio();
        if ratio > before_ratio && before_ratio > 0.0 {
            self.limits.carry(&mut memory.level, ratio / before_ratio);
        }
    }

    /// Moves the level where no law does, and keeps the way along the segment up to date.
    #[inline(always)]
    fn keep_off(&self, memory: &mut Memory, work: Work<'_>, input: &Input, seen: &Seen) {
        if seen.change != Change::Same && !memory.hands_over_to_dial() {
            memory.level.fall_to(1.0);
        }
        self.move_level(memory, input.measured.dt);
        if let Some((_, segment)) = work.filter(|_| memory.sight.is_followed()) {
            let begins = seen.change.is_begin();
            if begins || seen.quality == Quality::Fresh {
                self.controller.follow(&mut memory.control, segment, &input.measured, begins);
            }
        }
    }

    fn move_level(&self, memory: &mut Memory, dt: Span) {
        let (dial_ratio, share_ratio) = (memory.dial.ratio(), memory.dial.share_ratio());
        let ready = share_ratio * (1.0 - memory.reserve_ratio);
        let level = &mut memory.level;
        match memory.state {
            State::Faulted { .. } => level.stop(),
            State::Running | State::Holding { cause: Hold::ZeroOverride } => {}
            State::Fallback { keep, .. } if keep > Span(0) => {}
            State::Holding { cause: Hold::Feed } => self.limits.slew(level, level.ratio().min(share_ratio), dt),
            // No feed that the override acts on: it waits at what the next block can begin with.
            State::Armed | State::Inhibited { why: Inhibit::NoFeed | Inhibit::Rapid } => {
                self.limits.follow(level, ready, dt);
            }
            State::Inhibited { .. } | State::Fallback { .. } | State::Disarmed { by: Disarm::Condition(_) } => {
                self.limits.slew(level, share_ratio, dt)
            }
            State::Idle | State::Disarmed { by: Disarm::Request | Disarm::Operator { raised: true, .. } } => {
                self.limits.slew(level, dial_ratio, dt);
            }
            State::Disarmed { by: Disarm::Operator { raised: false, .. } } => level.fall_to(dial_ratio),
        }
    }
}
