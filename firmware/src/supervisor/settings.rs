//! Settings of the supervisor: time-outs, counts, and thresholds of the dial.

use arcfeed_units::Span;

use crate::ramp::LimitsError;

use super::input::{Freshness, Loss, Quality, Source};

/// Time-outs and thresholds of the supervisor, which decides whether the feed laws may set the override.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Time-outs of the measured position.
    pub position: Timeouts,
    /// Time-outs of the link to the host.
    pub link: Timeouts,
    /// K: number of consecutive invalid frames or samples from which a source counts as lost.
    pub lost_after_frames: u8,
    /// Time for which position and link must be fresh without a gap after a loss, before arming is accepted.
    pub resync: Span,
    /// Longest expected tick: a longer one raises the override no further than one of this length would.
    pub longest_tick: Span,
    /// Position of the operator's dial, %, below which the operator takes the override from the laws.
    pub take_over_below_percent: u8,
    /// Drop of the dial, percentage points, above which the operator takes the override from the laws.
    pub take_over_drop_percent: u8,
}

/// Ages of the newest data from one source from which they are stale, then lost, and up to which the last override is
/// kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timeouts {
    /// Age from which data are stale: the override does not change.
    pub stale_after: Span,
    /// Age from which the source counts as lost.
    pub lost_after: Span,
    /// Age up to which the override keeps its last value after the loss; then it goes to 100 %, or to the dial if that
    /// is lower.
    pub time_to_live: Span,
}

/// Reason why settings of the supervisor are rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingsError {
    /// The bounds, step or slew rates of the override are invalid.
    Limits(LimitsError),
    /// 0 < `stale_after` <= `lost_after` <= `time_to_live` <= `resync` is violated, for position or link.
    Times,
    /// The number of invalid frames is zero.
    Frames,
    /// The longest tick is zero or longer than `stale_after` of position or link.
    Tick,
    /// A threshold of the dial is zero or above 100 %.
    Dial,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            position: Timeouts::from_ms(20, 50, 300),
            // A byte on a serial line takes about 90 us, a lost frame is repeated after 100 ms: see docs/protocol.md.
            link: Timeouts::from_ms(100, 250, 300),
            lost_after_frames: 5,
            resync: Span::from_ms(500),
            longest_tick: Span::from_ms(10),
            take_over_below_percent: 50,
            take_over_drop_percent: 10,
        }
    }
}

impl Timeouts {
    /// Time-outs in milliseconds: ages from which data are stale and lost, and up to which the last override is kept.
    pub const fn from_ms(stale_ms: u32, lost_ms: u32, keep_ms: u32) -> Self {
        Timeouts {
            stale_after: Span::from_ms(stale_ms),
            lost_after: Span::from_ms(lost_ms),
            time_to_live: Span::from_ms(keep_ms),
        }
    }

    /// Remaining time for which the last value is kept.
    fn keep(&self, age: Span) -> Span {
        self.time_to_live.shorter_by(age)
    }
}

impl Settings {
    /// Checks that the settings fit each other.
    ///
    /// # Errors
    /// See [`SettingsError`].
    pub fn check(&self) -> Result<(), SettingsError> {
        let both = [self.position, self.link];
        let is_in_order = |Timeouts { stale_after, lost_after, time_to_live }: Timeouts| {
            [Span(1), stale_after, lost_after, time_to_live, self.resync].is_sorted()
        };
        let is_dial = |percent: u8| (1..=100).contains(&percent);
        if !both.into_iter().all(is_in_order) {
            Err(SettingsError::Times)
        } else if self.lost_after_frames == 0 {
            Err(SettingsError::Frames)
        } else if self.longest_tick == Span(0) || both.iter().any(|timeouts| self.longest_tick > timeouts.stale_after) {
            Err(SettingsError::Tick)
        } else if !is_dial(self.take_over_below_percent) || !is_dial(self.take_over_drop_percent) {
            Err(SettingsError::Dial)
        } else {
            Ok(())
        }
    }

    /// Quality of position and link together: that of the worse one.
    #[inline(always)]
    pub fn quality(&self, position: &Freshness, link: &Freshness) -> Quality {
        let is_fresh = position.age <= self.position.stale_after && link.age <= self.link.stale_after;
        if is_fresh && position.invalid_in_row | link.invalid_in_row == 0 {
            Quality::Fresh
        } else {
            self.quality_of_old(position, link)
        }
    }

    #[cold]
    #[inline(never)]
    fn quality_of_old(&self, position: &Freshness, link: &Freshness) -> Quality {
        let is_lost = self.is_lost(position, &self.position) || self.is_lost(link, &self.link);
        if is_lost { Quality::Lost } else { Quality::Stale }
    }

    /// The lost source, the position if both are lost, and the time for which the override still keeps its last value.
    /// Call it only if one is lost.
    #[cold]
    pub fn loss(&self, position: &Freshness, link: &Freshness) -> Loss {
        let keep = self.position.keep(position.age).min(self.link.keep(link.age));
        let source = if self.is_lost(position, &self.position) { Source::Position } else { Source::Link };
        Loss { source, keep }
    }

    fn is_lost(&self, source: &Freshness, timeouts: &Timeouts) -> bool {
        source.age > timeouts.lost_after || source.invalid_in_row >= self.lost_after_frames
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
            (Settings { position: Timeouts::from_ms(0, 50, 300), ..good }, SettingsError::Times),
            (Settings { position: Timeouts::from_ms(20, 10, 300), ..good }, SettingsError::Times),
            (Settings { position: Timeouts::from_ms(20, 50, 40), ..good }, SettingsError::Times),
            (Settings { link: Timeouts::from_ms(100, 90, 300), ..good }, SettingsError::Times),
            (Settings { link: Timeouts::from_ms(100, 250, 600), ..good }, SettingsError::Times),
            (Settings { link: Timeouts::from_ms(9, 250, 300), ..good }, SettingsError::Tick),
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
        assert_eq!(quality(aged(20, 0), aged(100, 0)), Quality::Fresh);
        assert_eq!(quality(aged(21, 0), aged(0, 0)), Quality::Stale);
        assert_eq!(quality(aged(0, 0), aged(101, 0)), Quality::Stale);
        assert_eq!(quality(aged(0, 0), aged(250, 4)), Quality::Stale);
        for (position, link, source, keep_ms) in [
            (aged(51, 0), aged(0, 0), Source::Position, 249),
            (aged(0, 0), aged(251, 0), Source::Link, 49),
            (aged(0, 0), aged(5, 5), Source::Link, 295),
            (aged(0, 0), aged(900, 0), Source::Link, 0),
            (aged(51, 0), aged(280, 0), Source::Position, 20),
        ] {
            assert_eq!(quality(position, link), Quality::Lost, "{position:?}, {link:?}");
            assert_eq!(settings.loss(&position, &link), Loss { source, keep: Span::from_ms(keep_ms) });
        }
    }
}
