//! State of the supervisor, which decides whether the feed laws may set the override, between ticks.

use arcfeed_units::Span;

use crate::active::ActiveSegment;
use crate::controller;
use crate::progress::Progress;
use crate::ramp::{FeedOverride, Level};

use super::input::{Input, Quality, Work};
use super::operator::{DialTurn, OperatorDial};
use super::report::{Counters, Refusal};
use super::segment_tracking::{Change, SegmentTracking};
use super::signals::{Request, Signals};
use super::state::{Disarm, Event, State};

/// State of the supervisor (which decides whether the feed laws may set the override) between ticks. By default as
/// after power-on: idle, with the override at 0 %, from where it rises to the operator's dial.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Memory {
    pub(super) state: State,
    pub(super) control: controller::ControllerState,
    pub(super) tracking: SegmentTracking,
    pub(super) dial: OperatorDial,
    /// Override at the output, before rounding to whole steps.
    pub(super) level: Level,
    pub(super) signals: Signals,
    /// Consecutive invalid frames, at the last tick, of the position's input and of the link.
    pub(super) invalid: [u8; 2],
    pub(super) counters: Counters,
    /// Part of the programmed feed by which the override must be below 1 at the end of the segment that began last; 0 if it may be 1.
    pub(super) reserve_ratio: f32,
}

impl Memory {
    /// State after power-on for a board whose output already has this override.
    pub fn with_override(feed_override: FeedOverride) -> Self {
        Memory { level: Level::at(feed_override), ..Memory::default() }
    }

    /// Armed state (the laws may set the override) at 100 %, with no segment in execution: the start of a simulated
    /// run.
    pub fn armed() -> Self {
        let mut memory = Memory {
            state: State::Armed,
            tracking: SegmentTracking::Nothing,
            ..Memory::with_override(FeedOverride::PROGRAMMED)
        };
        memory.dial.take_reference();
        memory
    }

    /// State of the state machine.
    pub fn state(&self) -> State {
        self.state
    }

    /// Counters of events.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Override at the output as a ratio, before it is rounded to a step of the control.
    pub fn level(&self) -> Level {
        self.level
    }

    /// Progress of the tool on the segment in execution; meaningless if that is a rapid.
    pub fn progress(&self) -> &Progress {
        self.control.progress()
    }

    /// Reason why a requested arming was rejected; `None` if there was none or it was accepted.
    #[inline(always)]
    pub(super) fn refusal(&mut self, event: Event, pressed: Signals) -> Option<Refusal> {
        if !pressed.asks(Request::Arm) || event == Event::Arm || self.state.is_engaged() {
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

    /// Tracks the segment and stores the required reduction at the end of one that begins. Also returns the segment if
    /// a law may act on it: it is followed and its samples are fresh.
    #[inline(always)]
    pub(super) fn track<'a>(&mut self, work: Work<'a>, quality: Quality) -> (Change, Option<&'a ActiveSegment>) {
        let Some((count, segment)) = work else { return (self.tracking.clear(), None) };
        let change = self.tracking.update(count, quality);
        if change.is_begin() {
            self.reserve_ratio = segment.reserve_ratio();
        }
        let is_followed = self.tracking.is_followed() && quality == Quality::Fresh;
        (change, is_followed.then_some(segment))
    }

    /// Counts invalid frames since the last tick.
    #[cold]
    #[inline(never)]
    pub(super) fn count_frames(&mut self, input: &Input) {
        let now = [input.position.invalid_in_row, input.link.invalid_in_row];
        for (before, now) in self.invalid.into_iter().zip(now) {
            let more = if now >= before { now.saturating_sub(before) } else { now };
            self.counters.invalid_frames = self.counters.invalid_frames.saturating_add(u32::from(more));
        }
        self.invalid = now;
    }

    /// Applies the state change of an event. Not inlined: most ticks change nothing.
    #[inline(never)]
    pub(super) fn change(&mut self, event: Event) {
        if event == Event::Arm {
            self.dial.take_reference();
            self.reserve_ratio = 0.0;
        }
        let state = self.state.next(event);
        if state != self.state {
            self.counters.count_change(&self.state, &state);
            self.state = state;
        }
    }

    /// Applies a reduction by the dial at once, in any state.
    #[inline(always)]
    pub(super) fn apply_turn(&mut self, turn: DialTurn) {
        match turn {
            DialTurn::Kept => {}
            DialTurn::Down { from_percent } if self.state.is_engaged() || self.keeps_last_value() => {
                self.level.fall_by(self.dial.fall_ratio(from_percent));
            }
            DialTurn::Down { .. } | DialTurn::TakesOver => self.level.fall_to(self.dial.ratio()),
        }
    }

    pub(super) fn keeps_last_value(&self) -> bool {
        matches!(self.state, State::Fallback { keep, .. } if keep > Span(0))
    }

    /// Whether the dial alone sets the override, also above 100 %.
    pub(super) fn hands_over_to_dial(&self) -> bool {
        matches!(self.state, State::Idle | State::Disarmed { by: Disarm::Request | Disarm::Operator { .. } })
    }
}
