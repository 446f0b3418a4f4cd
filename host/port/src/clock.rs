//! Wall time: a clock that starts when a port is opened, and the time of day.

use std::time::{Duration, Instant, SystemTime};

use arcfeed_units::Micros;

const S_PER_DAY: u64 = 86_400;
/// Days of 400 years, after which the calendar repeats.
const DAYS_PER_ERA: u64 = 146_097;
/// Days from 0000-03-01 to 1970-01-01.
const DAYS_TO_EPOCH: u64 = 719_468;

/// Wall clock (monotonic) that is zero when it is created.
#[derive(Clone, Copy, Debug)]
pub struct WallClock {
    since: Instant,
    started: SystemTime,
}

impl WallClock {
    /// Clock whose zero is the present moment.
    pub fn start() -> Self {
        WallClock { since: Instant::now(), started: SystemTime::now() }
    }

    /// Time since the clock's start.
    pub fn now(&self) -> Micros {
        Micros(u64::try_from(self.since.elapsed().as_micros()).unwrap_or(u64::MAX))
    }

    /// Date and time of the clock's start.
    pub fn started(&self) -> SystemTime {
        self.started
    }

    /// Sleeps until `deadline`, which counts from the clock's start; returns at once if that has passed.
    pub fn wait(&self, deadline: Micros) {
        std::thread::sleep(Duration::from_micros(deadline.since(self.now()).0));
    }
}

/// Date and time in UTC in ISO 8601, to the second: `2026-11-22T06:04:45Z`. Times before 1970 become 1970.
///
/// Source: H. Hinnant, "chrono-Compatible Low-Level Date Algorithms", `civil_from_days`: years begin in March.
pub fn iso_8601(time: SystemTime) -> String {
    let s = time.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let days = s / S_PER_DAY + DAYS_TO_EPOCH;
    let (era, day_of_era) = (days / DAYS_PER_ERA, days % DAYS_PER_ERA);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let months_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * months_from_march + 2) / 5 + 1;
    let month = if months_from_march < 10 { months_from_march + 3 } else { months_from_march - 9 };
    let year = 400 * era + year_of_era + u64::from(month <= 2);
    let (hour, minute, second) = (s / 3_600 % 24, s / 60 % 60, s % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_and_times_are_those_of_the_calendar() {
        // Computed with `date -u -d @SECONDS +%FT%TZ` (GNU coreutils).
        for (s, wanted) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_709_251_199, "2024-02-29T23:59:59Z"),
            (1_795_328_685, "2026-11-22T06:24:45Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(iso_8601(SystemTime::UNIX_EPOCH + Duration::from_secs(s)), wanted);
        }
    }
}
