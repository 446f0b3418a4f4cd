//! Signals between the machine's ladder and the control: the feed override.
//!
//! *FV0 to *FV7 (G012) carry the override in binary, inverted: a line at 0 counts. All lines at 0 (255 %) are taken as all
//! at 1: 0 %, so that neither a broken cable nor a dead card moves an axis. OVC (G006 bit 4), and #3004 with bit 1 set,
//! make it 100 %. Source: B-63943EN-1 p. 724.

use arcfeed_units::PERCENT;

/// Largest override that the lines can carry, %.
pub const OVERRIDE_MAX_PERCENT: u8 = 254;

/// Levels of the eight override lines as bits, *FV0 in bit 0. They are inverted: a line at 0 counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeedOverrideLines(pub u8);

impl FeedOverrideLines {
    /// Levels for an override in %, at most 254 %.
    pub fn of_percent(percent: u8) -> Self {
        FeedOverrideLines(!percent.min(OVERRIDE_MAX_PERCENT))
    }

    /// Override, %, that the control reads from these levels; 0 if all are at 0, as with a broken cable.
    pub fn percent(self) -> u8 {
        if self.0 == 0 { 0 } else { !self.0 }
    }

    /// Override, %, that the control applies: 100 % if the override is cancelled, otherwise the one read.
    pub fn effective_percent(self, is_cancelled: bool) -> u8 {
        if is_cancelled { PERCENT as u8 } else { self.percent() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_inverted_and_both_ends_are_a_stop() {
        // All at 1, *FV0 at 0, *FV6, 5 and 2 at 0 (64 + 32 + 4), all but *FV0 at 0, all at 0.
        for (lines, percent) in [(0xFF, 0), (0xFE, 1), (0x9B, 100), (0x01, 254), (0x00, 0)] {
            assert_eq!(FeedOverrideLines(lines).percent(), percent, "{lines:#04x}");
        }
    }

    #[test]
    fn a_dial_of_the_field_reads_in_tens() {
        // A ladder's table 255, 245, ... 105 on G012, as users write it: 0, 10, ... 150 %.
        for step in 0..16 {
            assert_eq!(FeedOverrideLines(255 - 10 * step).percent(), 10 * step);
        }
    }

    #[test]
    fn no_more_than_254_percent_can_be_asked_for() {
        for percent in 0..=u8::MAX {
            assert_eq!(FeedOverrideLines::of_percent(percent).percent(), percent.min(254));
        }
    }

    #[test]
    fn cancelled_it_is_100_percent() {
        assert_eq!(FeedOverrideLines(0xFF).effective_percent(true), 100);
        assert_eq!(FeedOverrideLines(0xFF).effective_percent(false), 0);
    }
}
