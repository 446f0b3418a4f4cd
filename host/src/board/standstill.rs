//! Whether the board still sees the moves that the control makes.
//!
//! A board finds the end of a move from the position. Where the position was lost for so long that an end went by unseen, it waits for
//! that end: 100 %, and its count of moves done stands still while the control goes on (docs/board-safety.md). Nothing else tells.

use arcfeed_shared::units::Micros;

/// How long a board may be behind the control: reports come every 50 ms, and some get lost.
pub const TIMEOUT: Micros = Micros::from_ms(3_000);

/// The board's count and the control's; state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Standstill {
    /// Moves done, as the board saw it.
    done: usize,
    /// Since when the control is further.
    since: Option<Micros>,
    is_told: bool,
}

impl Standstill {
    /// Compares how many moves the board has seen done with how many the control has done at least. True once for each standstill.
    pub fn look(&mut self, now: Micros, done: usize, by_control: usize) -> bool {
        if done != self.done || by_control <= done {
            *self = Standstill { done, ..Standstill::default() };
        }
        if by_control <= done || self.is_told {
            return false;
        }
        self.is_told = now.since(*self.since.get_or_insert(now)) >= TIMEOUT;
        self.is_told
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What it says every half second: of moves seen by the board, and done by the control.
    fn told(seen: &[(usize, usize)]) -> Vec<usize> {
        let mut standstill = Standstill::default();
        let mut look = |at: usize, (done, by_control): (usize, usize)| {
            standstill.look(Micros::from_ms(500 * at as u64), done, by_control)
        };
        seen.iter().enumerate().filter(|(at, seen)| look(*at, **seen)).map(|(at, _)| at).collect()
    }

    #[test]
    fn a_board_that_keeps_up_or_lags_for_a_moment_is_fine() {
        assert!(told(&[(0, 0); 100]).is_empty());
        let lagging: Vec<_> = (0..100).map(|at| (at / 6, at / 6 + 1)).collect();
        assert!(told(&lagging).is_empty());
        let waiting: Vec<_> = (0..100).map(|at| (7, 7 + usize::from(at % 6 != 0))).collect();
        assert!(told(&waiting).is_empty(), "it caught up each time");
    }

    #[test]
    fn a_count_that_stands_still_is_told_once_and_again_when_it_stood_still_anew() {
        let stands = [(3, 4); 20];
        assert_eq!(told(&stands), [6]);
        assert_eq!(told(&[&stands[..], &[(4, 4)], &[(4, 9); 20]].concat()), [6, 27]);
        // The control may be further and further.
        let ever_further: Vec<_> = (0..20).map(|at| (3, 3 + at)).collect();
        assert_eq!(told(&ever_further), [7]);
    }
}
