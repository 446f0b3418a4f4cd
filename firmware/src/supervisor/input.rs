//! Inputs of the supervisor at a tick, and their evaluation.

use arcfeed_units::Span;

use crate::active::ActiveSegment;
use crate::controller;

use super::signals::{Inhibit, Signals};

/// The segment in execution and its count; `None` for none.
pub type Work<'a> = Option<(u32, &'a ActiveSegment)>;

/// Inputs of the supervisor at a tick, except the segment in execution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Position, spindle speed and the time since the last tick.
    pub measured: controller::Measurement,
    /// Age and validity of the position.
    pub position: Freshness,
    /// Age and validity of the link that supplies the segments; [`Freshness::NOW`] if all segments are on the board.
    pub link: Freshness,
    /// The operator's dial, %.
    pub operator_percent: u8,
    /// Signals of the control, the board and the operator, one bit each.
    pub signals: Signals,
}

/// Age and validity of a line's data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Freshness {
    /// Time since the last valid sample or frame.
    pub age: Span,
    /// Invalid frames since then (wrong checksum, stale sequence, out of range); they have no other effect.
    pub invalid_in_row: u8,
}

/// Source of data whose loss the supervisor detects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Source {
    /// The axes' positions.
    Position,
    /// The link to the host.
    Link,
}

/// A lost source, at the time of its detection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loss {
    /// Lost source.
    pub source: Source,
    /// Remaining time for which the last value is kept.
    pub keep: Span,
}

/// Quality of the data from a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Recent and valid.
    Fresh,
    /// Too old or invalid, but not lost: the override does not change.
    Stale,
    /// Lost.
    Lost,
}

impl Freshness {
    /// Valid and of age zero.
    pub const NOW: Freshness = Freshness { age: Span(0), invalid_in_row: 0 };
}

impl Input {
    /// Input of a board with a fresh position, spindle speed and time, but without an operator's dial and conditions
    /// of the control.
    pub const fn of(measured: controller::Measurement) -> Self {
        Input {
            measured,
            position: Freshness::NOW,
            link: Freshness::NOW,
            operator_percent: 100,
            signals: Signals::NONE,
        }
    }

    /// Reason why the override must be 100 % at present: a condition, or a segment on which it does not act.
    #[inline(always)]
    pub fn inhibiting(&self, work: Work<'_>) -> Option<Inhibit> {
        let no_feed = work.is_some_and(|(_, segment)| !segment.takes_override());
        self.signals.inhibiting().or(no_feed.then_some(Inhibit::NoFeed))
    }
}
