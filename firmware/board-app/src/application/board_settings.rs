//! Settings of a board that a host can change one by one.

use arcfeed_link::message::codes::{RefusalCode, SettingCode};
use arcfeed_link::message::table;
use arcfeed_model::job::OverrideLimits;
use arcfeed_units::Span;

use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::settings::{Settings, SettingsError};

/// Default period of the reports.
const REPORT_EVERY: Span = Span::from_ms(50);
/// Longest period; with a longer one the host would consider the board silent.
const REPORT_SLOWEST: Span = Span::from_ms(1_000);
/// Shortest period: reports must leave room on the line.
const REPORT_FASTEST: Span = Span::from_ms(5);

/// All settings of a board that the host can change, one by one, between two jobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardSettings {
    /// Time-outs and thresholds of the supervisor.
    pub settings: Settings,
    /// Time between two status reports to the host.
    pub report_every: Span,
}

impl BoardSettings {
    /// Settings of a board with these settings of the supervisor, and the default period of reports.
    ///
    /// # Errors
    /// Settings that contradict each other or are out of range.
    pub fn new(settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(BoardSettings { settings, report_every: REPORT_EVERY })
    }

    /// Whether a supervisor with these settings accepts this range, step and slew rates of the override.
    pub fn allow(&self, limits: &OverrideLimits) -> bool {
        Supervisor::within(limits, self.settings).is_ok()
    }

    /// The present value of one setting, as a message to the host.
    pub fn value(&self, setting: SettingCode) -> table::Setting {
        let Settings { position, link, lost_after_frames, resync, longest_tick, .. } = self.settings;
        let value = match setting {
            SettingCode::PositionStale => position.stale_after.0,
            SettingCode::PositionLost => position.lost_after.0,
            SettingCode::PositionKeep => position.time_to_live.0,
            SettingCode::LinkStale => link.stale_after.0,
            SettingCode::LinkLost => link.lost_after.0,
            SettingCode::LinkKeep => link.time_to_live.0,
            SettingCode::LostFrames => u32::from(lost_after_frames),
            SettingCode::Resync => resync.0,
            SettingCode::LongestTick => longest_tick.0,
            SettingCode::DialBelow => u32::from(self.settings.take_over_below_percent),
            SettingCode::DialDrop => u32::from(self.settings.take_over_drop_percent),
            SettingCode::ReportEvery => self.report_every.0,
        };
        table::Setting { setting, value }
    }

    /// Changes one setting, if the settings then still fit each other.
    ///
    /// # Errors
    /// [`RefusalCode::Value`], and nothing is changed.
    pub fn set(&mut self, setting: SettingCode, value: u32) -> Result<(), RefusalCode> {
        let mut next = *self;
        let percent = || u8::try_from(value).map_err(|_| RefusalCode::Value);
        let settings = &mut next.settings;
        match setting {
            SettingCode::PositionStale => settings.position.stale_after = Span(value),
            SettingCode::PositionLost => settings.position.lost_after = Span(value),
            SettingCode::PositionKeep => settings.position.time_to_live = Span(value),
            SettingCode::LinkStale => settings.link.stale_after = Span(value),
            SettingCode::LinkLost => settings.link.lost_after = Span(value),
            SettingCode::LinkKeep => settings.link.time_to_live = Span(value),
            SettingCode::LostFrames => settings.lost_after_frames = percent()?,
            SettingCode::Resync => settings.resync = Span(value),
            SettingCode::LongestTick => settings.longest_tick = Span(value),
            SettingCode::DialBelow => settings.take_over_below_percent = percent()?,
            SettingCode::DialDrop => settings.take_over_drop_percent = percent()?,
            SettingCode::ReportEvery => next.report_every = Span(value),
        }
        let is_in_time = (REPORT_FASTEST..=REPORT_SLOWEST).contains(&next.report_every);
        if next.settings.check().is_err() || !is_in_time {
            return Err(RefusalCode::Value);
        }
        *self = next;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_comes_back_as_it_was_set() {
        let mut settings = BoardSettings::new(Settings::default()).unwrap();
        for setting in SettingCode::ALL {
            let before = settings.value(*setting).value;
            assert_eq!(settings.set(*setting, before + 1), Ok(()), "{setting:?}");
            let others = SettingCode::ALL.iter().filter(|other| *other != setting);
            let sum: u32 = others.map(|other| settings.value(*other).value).sum();
            assert_eq!(settings.value(*setting).value, before + 1);
            assert_eq!(settings.set(*setting, before), Ok(()));
            let others = SettingCode::ALL.iter().filter(|other| *other != setting);
            assert_eq!(
                others.map(|other| settings.value(*other).value).sum::<u32>(),
                sum,
                "{setting:?} is nothing else's"
            );
        }
        assert_eq!(settings, BoardSettings::new(Settings::default()).unwrap());
    }

    #[test]
    fn what_makes_no_sense_together_changes_nothing() {
        let mut settings = BoardSettings::new(Settings::default()).unwrap();
        for (setting, value) in [
            (SettingCode::LinkLost, 50_000),
            (SettingCode::PositionStale, 0),
            (SettingCode::LostFrames, 0),
            (SettingCode::LostFrames, 256),
            (SettingCode::DialBelow, 101),
            (SettingCode::Resync, 299_999),
            (SettingCode::LongestTick, 20_001),
            (SettingCode::ReportEvery, 4_999),
            (SettingCode::ReportEvery, u32::MAX),
        ] {
            assert_eq!(settings.set(setting, value), Err(RefusalCode::Value), "{setting:?} {value}");
            assert_eq!(settings, BoardSettings::new(Settings::default()).unwrap());
        }
    }
}
