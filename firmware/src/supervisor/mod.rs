//! Whether the laws may have the override at all: 100 % is safe, and the operator has the last word down.
//!
//! A pure state machine around [`Controller`]: no I/O, no clock; ages and `dt` are arguments. What it does row by row, and what
//! it does not promise, is in `docs/safety.md`. Each tick goes the same way: [`settings`] judge the samples, [`operator`]
//! reads the dial, [`sight`] watches the segment, the most important event moves the [`state`], and the state moves the
//! level within the [`limits`] that nothing gets around.

pub mod input;

pub mod settings;

pub mod sight;

pub mod operator;

pub mod limits;

pub mod state;

pub mod report;

use arcfeed_shared::job::Job;
use arcfeed_shared::units::{Micros, MmPerTooth};

use crate::controller::{self, ActiveSegment, Controller};
use crate::ramp::FeedOverride;

use input::{Conditions, Input, Quality, Request};
use limits::{Level, Limits};
use operator::{Dial, Turn};
use report::{Alarm, Counters, Reason, Refusal};
use settings::{Settings, SettingsError};
use sight::{Change, Sight};
use state::{Disarm, Event, Hold, State};

/// The supervisor of one machine; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor {
    controller: Controller,
    limits: Limits,
    settings: Settings,
}

/// What the supervisor remembers from tick to tick. The default is power-on: idle, 0 %, rising to the dial.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Memory {
    state: State,
    control: controller::State,
    sight: Sight,
    dial: Dial,
    level: Level,
    last_request: Option<Request>,
    invalid: [u8; 2],
    counters: Counters,
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
    request: Option<Request>,
}

impl Memory {
    /// Idle, on a board that knows what its lines carry.
    pub fn taking_over(feed_override: FeedOverride) -> Self {
        Memory { level: Level::at(feed_override), ..Memory::default() }
    }

    /// Who has the override.
    pub fn state(&self) -> State {
        self.state
    }

    /// How often things happened.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }
}

impl Supervisor {
    /// A supervisor for a job.
    ///
    /// # Errors
    /// Settings or bounds of the override that make no sense.
    pub fn new(job: &Job, settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        let controller = Controller::new(job).map_err(SettingsError::Limits)?;
        Ok(Supervisor { controller, limits: Limits::new(&job.limits, settings.longest_tick), settings })
    }

    /// One tick.
    pub fn tick(&self, memory: &mut Memory, input: &Input<'_>) -> Output {
        let seen = self.look(memory, input);
        let event = self.event(memory, input, &seen);
        let refusal = memory.refusal(event, seen.request);
        let from = memory.state;
        memory.change_to(from.next(event), event);
        memory.obey(seen.turn);
        let step = match (memory.state, event, input.work) {
            (State::Running, Event::Work, Some((_, segment))) => {
                let goes_on = from == State::Running;
                Some(self.follow_law(memory, segment, &input.measured, (goes_on, seen.change)))
            }
            _ => {
                self.keep_off(memory, input, &seen);
                None
            }
        };
        if step.is_some() && self.limits.round(&memory.level).percent == 0 {
            memory.change_to(memory.state.next(Event::Halt), Event::Halt);
        }
        self.report(memory, input, step, refusal)
    }

    /// Judges the samples, reads the dial, watches the segment, takes requests by their edge, lets time pass.
    fn look(&self, memory: &mut Memory, input: &Input<'_>) -> Seen {
        let Settings { take_over_below_percent, take_over_drop_percent, longest_tick, .. } = self.settings;
        let quality = self.settings.quality(&input.position, &input.link);
        let turn = memory.dial.read(input.operator_percent, take_over_below_percent, take_over_drop_percent);
        let change = memory.sight.look(input.work.map(|(count, _)| count), quality);
        let request = input.request.filter(|_| input.request != memory.last_request);
        memory.last_request = input.request;
        memory.count_frames(input);
        memory.state.elapse(quality, memory.dial, input.measured.dt, longest_tick);
        Seen { quality, turn, change, request }
    }

    /// The most important thing that happens at this tick.
    fn event(&self, memory: &Memory, input: &Input<'_>, seen: &Seen) -> Event {
        let can_arm = || seen.quality == Quality::Fresh && memory.state.can_arm(self.settings.resync);
        if let Some(fault) = input.fault {
            Event::Fault(fault)
        } else if seen.request == Some(Request::Reset) && matches!(memory.state, State::Faulted { .. }) {
            Event::Reset
        } else if seen.request == Some(Request::Disarm) {
            Event::Disarm
        } else if let Quality::Lost(loss) = seen.quality {
            Event::Lost(loss)
        } else if seen.turn == Turn::TakesOver {
            Event::Reduced { percent: input.operator_percent }
        } else if let Some(condition) = input.conditions.refusing() {
            Event::Refuse(condition)
        } else if seen.request == Some(Request::Arm) && can_arm() {
            Event::Arm
        } else if let Some(why) = input.inhibiting() {
            Event::Inhibit(why)
        } else if memory.sight.is_followed() && input.conditions.has(Conditions::FEED_HOLD) {
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
        let before_ratio = memory.control.ratio();
        let step = if change.is_begin() {
            self.controller.begin(&mut memory.control, segment, measured)
        } else {
            self.controller.tick(&mut memory.control, segment, measured)
        };
        let ratio = memory.control.ratio();
        if change == Change::Begins && goes_on && ratio > before_ratio && before_ratio > 0.0 {
            self.limits.carry(&mut memory.level, ratio / before_ratio);
        }
        self.limits.follow(&mut memory.level, ratio * memory.dial.share_ratio(), measured.dt);
        step
    }

    /// Moves the level where no law does, and keeps the way along the segment up to date.
    fn keep_off(&self, memory: &mut Memory, input: &Input<'_>, seen: &Seen) {
        if seen.change != Change::Same && !memory.hands_over_to_dial() {
            memory.level.fall_to(1.0);
        }
        self.move_level(memory, input.measured.dt);
        if let Some((_, segment)) = input.work.filter(|_| memory.sight.is_followed()) {
            if seen.change.is_begin() {
                self.controller.begin(&mut memory.control, segment, &input.measured);
            } else if seen.quality == Quality::Fresh {
                self.controller.tick(&mut memory.control, segment, &input.measured);
            }
        }
    }

    fn move_level(&self, memory: &mut Memory, dt: Micros) {
        let (dial_ratio, share_ratio) = (memory.dial.ratio(), memory.dial.share_ratio());
        let level = &mut memory.level;
        match memory.state {
            State::Faulted { .. } => level.stop(),
            State::Running | State::Holding { cause: Hold::ZeroOverride } => {}
            State::Fallback { keep, .. } if keep > Micros(0) => {}
            State::Holding { cause: Hold::Feed } => self.limits.slew(level, level.ratio().min(share_ratio), dt),
            State::Armed
            | State::Inhibited { .. }
            | State::Fallback { .. }
            | State::Disarmed { by: Disarm::Condition(_) } => self.limits.slew(level, share_ratio, dt),
            State::Idle | State::Disarmed { by: Disarm::Request | Disarm::Operator { raised: true, .. } } => {
                self.limits.slew(level, dial_ratio, dt);
            }
            State::Disarmed { by: Disarm::Operator { raised: false, .. } } => level.fall_to(dial_ratio),
        }
    }

    fn report(
        &self,
        memory: &mut Memory,
        input: &Input<'_>,
        step: Option<controller::Output>,
        refusal: Option<Refusal>,
    ) -> Output {
        let reason = match &step {
            Some(step) if memory.state == State::Running => Reason::of_law(step, memory.level.ratio()),
            Some(_) | None => Reason::of_state(&memory.state),
        };
        memory.counters.take(reason);
        Output {
            feed_override: self.limits.round(&memory.level),
            state: memory.state,
            reason,
            alarm: Alarm::of(&memory.state, input.conditions.refusing().is_some()),
            refusal,
            ipt_center: step.and_then(|step| step.ipt_center),
        }
    }
}

impl Memory {
    /// Why an arming asked for did not become the event.
    fn refusal(&mut self, event: Event, request: Option<Request>) -> Option<Refusal> {
        if request != Some(Request::Arm) || event == Event::Arm || self.state.is_engaged() {
            return None;
        }
        self.counters.refusals = self.counters.refusals.saturating_add(1);
        Some(match (event, self.state) {
            (Event::Fault(_), _) | (_, State::Faulted { .. }) => Refusal::Faulted,
            (Event::Lost(_) | Event::Stale, _) => Refusal::NotFresh,
            (Event::Reduced { .. }, _) => Refusal::Operator,
            (Event::Refuse(condition), _) => Refusal::Condition(condition),
            (_, State::Fallback { .. }) => Refusal::NotResynchronised,
            (_, _) => Refusal::NotFresh,
        })
    }

    /// The ramp goes on from what is put out.
    fn settle_ramp(&mut self) {
        let share_ratio = self.dial.share_ratio();
        if share_ratio > 0.0 {
            self.control.force_ratio(self.level.ratio() / share_ratio);
        }
    }

    /// Counts frames that were invalid since the last tick.
    fn count_frames(&mut self, input: &Input<'_>) {
        let now = [input.position.invalid_in_row, input.link.invalid_in_row];
        for (before, now) in self.invalid.into_iter().zip(now) {
            let more = if now >= before { now.saturating_sub(before) } else { now };
            self.counters.invalid_frames = self.counters.invalid_frames.saturating_add(u32::from(more));
        }
        self.invalid = now;
    }

    fn change_to(&mut self, state: State, event: Event) {
        if event == Event::Arm {
            self.dial.take_reference();
        }
        if state != self.state {
            self.counters.take_change(&self.state, &state);
            self.state = state;
        }
    }

    /// A reduction takes effect at once, whatever else holds.
    fn obey(&mut self, turn: Turn) {
        match turn {
            Turn::Kept => {}
            Turn::Down { from_percent } if self.state.is_engaged() || self.keeps_last_value() => {
                self.level.fall_by(self.dial.fall_ratio(from_percent));
            }
            Turn::Down { .. } | Turn::TakesOver => self.level.fall_to(self.dial.ratio()),
        }
    }

    fn keeps_last_value(&self) -> bool {
        matches!(self.state, State::Fallback { keep, .. } if keep > Micros(0))
    }

    /// Whether the dial alone decides, above 100 % too.
    fn hands_over_to_dial(&self) -> bool {
        matches!(self.state, State::Idle | State::Disarmed { by: Disarm::Request | Disarm::Operator { .. } })
    }
}
