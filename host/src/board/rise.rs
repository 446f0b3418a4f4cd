//! Detects from a board's reports when its override has finished rising after arming.

use arcfeed_model::job::OverrideLimits;
use arcfeed_units::{Micros, US_PER_S};

/// Override at which a program may begin whatever follows, %.
const PROGRAMMED_PERCENT: u8 = 100;
/// Longest time between two reports that a board's settings allow.
const REPORT_MAX: Micros = Micros::from_ms(1_000);

/// Observer of the reported override while it rises after arming.
#[derive(Clone, Copy, Debug)]
pub struct Rise {
    /// Time in which a rising override changes by two steps.
    two_steps: Micros,
    /// Last value, and the time since which it has been the same.
    last: Option<(u8, Micros)>,
}

impl Rise {
    /// State before the first report, for a board with these limits.
    pub fn new(limits: &OverrideLimits) -> Self {
        let step_s = f64::from(limits.step_percent) / f64::from(limits.slew_up_percent_per_s);
        Rise { two_steps: Micros((2.0 * step_s * US_PER_S as f64) as u64), last: None }
    }

    /// Processes the override of a report that arrived at the time `now`.
    pub fn add(&mut self, now: Micros, percent: u8) {
        if self.last.is_none_or(|(last, _)| last != percent) {
            self.last = Some((percent, now));
        }
    }

    /// Whether the override has stopped rising: it is at least 100 %, or has not changed for the time of two steps,
    /// because the operator's dial or the next move limits it.
    pub fn has_ended(&self, now: Micros) -> bool {
        let is_still = |since: Micros| now.since(since) > self.two_steps.after(REPORT_MAX);
        self.last.is_some_and(|(percent, since)| percent >= PROGRAMMED_PERCENT || is_still(since))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rise() -> Rise {
        Rise::new(&OverrideLimits { step_percent: 1, slew_up_percent_per_s: 50.0, ..OverrideLimits::default() })
    }

    #[test]
    fn it_ends_at_the_programmed_feed_or_where_the_override_stays() {
        let mut rise = rise();
        assert!(!rise.has_ended(Micros::from_ms(5_000)), "no report");
        for ms in 0..40 {
            rise.add(Micros::from_ms(50 * ms), (2 * ms) as u8);
            assert!(!rise.has_ended(Micros::from_ms(50 * ms)), "{ms}");
        }
        rise.add(Micros::from_ms(2_000), 80);
        assert!(!rise.has_ended(Micros::from_ms(3_000)));
        assert!(rise.has_ended(Micros::from_ms(3_050)), "the dial is at 80 %");
        rise.add(Micros::from_ms(3_050), 100);
        assert!(rise.has_ended(Micros::from_ms(3_050)));
    }
}
