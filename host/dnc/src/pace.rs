//! Times at which characters may go out: when the control sends DC3, no more characters may be on their way than it
//! still accepts.
//!
//! Handed out at h, character i has arrived at the control at `a_i = max(a_(i-1), h_i) + c`, c being the time of a
//! character. A sender that stops at most r after the last bit of a DC3 keeps within w characters if
//!
//! ```text
//! h_i >= a_(i-w) + r                                                          (1)
//! ```
//! as then character i-w has arrived before the DC3. A full line needs `r <= (w - 1) c`; with a slower reaction the
//! line is used for w characters in every r + c. Besides, no character is handed out more than [`Pace::ahead`]
//! characters before its turn, so that a reaction time set too short does no harm as long as the real one is short.

use arcfeed_units::{Micros, US_PER_MS, US_PER_S};

/// Number of characters that a control still accepts after it has sent DC3 (B-63503EN p. 62).
pub const AFTER_DC3_MAX: usize = 10;
/// Least characters handed out ahead of the line.
const AHEAD_MIN: u64 = 4;
/// Longest delay in waking the sender that leaves the line busy.
const LATE: Micros = Micros(US_PER_MS);
const NS_PER_US: u64 = 1_000;

/// Pacing of a serial line: limits how far the sender runs ahead, so that at most ten characters arrive after a DC3. It
/// keeps the arrival times of the last ten characters.
#[derive(Clone, Debug)]
pub struct Pace {
    char_ns: u64,
    reaction_ns: u64,
    ahead: usize,
    /// Arrival time of each of the last characters, the oldest first.
    arrivals: [u64; AFTER_DC3_MAX],
}

impl Pace {
    /// Pace of a line with this rate, in bits per second. `reaction` is the longest time from the arrival of a DC3
    /// until the sender stops; `None` for a line without XON/XOFF.
    pub fn new(bits_per_char: u32, baudrate: u32, reaction: Option<Micros>) -> Self {
        let char_ns = (u64::from(bits_per_char) * US_PER_S * NS_PER_US).div_ceil(u64::from(baudrate).max(1));
        let late = (LATE.0 * NS_PER_US).div_ceil(char_ns) + 1;
        Pace {
            char_ns,
            reaction_ns: reaction.map_or(0, |reaction| reaction.0 * NS_PER_US),
            ahead: late.clamp(AHEAD_MIN, AFTER_DC3_MAX as u64) as usize,
            arrivals: [0; AFTER_DC3_MAX],
        }
    }

    /// Number of characters that may be handed to the line at the time `now`, at most ten.
    pub fn room(&self, now: Micros) -> usize {
        let now = now.0.saturating_mul(NS_PER_US);
        let by_reaction = self.arrivals.iter().take_while(|arrival| **arrival + self.reaction_ns <= now).count();
        let behind = &self.arrivals[AFTER_DC3_MAX - self.ahead..];
        let by_line = behind.iter().take_while(|arrival| **arrival <= now).count();
        by_reaction.min(by_line)
    }

    /// Records that `len` characters are handed to the line at the time `now`.
    pub fn take(&mut self, now: Micros, len: usize) {
        for _ in 0..len {
            let [.., last] = self.arrivals;
            self.arrivals.rotate_left(1);
            self.arrivals[AFTER_DC3_MAX - 1] = last.max(now.0.saturating_mul(NS_PER_US)) + self.char_ns;
        }
    }

    /// Earliest time at which the next character may be handed to the line.
    pub fn free_at(&self) -> Micros {
        let by_reaction = self.arrivals[0] + self.reaction_ns;
        Micros(by_reaction.max(self.arrivals[AFTER_DC3_MAX - self.ahead]).div_ceil(NS_PER_US))
    }

    /// Latest time at which the last character handed out has arrived at the control.
    pub fn empty_at(&self) -> Micros {
        let [.., last] = self.arrivals;
        Micros((last + self.reaction_ns).div_ceil(NS_PER_US))
    }

    /// Largest number of characters that may be handed out before the line can have transmitted them, from 4 to 10.
    pub fn ahead(&self) -> usize {
        self.ahead
    }

    /// Fraction of the line's rate that the pace permits, at most 1: `w c / (r + c)`, with w = 10 characters, the time
    /// c of a character and the reaction time r.
    pub fn share(&self) -> f64 {
        let window = AFTER_DC3_MAX as f64 * self.char_ns as f64;
        (window / (self.reaction_ns + self.char_ns) as f64).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hands out all it may in steps of 10 us; returns the times at which characters went out and arrived.
    fn run(mut pace: Pace, char_us: f64, for_us: u64) -> Vec<(f64, f64)> {
        let mut times: Vec<(f64, f64)> = Vec::new();
        for us in (0..for_us).step_by(10) {
            let room = pace.room(Micros(us));
            pace.take(Micros(us), room);
            for _ in 0..room {
                let before = times.last().map_or(0.0, |(_, arrival)| *arrival);
                times.push((us as f64, before.max(us as f64) + char_us));
            }
        }
        times
    }

    /// Most characters that arrive after a DC3 which takes effect `reaction` later, wherever it falls.
    fn worst(times: &[(f64, f64)], reaction: f64) -> usize {
        let dc3s = times.iter().map(|(handed, _)| handed - reaction);
        dc3s.map(|dc3| times.iter().filter(|(out, arrival)| *out <= dc3 + reaction && *arrival > dc3).count())
            .max()
            .unwrap_or(0)
    }

    #[test]
    fn never_more_than_ten_are_to_come_whatever_the_rate_and_the_reaction() {
        for baudrate in [4_800, 9_600, 19_200, 38_400, 115_200] {
            for reaction in [0, 200, 1_000, 4_000, 16_000] {
                let char_us = 11.0 * 1e6 / f64::from(baudrate);
                let pace = Pace::new(11, baudrate, Some(Micros(reaction)));
                let share = pace.share();
                let times = run(pace, char_us, 400_000);
                let most = worst(&times, reaction as f64);
                assert!(most <= AFTER_DC3_MAX, "{baudrate} baud, {reaction} us: {most}");
                let used = times.len() as f64 * char_us / 400_000.0;
                assert!(
                    (used - share).abs() < 0.04,
                    "{baudrate} baud, {reaction} us: {used} of the line, promised {share}"
                );
            }
        }
    }

    #[test]
    fn a_line_that_reacts_in_time_is_full() {
        assert_eq!(Pace::new(11, 9_600, Some(Micros(10_000))).share(), 1.0);
        // 168 characters of 115 200 baud last 16 ms.
        let share = Pace::new(11, 115_200, Some(Micros(16_000))).share();
        assert!((share - 10.0 / 168.6).abs() < 1e-3, "{share}");
    }

    #[test]
    fn it_is_never_ahead_of_the_line_by_more_than_it_says() {
        let pace = Pace::new(11, 9_600, None);
        let ahead = pace.ahead();
        let char_us = 11.0 * 1e6 / 9_600.0;
        for (count, (out, _)) in run(pace, char_us, 1_000_000).iter().enumerate() {
            assert!((count + 1) as f64 <= out / char_us + ahead as f64 + 1e-9, "{count} at {out} us");
        }
        assert_eq!(ahead, 4);
    }
}
