//! States of the supervisor, which decides whether the feed laws may set the override, and the transitions between
//! them.

use arcfeed_units::Span;

use super::input::{Loss, Quality, Source};
use super::operator::OperatorDial;
use super::signals::{BoardFault, Condition, Inhibit};

/// State of the supervisor, which decides at each tick whether the feed laws may set the override.
///
/// ```text
///                 Arm                     Work
///   +------+ ------------> +-------+ ------------> +---------+
///   | Idle |               | Armed | <------------ | Running |
///   +------+               +-------+     Rest      +---------+
///      ^                     ^   |                  ^   |  ^   Hold, Halt
///      | Reset           Rest|   |Inhibit       Work|   |  +-------------> +---------+
///      |                     |   v           Inhibit|   |      Work        | Holding |
/// +---------+              +-----------+ <----------|---+  <-------------- +---------+
/// | Faulted |              | Inhibited | -----------+         (Holding: Inhibit, Rest as Running)
/// +---------+              +-----------+                      (Armed, Inhibited: Hold as Running)
///      ^
///      | Fault, from everywhere            Armed, Running, Holding and Inhibited are *engaged*. From each:
///
///   engaged --Lost--------------------------> Fallback --Reduced--> Fallback (the dial's at once)
///   engaged --Reduced, Refuse, Disarm-------> Disarmed
///   Fallback --Disarm-----------------------> Disarmed
///   Fallback --Arm, once resynchronised-----> Armed
///   Disarmed --Arm--------------------------> Armed
/// ```
///
/// If several events occur at a tick, the first in the order of [`Event`] applies; an event without an arrow changes
/// nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// The laws have not been armed since the start: the override follows the operator's dial.
    #[default]
    Idle,
    /// The laws may set the override, and do so as soon as a segment begins; until then 100 %, or the dial if it is
    /// lower.
    Armed,
    /// A law acts on the segment in execution: its demand, through the ramp, sets the override.
    Running,
    /// Feed hold or an override of 0 % stops the axes within a segment: the override does not rise, and the progress
    /// is kept.
    Holding {
        /// Cause of the standstill.
        cause: Hold,
    },
    /// Position or link was lost. The override keeps its last value for a time, then goes to 100 %, or to the dial if
    /// that is lower. A person must arm again, at the machine or through the host.
    Fallback {
        /// The source that was lost.
        source: Source,
        /// Remaining time for which the last value is kept; zero from then on.
        keep: Span,
        /// Time for which position and link have been fresh again without a gap.
        fresh_for: Span,
    },
    /// The board has a fault: 0 % until a person resets it.
    Faulted {
        /// The first fault found.
        fault: BoardFault,
    },
    /// The override does not act on the present feed (rapid, tapping, threading): 100 %, or the dial if it is lower.
    Inhibited {
        /// Reason why it does not act.
        why: Inhibit,
    },
    /// The operator, a request, or a condition of the control has taken the override from the laws; a person must arm
    /// again.
    Disarmed {
        /// Cause for which the override was taken.
        by: Disarm,
    },
}

/// Cause for which the axes stop within a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Hold {
    /// The control reports feed hold.
    Feed,
    /// The override is 0 %, because a law demands it and the job's lower bound is 0 %.
    ZeroOverride,
}

/// Cause for which the override was taken from the laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Disarm {
    /// The operator has turned the dial down too far: the override is the dial's value, but does not rise until the
    /// dial is turned up.
    Operator {
        /// Smallest reading of the dial since then, %.
        lowest_percent: u8,
        /// Whether the dial was turned up since then.
        raised: bool,
    },
    /// A person has requested it: the override follows the dial.
    Request,
    /// A condition of the control forbids that a law sets the override: 100 %, or the dial if it is lower.
    Condition(Condition),
}

/// Event that may change the supervisor's state; the first in this order that occurs at a tick counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The board has a fault.
    Fault(BoardFault),
    /// A person resets a fault that lasts no longer.
    Reset,
    /// A person requests that the override be taken from the laws.
    Disarm,
    /// Position or link is lost.
    Lost(Loss),
    /// The operator has turned the dial down so far that it takes the override from the laws.
    Reduced {
        /// Reading of the dial, %.
        percent: u8,
    },
    /// A condition of the control forbids that a law sets the override.
    Refuse(Condition),
    /// A person requests to arm the laws, and the state and the data allow it.
    Arm,
    /// The override does not act on the present feed.
    Inhibit(Inhibit),
    /// Feed hold on a segment that was followed from its beginning.
    Hold,
    /// Position or link is stale, but not lost.
    Stale,
    /// A segment that was followed from its beginning is in execution, and position and link are fresh.
    Work,
    /// No segment is in execution, or its beginning was missed.
    Rest,
    /// A law demands an override of 0 %.
    Halt,
}

impl State {
    /// Whether the laws set the override, or will without a person's action as soon as they can.
    pub fn is_engaged(&self) -> bool {
        matches!(self, State::Armed | State::Running | State::Holding { .. } | State::Inhibited { .. })
    }

    /// Whether a request to arm is accepted in this state. After a loss, data must have been fresh for the time
    /// `resync`.
    pub fn can_arm(&self, resync: Span) -> bool {
        match self {
            State::Idle | State::Disarmed { .. } => true,
            State::Fallback { fresh_for, .. } => *fresh_for >= resync,
            State::Armed | State::Running | State::Holding { .. } | State::Faulted { .. } | State::Inhibited { .. } => {
                false
            }
        }
    }

    /// Applies the time since the last tick: `passed` is all of it and counts for time-outs; `lasted` is limited to
    /// the longest expected tick and counts for times that a state must last.
    #[inline(always)]
    pub fn elapse(&mut self, quality: Quality, dial: OperatorDial, [lasted, passed]: [Span; 2]) {
        match self {
            State::Fallback { keep, fresh_for, .. } => {
                let is_fresh = quality == Quality::Fresh;
                *keep = keep.shorter_by(passed);
                *fresh_for = if is_fresh { fresh_for.longer_by(lasted) } else { Span(0) };
            }
            State::Disarmed { by: Disarm::Operator { lowest_percent, raised } } => {
                *raised |= dial.is_raised_from(*lowest_percent);
                *lowest_percent = dial.percent().min(*lowest_percent);
            }
            State::Idle
            | State::Armed
            | State::Running
            | State::Holding { .. }
            | State::Faulted { .. }
            | State::Inhibited { .. }
            | State::Disarmed { by: Disarm::Request | Disarm::Condition(_) } => {}
        }
    }

    /// The state after an event; the same state if the event has no effect in it.
    #[inline(always)]
    pub fn next(self, event: Event) -> State {
        match self {
            State::Idle | State::Disarmed { .. } => self.next_of_disengaged(event),
            State::Armed | State::Running | State::Holding { .. } | State::Inhibited { .. } => {
                self.next_of_engaged(event)
            }
            State::Fallback { source, fresh_for, .. } => self.next_of_fallback(event, source, fresh_for),
            State::Faulted { .. } => self.next_of_faulted(event),
        }
    }

    fn next_of_disengaged(self, event: Event) -> State {
        match event {
            Event::Fault(fault) => State::Faulted { fault },
            Event::Arm => State::Armed,
            Event::Reset | Event::Disarm | Event::Lost(_) | Event::Reduced { .. } | Event::Refuse(_) => self,
            Event::Inhibit(_) | Event::Hold | Event::Stale | Event::Work | Event::Rest | Event::Halt => self,
        }
    }

    #[inline(always)]
    fn next_of_engaged(self, event: Event) -> State {
        match event {
            Event::Fault(fault) => State::Faulted { fault },
            Event::Disarm => State::Disarmed { by: Disarm::Request },
            Event::Lost(Loss { source, keep }) => State::Fallback { source, keep, fresh_for: Span(0) },
            Event::Reduced { percent } => {
                State::Disarmed { by: Disarm::Operator { lowest_percent: percent, raised: false } }
            }
            Event::Refuse(condition) => State::Disarmed { by: Disarm::Condition(condition) },
            Event::Inhibit(why) => State::Inhibited { why },
            Event::Hold => State::Holding { cause: Hold::Feed },
            Event::Work => State::Running,
            Event::Rest => State::Armed,
            Event::Halt => State::Holding { cause: Hold::ZeroOverride },
            Event::Reset | Event::Arm | Event::Stale => self,
        }
    }

    fn next_of_fallback(self, event: Event, source: Source, fresh_for: Span) -> State {
        match event {
            Event::Fault(fault) => State::Faulted { fault },
            Event::Disarm => State::Disarmed { by: Disarm::Request },
            Event::Reduced { .. } => State::Fallback { source, keep: Span(0), fresh_for },
            Event::Arm => State::Armed,
            Event::Reset | Event::Lost(_) | Event::Refuse(_) | Event::Inhibit(_) | Event::Hold => self,
            Event::Stale | Event::Work | Event::Rest | Event::Halt => self,
        }
    }

    fn next_of_faulted(self, event: Event) -> State {
        match event {
            Event::Reset => State::Idle,
            Event::Fault(_) | Event::Disarm | Event::Lost(_) | Event::Reduced { .. } | Event::Refuse(_) => self,
            Event::Arm | Event::Inhibit(_) | Event::Hold | Event::Stale => self,
            Event::Work | Event::Rest | Event::Halt => self,
        }
    }
}
