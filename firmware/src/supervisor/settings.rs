//! What the supervisor is told once: times, counts, and how far a turn of the dial counts as taking over.

use arcfeed_shared::units::Span;

use crate::ramp::LimitsError;

use super::input::{Freshness, Loss, Quality, Source};

/// Times and thresholds; config.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// A sample or frame older than this is stale: the override stays as it is.
    pub stale_after: Span,
    /// Silence this long is a loss.
    pub lost_after: Span,
    /// So many invalid frames in a row are a loss (K).
    pub lost_after_frames: u8,
    /// How long the last value stays in force, counted from the last valid sample.
    pub time_to_live: Span,
    /// How long samples must be fresh without a gap before arming is accepted after a loss.
    pub resync: Span,
    /// A tick longer than this raises the override no further than one of this length would.
    pub longest_tick: Span,
    /// A dial below this takes over, %.
    pub take_over_below_percent: u8,
    /// A dial turned down by more than this takes over, points of per cent.
    pub take_over_drop_percent: u8,
}

/// Why a supervisor is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingsError {
    /// The bounds of the override make no sense.
    Limits(LimitsError),
    /// Not 0 < `stale_after` <= `lost_after` <= `time_to_live` <= `resync`.
    Times,
    /// No invalid frame would be a loss.
    Frames,
    /// The longest tick is zero or longer than `stale_after`.
    Tick,
    /// A threshold of the dial is zero or above 100 %.
    Dial,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            stale_after: Span::from_ms(20),
            lost_after: Span::from_ms(50),
            lost_after_frames: 5,
            time_to_live: Span::from_ms(300),
            resync: Span::from_ms(500),
            longest_tick: Span::from_ms(10),
            take_over_below_percent: 50,
            take_over_drop_percent: 10,
        }
    }
}

impl Settings {
    /// Checks the settings.
    ///
    /// # Errors
    /// See [`SettingsError`].
    pub fn check(&self) -> Result<(), SettingsError> {
        let times = [Span(1), self.stale_after, self.lost_after, self.time_to_live, self.resync];
        let is_dial = |percent: u8| (1..=100).contains(&percent);
        if !times.is_sorted() {
            Err(SettingsError::Times)
        } else if self.lost_after_frames == 0 {
            Err(SettingsError::Frames)
        } else if self.longest_tick == Span(0) || self.longest_tick > self.stale_after {
            Err(SettingsError::Tick)
        } else if !is_dial(self.take_over_below_percent) || !is_dial(self.take_over_drop_percent) {
            Err(SettingsError::Dial)
        } else {
            Ok(())
        }
    }

    /// Whether position and link are [`Quality::Fresh`] as far as their age goes.
    #[inline(always)]
    pub fn is_fresh(&self, position: &Freshness, link: &Freshness) -> bool {
        position.age <= self.stale_after && link.age <= self.stale_after
    }

    /// What position and link are worth now, the worse of the two.
    pub fn quality(&self, position: &Freshness, link: &Freshness) -> Quality {
        let age = position.age.max(link.age);
        let invalid = position.invalid_in_row.max(link.invalid_in_row);
        if self.is_fresh(position, link) && invalid == 0 {
            Quality::Fresh
        } else if age <= self.lost_after && invalid < self.lost_after_frames {
            Quality::Stale
        } else {
            let is_lost = position.age > self.lost_after || position.invalid_in_row >= self.lost_after_frames;
            let source = if is_lost { Source::Position } else { Source::Link };
            Quality::Lost(Loss { source, keep: self.time_to_live.shorter_by(age) })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_sound_and_senseless_settings_are_refused() {
        let good = Settings::default();
        assert_eq!(good.check(), Ok(()));
        for (bad, error) in [
            (Settings { stale_after: Span(0), ..good }, SettingsError::Times),
            (Settings { lost_after: Span::from_ms(10), ..good }, SettingsError::Times),
            (Settings { time_to_live: Span::from_ms(40), ..good }, SettingsError::Times),
            (Settings { resync: Span::from_ms(200), ..good }, SettingsError::Times),
            (Settings { lost_after_frames: 0, ..good }, SettingsError::Frames),
            (Settings { longest_tick: Span(0), ..good }, SettingsError::Tick),
            (Settings { longest_tick: Span::from_ms(21), ..good }, SettingsError::Tick),
            (Settings { take_over_below_percent: 0, ..good }, SettingsError::Dial),
            (Settings { take_over_drop_percent: 101, ..good }, SettingsError::Dial),
        ] {
            assert_eq!(bad.check(), Err(error), "{bad:?}");
        }
    }

    #[test]
    fn the_worse_of_position_and_link_counts() {
        let settings = Settings::default();
        let aged = |ms: u32, invalid_in_row: u8| Freshness { age: Span::from_ms(ms), invalid_in_row };
        let quality = |position, link| settings.quality(&position, &link);
        assert_eq!(quality(aged(20, 0), aged(0, 0)), Quality::Fresh);
        assert_eq!(quality(aged(21, 0), aged(0, 0)), Quality::Stale);
        assert_eq!(quality(aged(0, 0), aged(0, 4)), Quality::Stale);
        let lost = |source, ms| Quality::Lost(Loss { source, keep: Span::from_ms(ms) });
        assert_eq!(quality(aged(51, 0), aged(0, 0)), lost(Source::Position, 249));
        assert_eq!(quality(aged(0, 0), aged(5, 5)), lost(Source::Link, 295));
        assert_eq!(quality(aged(0, 0), aged(900, 0)), lost(Source::Link, 0));
    }
}
