//! Code of a feed override on the eight lines *FV0 to *FV7, from which a Fanuc-like control reads it.
//!
//! Line i is active low and weighs 2^i per cent. The control reads the sum of the weights of the lines that are low;
//! all lines low reads 0 %, as all lines high does, so that a broken wire or a dead card stops the axes (Fanuc
//! B-63943EN-1, signal *FV0 to *FV7, G012).

use crate::ramp::FeedOverride;

/// Number of override lines, *FV0 to *FV7.
pub const LINES: usize = 8;

/// Largest override that the lines can code, %.
pub const HIGHEST_PERCENT: u8 = 254;

/// All lines low, which the control reads as 0 %.
const ALL_LOW: u8 = 0xFF;

/// State of the lines *FV0 to *FV7: bit i is set if *FVi is low.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LineCode(u8);

impl LineCode {
    /// All lines high, which the control reads as 0 %.
    pub const RELEASED: LineCode = LineCode(0);

    /// The code of an override; one above [`HIGHEST_PERCENT`] is limited to it.
    pub fn of(feed_override: FeedOverride) -> Self {
        LineCode(feed_override.percent.min(HIGHEST_PERCENT))
    }

    /// The override that a control reads from these lines.
    pub fn reads(self) -> FeedOverride {
        FeedOverride { percent: if self.0 == ALL_LOW { 0 } else { self.0 } }
    }

    /// Whether the line with this number (0 to 7) is low, so that its weight counts.
    pub fn is_low(self, line: u8) -> bool {
        u32::from(self.0).checked_shr(u32::from(line)).is_some_and(|bits| bits & 1 == 1)
    }

    /// Levels of all lines as the bits of an output port: bit i is 1 if *FVi is high.
    pub fn levels(self) -> u8 {
        !self.0
    }

    /// The code whose low lines are those that are low in both codes.
    #[must_use]
    pub fn shared_with(self, other: LineCode) -> Self {
        LineCode(self.0 & other.0)
    }

    /// Whether at least one line is low in `self` and high in `other`.
    pub fn has_more_than(self, other: LineCode) -> bool {
        self.0 & !other.0 != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(percent: u8) -> LineCode {
        LineCode::of(FeedOverride { percent })
    }

    #[test]
    fn the_levels_are_the_weights_inverted() {
        for (percent, levels) in
            [(0, 0b1111_1111), (1, 0b1111_1110), (100, 0b1001_1011), (128, 0b0111_1111), (254, 0b0000_0001)]
        {
            assert_eq!(code(percent).levels(), levels, "{percent} %");
        }
    }

    #[test]
    fn the_control_reads_every_override_as_it_was_meant() {
        for percent in 0..=HIGHEST_PERCENT {
            assert_eq!(code(percent).reads().percent, percent);
            let sum: u32 = (0..8).filter(|line| code(percent).is_low(*line)).map(|line| 1 << line).sum();
            assert_eq!(sum, u32::from(percent));
        }
    }

    #[test]
    fn all_lines_low_is_never_sent_and_would_read_as_nothing() {
        assert_eq!(code(255), code(254));
        assert_eq!(LineCode(ALL_LOW).reads().percent, 0);
        assert_eq!(LineCode::RELEASED.reads().percent, 0);
    }

    #[test]
    fn there_is_no_ninth_line() {
        assert!((8..=255).all(|line| !code(254).is_low(line)));
    }
}
