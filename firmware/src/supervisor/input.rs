//! What is known at a tick, and what it amounts to.

use arcfeed_shared::units::Micros;

use crate::controller::{self, ActiveSegment};

/// Everything the supervisor decides from.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Position, spindle speed and the time since the last tick.
    pub measured: controller::Input,
    /// The segment in work and its running count.
    pub work: Option<(u32, &'a ActiveSegment)>,
    /// How good the position is.
    pub position: Freshness,
    /// How good the link is that brings the segments; [`Freshness::NOW`] where they are all on board.
    pub link: Freshness,
    /// The operator's dial, %.
    pub operator_percent: u8,
    /// What the control says about itself.
    pub conditions: Conditions,
    /// What the board finds wrong with itself.
    pub fault: Option<BoardFault>,
    /// A button pressed or a command of the host; a held button counts once.
    pub request: Option<Request>,
}

/// Age and validity of what a line brings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Freshness {
    /// Time since the last valid sample or frame.
    pub age: Micros,
    /// Invalid frames since then (bad check sum, stale sequence, out of range); they change nothing else.
    pub invalid_in_row: u8,
}

/// Conditions of the control, any number at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Conditions(u8);

/// What the board finds wrong with itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardFault {
    /// The watchdog bit, now or before this start.
    Watchdog,
    /// The parameters fail their check sum or their validation.
    Parameters,
    /// Supply, clock, output read back wrong, dial open or shorted.
    Hardware,
}

/// What a person, or the host for one, asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Let the laws have the override.
    Arm,
    /// Give it back to the operator.
    Disarm,
    /// Clear a fault; only for a person at the machine.
    Reset,
}

/// A condition under which the laws must not have the override.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// G41 or G42: the control corrects the feed of arcs itself.
    CutterCompensation,
    /// #3004 bit 1: the control ignores the override.
    OverrideOff,
}

/// Why the override has nothing to act on for now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inhibit {
    /// A tapping cycle.
    Tapping,
    /// Thread cutting.
    Threading,
    /// G63.
    FeedForced,
    /// Positioning.
    Rapid,
    /// The segment has no feed per minute.
    NoFeed,
}

/// What was lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The axes' positions.
    Position,
    /// The link to the host.
    Link,
}

/// A loss at the moment it is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loss {
    /// Of what.
    pub source: Source,
    /// How much longer the last value may stay in force.
    pub keep: Micros,
}

/// What the samples are worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Good enough to act on.
    Fresh,
    /// Too old or invalid, but not lost: nothing changes.
    Stale,
    /// Gone.
    Lost(Loss),
}

impl Freshness {
    /// Just arrived and valid.
    pub const NOW: Freshness = Freshness { age: Micros(0), invalid_in_row: 0 };
}

impl Conditions {
    /// None.
    pub const NONE: Conditions = Conditions(0);
    /// G41 or G42 is active.
    pub const CUTTER_COMPENSATION: Conditions = Conditions(1);
    /// #3004 bit 1 is set.
    pub const OVERRIDE_OFF: Conditions = Conditions(1 << 1);
    /// A tapping cycle is active.
    pub const TAPPING: Conditions = Conditions(1 << 2);
    /// Thread cutting is active.
    pub const THREADING: Conditions = Conditions(1 << 3);
    /// G63 is active.
    pub const FEED_FORCED: Conditions = Conditions(1 << 4);
    /// The axes are positioning.
    pub const RAPID: Conditions = Conditions(1 << 5);
    /// Feed hold is active.
    pub const FEED_HOLD: Conditions = Conditions(1 << 6);

    /// Both these and those.
    #[must_use]
    pub const fn with(self, others: Conditions) -> Self {
        Conditions(self.0 | others.0)
    }

    /// Whether one of `others` is among these.
    pub const fn has(self, others: Conditions) -> bool {
        self.0 & others.0 != 0
    }

    /// The condition that keeps the laws off the override, if any.
    pub fn refusing(self) -> Option<Condition> {
        if self.has(Self::CUTTER_COMPENSATION) {
            Some(Condition::CutterCompensation)
        } else {
            self.has(Self::OVERRIDE_OFF).then_some(Condition::OverrideOff)
        }
    }

    /// Why the override must stay at 100 % for now, if it must.
    pub fn inhibiting(self) -> Option<Inhibit> {
        let causes = [
            (Self::TAPPING, Inhibit::Tapping),
            (Self::THREADING, Inhibit::Threading),
            (Self::FEED_FORCED, Inhibit::FeedForced),
            (Self::RAPID, Inhibit::Rapid),
        ];
        causes.into_iter().find(|(condition, _)| self.has(*condition)).map(|(_, why)| why)
    }
}

impl Input<'_> {
    /// Why the override must stay at 100 % for now: a condition, or a segment it does not act on.
    pub fn inhibiting(&self) -> Option<Inhibit> {
        let no_feed = self.work.is_some_and(|(_, segment)| !segment.takes_override());
        self.conditions.inhibiting().or(no_feed.then_some(Inhibit::NoFeed))
    }
}
