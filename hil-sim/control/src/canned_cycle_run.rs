//! Execution of a block that makes several moves: canned cycles, G28, G30.
//!
//! Each move ends at rest. In single block the control stops at the position of the hole, at the level where rapid
//! changes to feed, and after each hole; for G28 and G30 at the intermediate point. A tap in its hole ignores override
//! and feed hold until it is out.

use arcfeed_nc::modal::{MotionKind, Pose};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_nc::series::{Series, SeriesAction, SeriesCursor, Stage};
use arcfeed_units::Micros;

use super::Control;
use super::action::{MoveContext, WorkpiecePlace};
use super::panel::Phase;
use super::plain::along_z;

/// Execution of one block that makes several moves, such as a canned cycle, step by step.
#[derive(Debug)]
pub struct CannedCycleRun {
    series: Box<Series>,
    cursor: SeriesCursor,
    context: MoveContext,
    sequence: Option<i64>,
    /// Hole and stage of the last step returned; a stop in single block before the next step counts as returned.
    given: Option<(u32, Stage)>,
    taps: bool,
}

/// Next step of a canned cycle or another block with several moves.
#[derive(Clone, Debug, PartialEq)]
pub enum RunStep {
    /// Move in machine coordinates.
    Move(Box<Segment>, MoveContext),
    /// Dwell of this time.
    Dwell(Micros),
    /// Stop that waits for cycle start, because single block is on.
    Halt,
}

impl CannedCycleRun {
    /// Execution at the beginning of its block; `sequence` is the block's N, if it has one.
    pub fn new(series: Box<Series>, context: MoveContext, sequence: Option<i64>) -> Self {
        let cursor = series.begin();
        CannedCycleRun {
            series,
            cursor,
            context: MoveContext { is_special: true, ..context },
            sequence,
            given: None,
            taps: false,
        }
    }

    /// Whether a tap is in its hole.
    pub fn is_tapping(&self) -> bool {
        self.taps || self.context.is_tapping
    }

    /// Next step of the execution; `position` is the present position of the axes. `None` after the last step.
    pub fn advance(&mut self, position: &Pose, in_single_block: bool) -> Option<RunStep> {
        loop {
            let mut ahead = self.cursor.clone();
            let act = self.series.advance(&mut ahead);
            let stage = ahead.stage();
            if in_single_block && act.is_some() && self.given.is_some_and(|given| given != stage) {
                self.given = Some(stage);
                self.taps = false;
                return Some(RunStep::Halt);
            }
            (self.cursor, self.given) = (ahead, Some(stage));
            match act {
                Some(SeriesAction::Spindle(_)) => {}
                Some(SeriesAction::Dwell(span)) => return Some(RunStep::Dwell(span)),
                Some(SeriesAction::Move(motion)) => {
                    let is_cut = motion.kind == MotionKind::Line;
                    let mut end = motion.end.plus(along_z(self.context.tool));
                    if let (Series::Drill(drill), (_, Stage::Positioning)) = (&*self.series, stage) {
                        // A tool length that begins in this block counts from the approach on.
                        let (.., normal) = drill.plane.axes();
                        end.linear[normal] = position.linear[normal];
                    }
                    self.taps =
                        is_cut && matches!(&*self.series, Series::Drill(drill) if matches!(drill.code, 74 | 84));
                    let path = if is_cut { Path::Line } else { Path::Rapid };
                    let segment = Segment { sequence: self.sequence, start: *position, end, feed: motion.feed, path };
                    let place = match (&*self.series, self.context.place) {
                        (Series::Reference([_, between, _]), WorkpiecePlace::ToIntermediate)
                            if motion.end == *between =>
                        {
                            WorkpiecePlace::Known
                        }
                        (_, WorkpiecePlace::Known) => WorkpiecePlace::Known,
                        _ => WorkpiecePlace::Unknown,
                    };
                    let context = MoveContext { is_tapping: self.is_tapping(), place, ..self.context };
                    return Some(RunStep::Move(Box::new(segment), context));
                }
                None => return None,
            }
        }
    }
}

impl Control {
    /// Executes the next step of the block in execution.
    pub(super) fn continue_cycle_run(&mut self, now: Micros) {
        let position = self.interpolator.position();
        let in_single_block = self.is_in_single_block();
        let Some(cycle_run) = &mut self.cycle_run else { return };
        match cycle_run.advance(&position, in_single_block) {
            Some(RunStep::Move(segment, context)) => self.interpolator.begin(*segment, context, self.blocks_begun),
            Some(RunStep::Dwell(span)) => self.dwell_left = span,
            Some(RunStep::Halt) => self.phase = Phase::Stopped { since: now },
            None => self.cycle_run = None,
        }
    }
}

#[cfg(test)]
mod tests;
