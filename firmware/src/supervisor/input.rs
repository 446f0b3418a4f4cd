//! What is known at a tick, and what it amounts to.

use arcfeed_shared::units::Span;

use crate::active::ActiveSegment;
use crate::controller;

use super::signals::{Inhibit, Signals};

/// The segment in work and its running count; `None` with nothing in work.
pub type Work<'a> = Option<(u32, &'a ActiveSegment)>;

/// Everything else that the supervisor decides from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Position, spindle speed and the time since the last tick.
    pub measured: controller::Input,
    /// How good the position is.
    pub position: Freshness,
    /// How good the link is that brings the segments; [`Freshness::NOW`] where they are all on board.
    pub link: Freshness,
    /// The operator's dial, %.
    pub operator_percent: u8,
    /// What the control, the board itself and people say, a bit each.
    pub signals: Signals,
}

/// Age and validity of what a line brings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Freshness {
    /// Time since the last valid sample or frame.
    pub age: Span,
    /// Invalid frames since then (bad check sum, stale sequence, out of range); they change nothing else.
    pub invalid_in_row: u8,
}

/// What was lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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
    pub keep: Span,
}

/// What the samples are worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Good enough to act on.
    Fresh,
    /// Too old or invalid, but not lost: nothing changes.
    Stale,
    /// Gone.
    Lost,
}

impl Freshness {
    /// Just arrived and valid.
    pub const NOW: Freshness = Freshness { age: Span(0), invalid_in_row: 0 };
}

impl Input {
    /// A board that knows position, spindle speed and time, all fresh, and nothing of an operator's dial or of the control's
    /// conditions.
    pub const fn of(measured: controller::Input) -> Self {
        Input {
            measured,
            position: Freshness::NOW,
            link: Freshness::NOW,
            operator_percent: 100,
            signals: Signals::NONE,
        }
    }

    /// Why the override must stay at 100 % for now: a condition, or a segment it does not act on.
    #[inline(always)]
    pub fn inhibiting(&self, work: Work<'_>) -> Option<Inhibit> {
        let no_feed = work.is_some_and(|(_, segment)| !segment.takes_override());
        self.signals.inhibiting().or(no_feed.then_some(Inhibit::NoFeed))
    }
}
