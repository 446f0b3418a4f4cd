//! The states, and what leads from one to the next.

use arcfeed_shared::units::Span;

use super::input::{Loss, Quality, Source};
use super::operator::Dial;
use super::signals::{BoardFault, Condition, Inhibit};

/// Who has the override, and why.
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
/// Of several events at one tick the first of [`Event`]'s order counts; an event not drawn changes nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum State {
    /// Never armed since power-on or reset: the dial's value.
    #[default]
    Idle,
    /// A law may act as soon as a segment begins: 100 %, or the dial below it.
    Armed,
    /// The laws and the ramp decide.
    Running,
    /// The axes stand: the level does not rise, the way along the segment stays.
    Holding {
        /// Why they stand.
        cause: Hold,
    },
    /// Position or link lost; needs a person, or the host for one, to arm again.
    Fallback {
        /// What was lost.
        source: Source,
        /// How much longer the last value stays; zero: on the way to 100 %, or the dial below it.
        keep: Span,
        /// For how long samples have been fresh again.
        fresh_for: Span,
    },
    /// 0 %, until a person resets.
    Faulted {
        /// The first fault found.
        fault: BoardFault,
    },
    /// Nothing for the override to act on: 100 %, or the dial below it.
    Inhibited {
        /// Why.
        why: Inhibit,
    },
    /// The operator or a condition of the control took the override; needs arming.
    Disarmed {
        /// Who or what.
        by: Disarm,
    },
}

/// Why the axes stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Hold {
    /// Feed hold.
    Feed,
    /// The override is 0 %: a law wants it and `min` is 0.
    ZeroOverride,
}

/// What disarmed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Disarm {
    /// The operator turned the dial down: the dial's value, but no rise until the dial is turned up.
    Operator {
        /// The dial's lowest reading since.
        lowest_percent: u8,
        /// Whether it was turned up since.
        raised: bool,
    },
    /// Somebody asked for it: the dial's value.
    Request,
    /// A condition of the control: 100 %, or the dial below it.
    Condition(Condition),
}

/// What happens at a tick, most important first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The board is not to be trusted.
    Fault(BoardFault),
    /// A person clears a fault that is gone.
    Reset,
    /// Somebody asks to disarm.
    Disarm,
    /// Position or link is lost.
    Lost(Loss),
    /// The operator's dial takes over, at this reading.
    Reduced {
        /// %.
        percent: u8,
    },
    /// A condition of the control forbids the laws.
    Refuse(Condition),
    /// Somebody asks to arm and nothing speaks against it.
    Arm,
    /// The override has nothing to act on.
    Inhibit(Inhibit),
    /// Feed hold on a followed segment.
    Hold,
    /// The samples are too old to act on, but not lost.
    Stale,
    /// A followed segment is in work, samples are fresh.
    Work,
    /// Nothing in work, or its beginning was not seen.
    Rest,
    /// The law's step ended at 0 %.
    Halt,
}

impl State {
    /// Whether the laws have the override, or get it back by themselves.
    pub fn is_engaged(&self) -> bool {
        matches!(self, State::Armed | State::Running | State::Holding { .. } | State::Inhibited { .. })
    }

    /// Whether an arming that nothing speaks against would be accepted.
    pub fn can_arm(&self, resync: Span) -> bool {
        match self {
            State::Idle | State::Disarmed { .. } => true,
            State::Fallback { fresh_for, .. } => *fresh_for >= resync,
            State::Armed | State::Running | State::Holding { .. } | State::Faulted { .. } | State::Inhibited { .. } => {
                false
            }
        }
    }

    /// Lets time pass: one span for what must last, the other for what runs out.
    #[inline(always)]
    pub fn elapse(&mut self, quality: Quality, dial: Dial, [lasted, passed]: [Span; 2]) {
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
