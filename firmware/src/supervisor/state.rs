//! States and transitions.

use arcfeed_units::Span;

use super::input::{Loss, Quality, Source};
use super::operator::OperatorDial;
use super::signals::{BoardFault, Condition, Inhibit};

/// State of the supervisor.
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
    /// Not armed since power-on or reset: the dial's value.
    #[default]
    Idle,
    /// A law acts as soon as a segment begins: 100 %, or the dial if it is lower.
    Armed,
    /// The laws and the ramp set the override.
    Running,
    /// The axes are held: the level does not rise, the progress is kept.
    Holding {
        /// Cause of the hold.
        cause: Hold,
    },
    /// Position or link is lost; a person must arm again, at the machine or through the host.
    Fallback {
        /// Lost source.
        source: Source,
        /// Remaining time of the last value; zero: moving to 100 %, or to the dial if it is lower.
        keep: Span,
        /// Time for which samples have been fresh again.
        fresh_for: Span,
    },
    /// 0 % until a person resets the fault.
    Faulted {
        /// The first fault found.
        fault: BoardFault,
    },
    /// The override has nothing to act on: 100 %, or the dial if it is lower.
    Inhibited {
        /// Reason.
        why: Inhibit,
    },
    /// The operator or a condition of the control has taken the override; a person must arm again.
    Disarmed {
        /// Cause.
        by: Disarm,
    },
}

/// Cause of the holding state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Hold {
    /// Feed hold.
    Feed,
    /// The override is 0 %: a law demands it and `min` is 0.
    ZeroOverride,
}

/// Cause of a disarming.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Disarm {
    /// The operator has turned the dial down: the dial's value, without a rise until the dial is turned up.
    Operator {
        /// Smallest reading of the dial since then.
        lowest_percent: u8,
        /// Whether the dial was turned up since then.
        raised: bool,
    },
    /// A request: the dial's value.
    Request,
    /// A condition of the control: 100 %, or the dial if it is lower.
    Condition(Condition),
}

/// Event of a tick, the most important first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The board has a fault.
    Fault(BoardFault),
    /// A person resets a fault that is no longer active.
    Reset,
    /// Disarming is requested.
    Disarm,
    /// Position or link is lost.
    Lost(Loss),
    /// The operator takes over with the dial.
    Reduced {
        /// Reading of the dial, %.
        percent: u8,
    },
    /// A condition of the control excludes the laws.
    Refuse(Condition),
    /// Arming is requested and allowed.
    Arm,
    /// The override has nothing to act on.
    Inhibit(Inhibit),
    /// Feed hold on a followed segment.
    Hold,
    /// The samples are stale, but not lost.
    Stale,
    /// A followed segment is in execution and samples are fresh.
    Work,
    /// No segment is in execution, or its beginning was missed.
    Rest,
    /// The law's override is 0 %.
    Halt,
}

impl State {
    /// Whether the laws have the override, or get it back without arming.
    pub fn is_engaged(&self) -> bool {
        matches!(self, State::Armed | State::Running | State::Holding { .. } | State::Inhibited { .. })
    }

    /// Whether the state allows arming.
    pub fn can_arm(&self, resync: Span) -> bool {
        match self {
            State::Idle | State::Disarmed { .. } => true,
            State::Fallback { fresh_for, .. } => *fresh_for >= resync,
            State::Armed | State::Running | State::Holding { .. } | State::Faulted { .. } | State::Inhibited { .. } => {
                false
            }
        }
    }

    /// Applies elapsed time: `lasted` for required durations, `passed` for time-outs.
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

    /// The state after an event.
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
