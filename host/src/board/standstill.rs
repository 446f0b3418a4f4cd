//! Detection of a board that no longer sees the moves that the control executes.
//!
//! A board finds the end of a move from the position. If it loses the position for so long that it misses an end, it
//! waits for that end: 100 %, and its count of moves done stands still while the control continues
//! (docs/board-safety.md). No other signal shows this.

use arcfeed_units::Micros;

/// Time for which a board may be behind the control before that counts as a standstill: reports come every 50 ms, and
/// some are lost.
pub const TIMEOUT: Micros = Micros::from_ms(3_000);

/// Detector of a board that no longer sees the moves of the control. Keeps its state between calls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Standstill {
    /// Moves done, as the board saw it.
    done: usize,
    /// Time since which the control has been ahead.
    since: Option<Micros>,
    is_reported: bool,
}

impl Standstill {
    /// Compares `done`, the number of moves whose end the board has seen, with `by_control`, the number that the
    /// control has certainly executed. Returns true once for each standstill.
    pub fn check(&mut self, now: Micros, done: usize, by_control: usize) -> bool {
        if done != self.done || by_control <= done {
            *self = Standstill { done, ..Standstill::default() };
        }
        if by_control <= done || self.is_reported {
            return false;
        }
        self.is_reported = now.since(*self.since.get_or_insert(now)) >= TIMEOUT;
        self.is_reported
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Indices of the half-second steps at which a standstill is reported; of moves seen by the board, and done by the
    /// control.
    fn reported(seen: &[(usize, usize)]) -> Vec<usize> {
        let mut standstill = Standstill::default();
        let mut check = |at: usize, (done, by_control): (usize, usize)| {
            standstill.check(Micros::from_ms(500 * at as u64), done, by_control)
        };
        seen.iter().enumerate().filter(|(at, seen)| check(*at, **seen)).map(|(at, _)| at).collect()
    }

    #[test]
    fn a_board_that_keeps_up_or_lags_for_a_moment_is_fine() {
        assert!(reported(&[(0, 0); 100]).is_empty());
        let lagging: Vec<_> = (0..100).map(|at| (at / 6, at / 6 + 1)).collect();
        assert!(reported(&lagging).is_empty());
        let waiting: Vec<_> = (0..100).map(|at| (7, 7 + usize::from(at % 6 != 0))).collect();
        assert!(reported(&waiting).is_empty(), "it caught up each time");
    }

    #[test]
    fn standstill_is_reported_once_for_each_time() {
        let stands = [(3, 4); 20];
        assert_eq!(reported(&stands), [6]);
        assert_eq!(reported(&[&stands[..], &[(4, 4)], &[(4, 9); 20]].concat()), [6, 27]);
        // The control may get further ahead all the time.
        let ever_further: Vec<_> = (0..20).map(|at| (3, 3 + at)).collect();
        assert_eq!(reported(&ever_further), [7]);
    }
}
