//! Whether the segment in work has been in sight without a gap since it began.
//!
//! The way along an arc is unambiguous only from its start. A law therefore takes up a segment at its beginning and
//! loses it with the samples: after a loss the next beginning is the resynchronisation.

use super::input::Quality;

/// The segment in work as far as it was seen; state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sight {
    /// Nothing seen since power-on.
    #[default]
    Unknown,
    /// Nothing is in work.
    Nothing,
    /// In work, but how it got to where it is was not seen.
    Unseen(u32),
    /// It began; the first fresh sample on it has yet to come.
    Awaited(u32),
    /// In sight since its beginning.
    Followed(u32),
}

/// What changed at a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Nothing.
    Same,
    /// The segment ended or another came, but a law cannot take it up.
    Boundary,
    /// A new segment with a fresh sample.
    Begins,
    /// The first fresh sample on a segment that began before: its boundary is over.
    BeginsLate,
}

impl Change {
    /// Whether a law can take up the segment now.
    pub fn is_begin(self) -> bool {
        matches!(self, Change::Begins | Change::BeginsLate)
    }
}

impl Sight {
    /// Takes the count of the segment in work.
    #[inline(always)]
    pub fn look(&mut self, count: u32, quality: Quality) -> Change {
        let before = *self;
        *self = match (before, quality) {
            (_, Quality::Lost) | (Sight::Unknown, _) => Sight::Unseen(count),
            (Sight::Unseen(same) | Sight::Followed(same), _) if same == count => return Change::Same,
            (_, Quality::Fresh) => Sight::Followed(count),
            (_, Quality::Stale) => Sight::Awaited(count),
        };
        match (self.is_followed(), before.count() != Some(count)) {
            (true, true) => Change::Begins,
            (true, false) => Change::BeginsLate,
            (false, true) => Change::Boundary,
            (false, false) => Change::Same,
        }
    }

    /// Nothing is in work.
    #[inline(always)]
    pub fn lose(&mut self) -> Change {
        let before = core::mem::replace(self, Sight::Nothing);
        if before.count().is_some() { Change::Boundary } else { Change::Same }
    }

    /// Whether a law may act on the segment in work.
    pub fn is_followed(self) -> bool {
        matches!(self, Sight::Followed(_))
    }

    fn count(self) -> Option<u32> {
        match self {
            Sight::Unknown | Sight::Nothing => None,
            Sight::Unseen(count) | Sight::Awaited(count) | Sight::Followed(count) => Some(count),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looks(steps: &[(Option<u32>, Quality)]) -> (Sight, Change) {
        let mut sight = Sight::default();
        let mut change = Change::Same;
        for (in_work, quality) in steps {
            change = match in_work {
                Some(count) => sight.look(*count, *quality),
                None => sight.lose(),
            };
        }
        (sight, change)
    }

    #[test]
    fn a_segment_already_in_work_at_power_on_is_not_followed() {
        assert_eq!(looks(&[(Some(7), Quality::Fresh)]), (Sight::Unseen(7), Change::Boundary));
        assert_eq!(looks(&[(Some(7), Quality::Fresh); 2]), (Sight::Unseen(7), Change::Same));
        assert_eq!(
            looks(&[(Some(7), Quality::Fresh), (Some(8), Quality::Fresh)]),
            (Sight::Followed(8), Change::Begins)
        );
        assert_eq!(looks(&[(None, Quality::Fresh), (Some(1), Quality::Fresh)]), (Sight::Followed(1), Change::Begins));
    }

    #[test]
    fn a_beginning_without_a_fresh_sample_waits_for_one() {
        let begun = [(None, Quality::Fresh), (Some(1), Quality::Stale)];
        assert_eq!(looks(&begun), (Sight::Awaited(1), Change::Boundary));
        assert_eq!(looks(&[begun[0], begun[1], (Some(1), Quality::Fresh)]), (Sight::Followed(1), Change::BeginsLate));
    }

    #[test]
    fn a_loss_takes_the_segment_out_of_sight_until_the_next_begins() {
        let lost = [(None, Quality::Fresh), (Some(1), Quality::Fresh), (Some(1), Quality::Lost)];
        assert_eq!(looks(&lost).0, Sight::Unseen(1));
        let mut steps = lost.to_vec();
        steps.push((Some(1), Quality::Fresh));
        assert_eq!(looks(&steps), (Sight::Unseen(1), Change::Same));
        steps.push((Some(2), Quality::Fresh));
        assert_eq!(looks(&steps), (Sight::Followed(2), Change::Begins));
    }
}
