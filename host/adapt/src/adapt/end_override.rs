//! Largest override allowed at the end of each move, so that the override can be low enough when the next move begins.

use arcfeed_firmware::active::{ActiveSegment, Conditions};
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_model::job::Job;
use arcfeed_model::machine::FeedLimit;
use arcfeed_nc::modal::Feed;
use arcfeed_nc::segment::Segment;

use super::planned_block::PlannedBlock;
use crate::program::ProgramLine;

/// Lines of a program as far as they limit the override at the end of a move.
#[derive(Debug, Default)]
pub struct OverrideEnds {
    lines: Vec<LineEffect>,
}

#[derive(Clone, Copy, Debug)]
struct LineEffect {
    /// A block-delete switch may skip the line, and other moves follow then.
    may_be_skipped: bool,
    /// The line has moves of more than one segment, or no meaning.
    has_other_moves: bool,
}

impl OverrideEnds {
    /// Adds the next line of the program.
    pub fn add(&mut self, line: &ProgramLine) {
        let may_be_skipped = line.skipping.as_ref().is_some_and(|skipping| !skipping.is_harmless);
        let has_other_moves = line.meaning.as_ref().is_none_or(|meaning| meaning.step.series.is_some());
        self.lines.push(LineEffect { may_be_skipped, has_other_moves });
    }

    /// Sets the largest override at the end of each block: the one with which the next move can begin. Before the moves of
    /// canned cycles and at the end of the program it is at most 100 %.
    pub fn set(&self, blocks: &mut [PlannedBlock], job: &Job) {
        let programmed = FeedOverride::PROGRAMMED.percent;
        let mut behind: Option<(usize, u8)> = None;
        for block in blocks.iter_mut().rev() {
            let is_next = |(line, _): &(usize, u8)| !self.has_other_moves(block.line, *line);
            block.end_percent = behind.filter(is_next).map_or(programmed, |(_, percent)| percent);
            let begins = begin_percent(block, job);
            // If a block-delete switch skips the block, the next block comes first.
            let percent = if self.may_be_skipped(block.line) { begins.min(block.end_percent) } else { begins };
            behind = Some((block.line, percent));
        }
    }

    fn may_be_skipped(&self, line: usize) -> bool {
        line.checked_sub(1).and_then(|index| self.lines.get(index)).is_some_and(|line| line.may_be_skipped)
    }

    /// Whether there are moves of more than one segment between two lines, counted from 1.
    fn has_other_moves(&self, line: usize, next: usize) -> bool {
        let between = self.lines.get(line..next.saturating_sub(1)).unwrap_or_default();
        between.iter().any(|line| line.has_other_moves)
    }
}

/// The largest override with which a block can begin, %; without a law that is 100 % at most.
fn begin_percent(block: &PlannedBlock, job: &Job) -> u8 {
    let rule = block.rule.filter(|_| block.demand.is_some()).and_then(|index| job.rules.get(index));
    let segment = Segment { feed: block.sent.map_or(block.segment.feed, Feed::PerMinute), ..block.segment };
    let own = Conditions::with_table(&segment, (rule, block.along.as_deref()), job);
    let conditions = Conditions {
        spindle: block.spindle.unwrap_or(own.spindle),
        limit: block.limit.map(FeedLimit::from).or(own.limit),
        end_percent: block.end_percent,
        ..own
    };
    let begins = ActiveSegment::with_conditions(&segment, &conditions, job).begin_percent();
    let most = if conditions.is_governed() { u8::MAX } else { FeedOverride::PROGRAMMED.percent };
    begins.min(most).max(job.limits.min_percent)
}
