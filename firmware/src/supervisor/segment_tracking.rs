//! Tracking of the segment (move) in execution: whether it was followed without a gap since its beginning.
//!
//! The progress along an arc is unambiguous only from its start. Therefore a law starts on a segment at its beginning
//! and stops at a loss of samples; after a loss it resynchronises at the beginning of the next segment.

use super::input::Quality;

/// Whether the segment in execution was followed from its beginning, so that the tool's progress on it is known. The
/// number is that of the segment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SegmentTracking {
    /// Nothing is known yet: no tick since power-on.
    #[default]
    Unknown,
    /// No segment is in execution.
    Nothing,
    /// A segment is in execution, but its beginning was missed, so no law acts on it.
    Unseen(u32),
    /// A segment has begun, but there was no recent position since: a law can still start on it.
    Awaited(u32),
    /// The segment was followed from its beginning: a law may act on it.
    Followed(u32),
}

/// Change of the segment in execution at a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// The same segment as before, or none as before.
    Same,
    /// A segment has ended or begun, but no law can start now.
    Boundary,
    /// A segment has begun, and its position is recent: a law can start.
    Begins,
    /// The segment began earlier, and its first recent position has arrived now: a law can start.
    BeginsLate,
}

impl Change {
    /// Whether a law can start on the segment now.
    pub fn is_begin(self) -> bool {
        matches!(self, Change::Begins | Change::BeginsLate)
    }
}

impl SegmentTracking {
    /// Processes a tick at which the segment with the number `count` is in execution.
    #[inline(always)]
    pub fn update(&mut self, count: u32, quality: Quality) -> Change {
        let before = *self;
        *self = match (before, quality) {
            (_, Quality::Lost) | (SegmentTracking::Unknown, _) => SegmentTracking::Unseen(count),
            (SegmentTracking::Unseen(same) | SegmentTracking::Followed(same), _) if same == count => {
                return Change::Same;
            }
            (_, Quality::Fresh) => SegmentTracking::Followed(count),
            (_, Quality::Stale) => SegmentTracking::Awaited(count),
        };
        match (self.is_followed(), before.count() != Some(count)) {
            (true, true) => Change::Begins,
            (true, false) => Change::BeginsLate,
            (false, true) => Change::Boundary,
            (false, false) => Change::Same,
        }
    }

    /// Processes a tick at which no segment is in execution.
    #[inline(always)]
    pub fn clear(&mut self) -> Change {
        let before = core::mem::replace(self, SegmentTracking::Nothing);
        if before.count().is_some() { Change::Boundary } else { Change::Same }
    }

    /// Whether the segment in execution was followed from its beginning, so that a law may act on it.
    pub fn is_followed(self) -> bool {
        matches!(self, SegmentTracking::Followed(_))
    }

    fn count(self) -> Option<u32> {
        match self {
            SegmentTracking::Unknown | SegmentTracking::Nothing => None,
            SegmentTracking::Unseen(count) | SegmentTracking::Awaited(count) | SegmentTracking::Followed(count) => {
                Some(count)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looks(steps: &[(Option<u32>, Quality)]) -> (SegmentTracking, Change) {
        let mut sight = SegmentTracking::default();
        let mut change = Change::Same;
        for (in_work, quality) in steps {
            change = match in_work {
                Some(count) => sight.update(*count, *quality),
                None => sight.clear(),
            };
        }
        (sight, change)
    }

    #[test]
    fn a_segment_already_in_work_at_power_on_is_not_followed() {
        assert_eq!(looks(&[(Some(7), Quality::Fresh)]), (SegmentTracking::Unseen(7), Change::Boundary));
        assert_eq!(looks(&[(Some(7), Quality::Fresh); 2]), (SegmentTracking::Unseen(7), Change::Same));
        assert_eq!(
            looks(&[(Some(7), Quality::Fresh), (Some(8), Quality::Fresh)]),
            (SegmentTracking::Followed(8), Change::Begins)
        );
        assert_eq!(
            looks(&[(None, Quality::Fresh), (Some(1), Quality::Fresh)]),
            (SegmentTracking::Followed(1), Change::Begins)
        );
    }

    #[test]
    fn a_beginning_without_a_fresh_sample_waits_for_one() {
        let begun = [(None, Quality::Fresh), (Some(1), Quality::Stale)];
        assert_eq!(looks(&begun), (SegmentTracking::Awaited(1), Change::Boundary));
        assert_eq!(
            looks(&[begun[0], begun[1], (Some(1), Quality::Fresh)]),
            (SegmentTracking::Followed(1), Change::BeginsLate)
        );
    }

    #[test]
    fn a_loss_takes_the_segment_out_of_sight_until_the_next_begins() {
        let lost = [(None, Quality::Fresh), (Some(1), Quality::Fresh), (Some(1), Quality::Lost)];
        assert_eq!(looks(&lost).0, SegmentTracking::Unseen(1));
        let mut steps = lost.to_vec();
        steps.push((Some(1), Quality::Fresh));
        assert_eq!(looks(&steps), (SegmentTracking::Unseen(1), Change::Same));
        steps.push((Some(2), Quality::Fresh));
        assert_eq!(looks(&steps), (SegmentTracking::Followed(2), Change::Begins));
    }
}
