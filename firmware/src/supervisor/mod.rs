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
use crate::controller::{self, Controller, UsualWish};
use crate::progress::PositionFilter;
use crate::ramp::FeedOverride;

use input::{Input, Quality, Work};
use limits::Limits;
use memory::Memory;
use operator::Turn;
use report::{Alarm, Reason, Refusal};
use settings::{Settings, SettingsError};
use sight::{Change, Sight};
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
    ///
    /// Nearly always the law goes on and nothing else happens; that is told by a few comparisons and done at once. It is
    /// what the whole of it, `take_in`, would do as well.
    #[inline(always)]
    pub fn tick(&self, memory: &mut Memory, work: Work<'_>, input: &Input) -> Output {
        if let (Some((count, segment)), Some(settled_on)) = (work, memory.settled_on)
            && input.is_quiet()
            && self.settings.is_fresh(&input.position, &input.link)
            && self.limits.is_in_time(input.measured.dt)
        {
            if count == settled_on {
                return self.go_on(memory, segment, &input.measured);
            }
            if segment.takes_override() {
                return self.take_up(memory, count, segment, &input.measured);
            }
        }
        self.take_in(memory, work, input)
    }

    /// A tick on which nothing but the law moves the override.
    #[inline(always)]
    fn go_on(&self, memory: &mut Memory, segment: &ActiveSegment, measured: &controller::Input) -> Output {
        let Some(wish) = self.controller.usual_wish(&mut memory.control, segment, measured) else {
            return self.go_on_otherwise(memory, segment, measured);
        };
        self.obey_law(memory, &wish, measured.dt)
    }

    /// The first tick on the next segment, where the law had the override on the one before.
    #[inline(never)]
    fn take_up(
        &self,
        memory: &mut Memory,
        count: u32,
        segment: &ActiveSegment,
        measured: &controller::Input,
    ) -> Output {
        memory.sight = Sight::Followed(count);
        memory.settled_on = Some(count);
        memory.reserve_ratio = segment.reserve_ratio();
        if let Some(wish) = self.controller.begin_usual(&mut memory.control, segment, measured) {
            self.limits.carry_to(&mut memory.level, memory.control.ratio());
            return self.obey_law(memory, &wish, measured.dt);
        }
        let step = self.follow_law(memory, segment, measured, (true, Change::Begins));
        if !memory.is_in_step() {
            memory.settled_on = None;
        }
        self.halt_at_zero(memory);
        self.report(memory, false, Some(&step), None)
    }

    /// Moves ramp and level, which are in step, to a wish that no bound stands in the way of.
    #[inline(always)]
    fn obey_law(&self, memory: &mut Memory, wish: &UsualWish, dt: Span) -> Output {
        self.limits.slew(&mut memory.level, wish.wanted_ratio, dt);
        memory.control.force_ratio(memory.level.ratio());
        let feed_override = self.limits.round(&memory.level);
        if feed_override.percent == 0 {
            return self.halt(memory);
        }
        Output {
            feed_override,
            state: State::Running,
            reason: Reason::Law,
            alarm: Alarm::None,
            refusal: None,
            ipt_center: Some(wish.ipt_center),
        }
    }

    #[inline(never)]
    fn go_on_otherwise(&self, memory: &mut Memory, segment: &ActiveSegment, measured: &controller::Input) -> Output {
        let step = self.controller.tick_otherwise(&mut memory.control, segment, measured);
        self.limits.follow(&mut memory.level, memory.control.ratio(), measured.dt);
        self.halt_at_zero(memory);
        self.report(memory, false, Some(&step), None)
    }

    #[cold]
    #[inline(never)]
    fn halt(&self, memory: &mut Memory) -> Output {
        self.halt_at_zero(memory);
        self.report(memory, false, None, None)
    }

    /// A law that wants no feed at all holds the axes.
    #[inline(always)]
    fn halt_at_zero(&self, memory: &mut Memory) {
        if self.limits.round(&memory.level).percent == 0 {
            memory.settled_on = None;
            memory.change_to(memory.state.next(Event::Halt), Event::Halt);
        }
    }

    /// A tick with everything that can happen.
    #[inline(never)]
    fn take_in(&self, memory: &mut Memory, work: Work<'_>, input: &Input) -> Output {
        let seen = self.look(memory, work, input);
        let event = self.event(memory, work, input, &seen);
        let refusal = memory.refusal(event, seen.pressed);
        let from = memory.state;
        memory.change_to(from.next(event), event);
        memory.obey(seen.turn);
        let step = match (memory.state, event, work) {
            (State::Running, Event::Work, Some((_, segment))) => {
                let goes_on = from == State::Running;
                Some(self.follow_law(memory, segment, &input.measured, (goes_on, seen.change)))
            }
            _ => {
                self.keep_off(memory, work, input, &seen);
                None
            }
        };
        memory.settle(input);
        if step.is_some() {
            self.halt_at_zero(memory);
        }
        self.report(memory, input.signals.refusing().is_some(), step.as_ref(), refusal)
    }

    /// Judges the samples, reads the dial, watches the segment, takes requests by their edge, lets time pass.
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
        let (before_ratio, is_in_step) = (memory.control.ratio(), memory.is_in_step());
        let step = if change.is_begin() {
            self.controller.begin(&mut memory.control, segment, measured)
        } else {
            self.controller.tick(&mut memory.control, segment, measured)
        };
        let ratio = memory.control.ratio();
        if change == Change::Begins && goes_on && ratio > before_ratio && before_ratio > 0.0 {
            if is_in_step {
                // Not by the quotient: its rounding would leave the level beside the ramp.
                self.limits.carry_to(&mut memory.level, ratio);
            } else {
                self.limits.carry(&mut memory.level, ratio / before_ratio);
            }
        }
        self.limits.follow(&mut memory.level, ratio * memory.dial.share_ratio(), measured.dt);
        step
    }

    /// Moves the level where no law does, and keeps the way along the segment up to date.
    fn keep_off(&self, memory: &mut Memory, work: Work<'_>, input: &Input, seen: &Seen) {
        if seen.change != Change::Same && !memory.hands_over_to_dial() {
            memory.level.fall_to(1.0);
        }
        self.move_level(memory, input.measured.dt);
        if let Some((_, segment)) = work.filter(|_| memory.sight.is_followed()) {
            if seen.change.is_begin() {
                self.controller.begin(&mut memory.control, segment, &input.measured);
            } else if seen.quality == Quality::Fresh {
                self.controller.tick(&mut memory.control, segment, &input.measured);
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

    fn report(
        &self,
        memory: &mut Memory,
        refusing: bool,
        step: Option<&controller::Output>,
        refusal: Option<Refusal>,
    ) -> Output {
        // A step that ended at 0 % put nothing out: the axes stand.
        let step = step.filter(|_| memory.state == State::Running);
        let level_ratio = memory.level.ratio();
        let reason = step.map_or_else(|| Reason::of_state(&memory.state), |step| Reason::of_law(step, level_ratio));
        memory.counters.take(reason);
        Output {
            feed_override: self.limits.round(&memory.level),
            state: memory.state,
            reason,
            alarm: Alarm::of(&memory.state, refusing),
            refusal,
            ipt_center: step.and_then(|step| step.ipt_center),
        }
    }
}

#[cfg(test)]
mod tests;
