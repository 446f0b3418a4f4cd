//! Inputs at a tick of the supervisor, which decides whether the feed laws may set the override, and their evaluation.

use arcfeed_units::Span;

use crate::active::ActiveSegment;
use crate::controller;

use super::signals::{Inhibit, Signals};

/// The segment in execution, with a number that is different for each segment; `None` if none is in execution.
pub type Work<'a> = Option<(u32, &'a ActiveSegment)>;

/// Measured values, dial and signals of a tick, from which the supervisor decides; without the segment in execution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Position, spindle speed and the time since the last tick.
    pub measured: controller::Measurement,
    /// Age and validity of the newest position.
    pub position: Freshness,
    /// Age and validity of the newest frame of the link over which the segments arrive; [`Freshness::NOW`] if all
    /// segments are on the board already.
    pub link: Freshness,
    /// Position of the operator's override dial, %.
    pub operator_percent: u8,
    /// Signals of the control, the board and the operator, one bit each.
    pub signals: Signals,
}

/// Age of the newest data from one source, and the number of invalid ones since.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Freshness {
    /// Time since the last valid sample or frame.
    pub age: Span,
    /// Number of invalid frames since then (wrong checksum, old sequence number, or value out of range); their
    /// contents are ignored.
    pub invalid_in_row: u8,
}

/// Source of data without which no law may set the override: the position or the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Source {
    /// The axes' positions.
    Position,
    /// The link to the host.
    Link,
}

/// Loss of a source, as found at a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loss {
    /// The lost source.
    pub source: Source,
    /// Time for which the override still keeps its last value.
    pub keep: Span,
}

/// Quality of the newest data from position and link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Recent and valid: a law may act.
    Fresh,
    /// Too old or invalid, but not yet lost: the override does not change.
    Stale,
    /// So old, or so often invalid, that the source counts as lost.
    Lost,
}

impl Freshness {
    /// Data of age zero, without invalid ones since.
    pub const NOW: Freshness = Freshness { age: Span(0), invalid_in_row: 0 };
}

impl Input {
    /// Input with these measured values, a fresh position and link, the dial at 100 %, and no signals.
    pub const fn of(measured: controller::Measurement) -> Self {
        Input {
            measured,
            position: Freshness::NOW,
            link: Freshness::NOW,
            operator_percent: 100,
            signals: Signals::NONE,
        }
    }

    /// Reason why the override does not act at present: a condition of the control, or a segment without
    /// a feed per minute. `None` if it acts.
    #[inline(always)]
    pub fn inhibiting(&self, work: Work<'_>) -> Option<Inhibit> {
        let no_feed = work.is_some_and(|(_, segment)| !segment.takes_override());
        self.signals.inhibiting().or(no_feed.then_some(Inhibit::NoFeed))
    }
}
