//! Result of the adaptation in one line: cycle time, governed moves, and how many of them run slower or faster.

use std::collections::BTreeMap;

use super::block_pairs::BlockPlace;
use super::listing::ProgramListing;
use super::move_log::{LoggedMove, MoveLog};
use crate::report::figures::RunReport;

/// Relative difference of two largest feeds that counts as none. Feeds are sampled each millisecond, so that a ramp is cut off at another
/// place in each run.
const SAME_RATIO: f64 = 5e-3;

/// Governed blocks of the original program, and how many of them the adapted run executes slower or faster, by the largest
/// executed feed of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FeedChanges {
    /// Governed blocks that both runs have executed.
    pub governed: usize,
    /// Those with a lower feed.
    pub slowed: usize,
    /// Those with a higher feed.
    pub raised: usize,
}

impl FeedChanges {
    /// Changes between the log of a run and that of the original program.
    pub fn new([after, before]: [&MoveLog; 2], listing: &ProgramListing) -> Self {
        let pairs = listing.pairs();
        let [after, before] = [largest(after, |block| pairs.place(block)), largest(before, BlockPlace::Original)];
        let mut found = FeedChanges::default();
        for (place, (_, feed)) in after.iter().filter(|(_, (is_governed, _))| *is_governed) {
            let Some((_, old)) = before.get(place) else { continue };
            found.governed += 1;
            found.slowed += usize::from(*feed < old * (1.0 - SAME_RATIO));
            found.raised += usize::from(*feed > old * (1.0 + SAME_RATIO));
        }
        found
    }

    /// The line, with the cycle times of the report.
    pub fn words(&self, report: &RunReport) -> String {
        let FeedChanges { governed, slowed, raised } = self;
        let times = match (report.baseline_cycle_time_s, report.cycle_time_s) {
            (Some(before), Some(after)) if before > 0.0 => {
                format!(
                    "Cycle time {before:.1} s before, {after:.1} s after ({:+.1} %). ",
                    1e2 * (after / before - 1.0)
                )
            }
            _ => String::new(),
        };
        format!("{times}Governed moves: {governed}, of which {slowed} slowed, {raised} raised.")
    }
}

/// Largest executed feed of each place, and whether a rule governs it.
fn largest(log: &MoveLog, place: impl Fn(u32) -> BlockPlace) -> BTreeMap<BlockPlace, (bool, f64)> {
    let mut found = BTreeMap::new();
    for LoggedMove { block, is_governed, feed_max_mm_per_min, is_rapid, .. } in &log.moves {
        if !is_rapid {
            let (governed, feed) = found.entry(place(*block)).or_insert((false, 0.0_f64));
            (*governed, *feed) = (*governed || *is_governed, feed.max(*feed_max_mm_per_min));
        }
    }
    found
}
