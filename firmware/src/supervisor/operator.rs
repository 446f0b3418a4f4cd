//! The operator's override dial, and its effect on the override that a feed law demands.
//!
//! Up to 100 % it is a share of the law's demand. Above 100 % it has no effect on a demand, whose chip is at its
//! target already. If it is turned down far enough, the operator takes over.

use arcfeed_units::PERCENT;

/// Smallest movement of the dial that is not noise, percentage points.
const RAISED_PERCENT: u8 = 2;

/// The operator's override dial: its reading, and the largest reading from which a drop counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatorDial {
    percent: u8,
    /// Largest reading since arming, or since the operator last took over.
    reference_percent: u8,
    share_ratio: f32,
}

/// Movement of the dial since the last tick, as far as it has an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DialTurn {
    /// Not turned, or turned up.
    Kept,
    /// Turned down, but not so far that the operator takes over: the override falls in proportion.
    Down {
        /// Reading before the movement, %.
        from_percent: u8,
    },
    /// Turned down below the lower threshold, or by more than the allowed drop: the operator takes the override from
    /// the laws.
    TakesOver,
}

impl Default for OperatorDial {
    fn default() -> Self {
        OperatorDial { percent: 100, reference_percent: 100, share_ratio: 1.0 }
    }
}

impl OperatorDial {
    /// Processes a reading, %. The operator takes over below `below_percent`, or with a drop of more than
    /// `drop_percent` from the largest reading.
    #[inline(always)]
    pub fn read(&mut self, percent: u8, below_percent: u8, drop_percent: u8) -> DialTurn {
        let turn = if percent == self.percent { DialTurn::Kept } else { self.turn_to(percent) };
        if percent < below_percent || self.reference_percent.saturating_sub(percent) > drop_percent {
            self.reference_percent = percent;
            DialTurn::TakesOver
        } else {
            turn
        }
    }

    /// Not inlined: at most ticks the dial does not move.
    #[inline(never)]
    fn turn_to(&mut self, percent: u8) -> DialTurn {
        let from_percent = core::mem::replace(&mut self.percent, percent);
        self.reference_percent = self.reference_percent.max(percent);
        self.share_ratio = share_ratio(percent);
        if percent < from_percent { DialTurn::Down { from_percent } } else { DialTurn::Kept }
    }

    /// Makes the current reading the one from which drops are measured.
    pub fn take_reference(&mut self) {
        self.reference_percent = self.percent;
    }

    /// The last reading, %.
    pub fn percent(self) -> u8 {
        self.percent
    }

    /// The last reading as a ratio: 1 at 100 %.
    pub fn ratio(self) -> f32 {
        f32::from(self.percent) / PERCENT
    }

    /// Factor by which the dial reduces a law's demand: its reading as a ratio, at most 1.
    pub fn share_ratio(self) -> f32 {
        self.share_ratio
    }

    /// Factor by which the override must fall because the dial was turned from `from_percent` to its present reading.
    pub fn fall_ratio(self, from_percent: u8) -> f32 {
        if from_percent == 0 { 0.0 } else { self.share_ratio() / share_ratio(from_percent) }
    }

    /// Whether the dial was turned up from `lowest_percent` by more than noise.
    pub fn is_raised_from(self, lowest_percent: u8) -> bool {
        self.percent >= lowest_percent.saturating_add(RAISED_PERCENT)
    }
}

fn share_ratio(percent: u8) -> f32 {
    f32::from(percent.min(100)) / PERCENT
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turns(readings: &[u8]) -> Vec<DialTurn> {
        let mut dial = OperatorDial::default();
        readings.iter().map(|percent| dial.read(*percent, 50, 10)).collect()
    }

    #[test]
    fn ten_points_down_are_a_share_and_eleven_take_over() {
        let down = |from_percent| DialTurn::Down { from_percent };
        assert_eq!(turns(&[100, 95, 90]), [DialTurn::Kept, down(100), down(95)]);
        assert_eq!(turns(&[100, 95, 89]), [DialTurn::Kept, down(100), DialTurn::TakesOver]);
        assert_eq!(turns(&[100, 89, 88]), [DialTurn::Kept, DialTurn::TakesOver, down(89)]);
    }

    #[test]
    fn below_the_threshold_it_takes_over_at_every_reading() {
        assert_eq!(
            turns(&[92, 49, 49, 49]),
            [DialTurn::Down { from_percent: 100 }, DialTurn::TakesOver, DialTurn::TakesOver, DialTurn::TakesOver]
        );
    }

    #[test]
    fn a_drop_counts_from_the_highest_reading_since_the_reference() {
        assert_eq!(turns(&[100, 120, 109])[2], DialTurn::TakesOver);
        let mut dial = OperatorDial::default();
        dial.read(100, 50, 10);
        dial.read(91, 50, 10);
        dial.take_reference();
        assert_eq!(dial.read(85, 50, 10), DialTurn::Down { from_percent: 91 });
    }

    #[test]
    fn above_100_the_share_is_all() {
        let mut dial = OperatorDial::default();
        for (percent, share) in [(0, 0.0), (60, 0.6), (100, 1.0), (150, 1.0), (255, 1.0)] {
            dial.read(percent, 50, 10);
            assert_eq!(dial.share_ratio(), share);
        }
        assert_eq!(dial.fall_ratio(0), 0.0);
    }
}
