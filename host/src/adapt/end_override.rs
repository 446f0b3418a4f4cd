//! Largest override allowed at the end of each move, so that the override can be low enough when the next move begins.

use arcfeed_firmware::active::{ActiveSegment, Conditions};
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_model::job::Job;
use arcfeed_model::machine::FeedLimit;
use arcfeed_nc::modal::Feed;
use arcfeed_nc::segment::Segment;

use super::planned_block::PlannedBlock;
use crate::program::Program;

/// Sets the largest override at the end of each block: the one with which the next move can begin. Before the moves of
/// canned cycles and at the end of the program it is at most 100 %.
pub fn set_ends(blocks: &mut [PlannedBlock], program: &Program, job: &Job) {
    let programmed = FeedOverride::PROGRAMMED.percent;
    let mut behind: Option<(usize, u8)> = None;
    for block in blocks.iter_mut().rev() {
        let is_next = |(line, _): &(usize, u8)| !has_other_moves(program, block.line, *line);
        block.end_percent = behind.filter(is_next).map_or(programmed, |(_, percent)| percent);
        let begins = begin_percent(block, job);
        // If a block-delete switch skips the block, the next block comes first.
        let percent = if may_be_skipped(program, block.line) { begins.min(block.end_percent) } else { begins };
        behind = Some((block.line, percent));
    }
}

fn may_be_skipped(program: &Program, line: usize) -> bool {
    let of = line.checked_sub(1).and_then(|index| program.lines.get(index));
    of.and_then(|line| line.skipping.as_ref()).is_some_and(|skipping| !skipping.is_harmless)
}

/// Whether there are moves of more than one segment between two lines, counted from 1.
fn has_other_moves(program: &Program, line: usize, next: usize) -> bool {
    let between = program.lines.get(line..next.saturating_sub(1)).unwrap_or_default();
    between.iter().any(|line| line.meaning.as_ref().is_none_or(|meaning| meaning.step.series.is_some()))
}

/// The largest override with which a block can begin, %; without a law that is 100 % at most.
fn begin_percent(block: &PlannedBlock, job: &Job) -> u8 {
    let rule = block.rule.filter(|_| block.demand.is_some()).and_then(|index| job.rules.get(index));
    let segment = Segment { feed: block.sent.map_or(block.segment.feed, Feed::PerMinute), ..block.segment };
    let own = Conditions::of(&segment, rule, job);
    let conditions = Conditions {
        along: block.along.as_ref(),
        spindle: block.spindle.unwrap_or(own.spindle),
        limit: block.limit.map(FeedLimit::from).or(own.limit),
        end_percent: block.end_percent,
        ..own
    };
    let begins = ActiveSegment::with_conditions(&segment, &conditions, job).begin_percent();
    let most = if rule.is_some() { u8::MAX } else { FeedOverride::PROGRAMMED.percent };
    begins.min(most).max(job.limits.min_percent)
}
