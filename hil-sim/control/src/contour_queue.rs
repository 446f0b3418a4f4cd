//! Cutter compensation (G41, G42) between the reader and the look-ahead: blocks wait here until the corner behind them is
//! known.
//!
//! A block keeps its text, its line and its context, and gets the move of the tool centre. Moves around a corner are
//! blocks of their own in front of it ([`Action::Corner`]). Chamfers and rounded corners are inserted first, so that the
//! tool is offset beside them. A fault of the contour stops the control where the move
//! would begin.

use std::collections::VecDeque;

use arcfeed_compensation::compensator::{CenterMove, CenterMoves, CompensationFault, Compensator};
use arcfeed_compensation::contour::ContourCommand;
use arcfeed_compensation::inside_arc::{PPM, feed_ratio_ppm};
use arcfeed_nc::alarm::Fault;
use arcfeed_nc::series::Series;

use super::action::{Action, MoveContext, ReadBlock};
use super::corner_queue::CornerQueue;
use super::settings::ControlSettings;

/// Blocks under cutter compensation (G41, G42) that wait until the path of the tool centre is known.
#[derive(Debug)]
pub struct ContourQueue {
    corners: CornerQueue,
    compensator: Compensator,
    waiting: VecDeque<ReadBlock>,
    /// Least feed on inside arcs over F, if the control reduces it.
    inside_arc_least_percent: Option<u8>,
}

impl ContourQueue {
    /// Empty queue, with cutter compensation off.
    pub fn new(settings: &ControlSettings) -> Self {
        let compensation = settings.nc.compensation;
        ContourQueue {
            corners: CornerQueue::default(),
            compensator: Compensator::new(compensation),
            waiting: VecDeque::new(),
            inside_arc_least_percent: compensation.inside_arc_least_percent,
        }
    }

    /// Accepts the next block that was read; returns the blocks whose path is known now, in the order of execution.
    pub fn pass(&mut self, block: ReadBlock) -> Vec<ReadBlock> {
        self.corners.pass(block).into_iter().flat_map(|block| self.offset(block)).collect()
    }

    fn offset(&mut self, block: ReadBlock) -> Vec<ReadBlock> {
        let command = ContourCommand {
            stops_reading: block.contour.stops_reading || block.action.stops_reading(),
            ..block.contour
        };
        let result = match &block.action {
            Action::Fault(_) => self.compensator.end_held(),
            Action::Move(segment, _) | Action::Corner(segment) => command.apply(Some(segment), &mut self.compensator),
            _ => command.apply(None, &mut self.compensator),
        };
        match result {
            Err(CompensationFault::Given(fault)) => {
                let mut ready = self.end_contour();
                if !ready.iter().any(is_fault) {
                    ready.push(ReadBlock { action: Action::Fault(fault), ..block });
                }
                self.clear();
                ready
            }
            result => {
                let action = self.beside(block.action, &command);
                self.waiting.push_back(ReadBlock { action, ..block });
                self.release(result)
            }
        }
    }

    /// A return to a reference point that begins beside the contour.
    fn beside(&self, action: Action, command: &ContourCommand) -> Action {
        match action {
            Action::Series(series, stop) => match *series {
                Series::Reference(way) => {
                    let way = way.map(|pose| self.compensator.center(pose, command.plane));
                    Action::Series(Box::new(Series::Reference(way)), stop)
                }
                Series::Drill(_) => Action::Series(series, stop),
            },
            action => action,
        }
    }

    /// Ends the contour because no further block comes; returns the remaining blocks in the order of execution.
    pub fn end(&mut self) -> Vec<ReadBlock> {
        let mut ready: Vec<ReadBlock> = self.corners.end().into_iter().flat_map(|block| self.offset(block)).collect();
        ready.extend(self.end_contour());
        ready
    }

    fn end_contour(&mut self) -> Vec<ReadBlock> {
        let result = self.compensator.end_held();
        self.release(result)
    }

    /// Discards all waiting blocks and switches cutter compensation off.
    pub fn clear(&mut self) {
        self.corners = CornerQueue::default();
        self.waiting.clear();
        self.compensator.reset();
    }

    fn release(&mut self, result: Result<CenterMoves, CompensationFault>) -> Vec<ReadBlock> {
        let mut ready = Vec::new();
        match result {
            Ok(moves) => {
                for center_move in moves {
                    self.release_without_move(&mut ready);
                    self.give(center_move, &mut ready);
                }
                self.release_without_move(&mut ready);
            }
            Err(CompensationFault::Held(fault) | CompensationFault::Given(fault)) => {
                self.release_without_move(&mut ready);
                ready.extend(self.waiting.pop_front().map(|block| with_fault(block, fault)));
                self.clear();
            }
        }
        ready
    }

    /// Releases the blocks before the next move.
    fn release_without_move(&mut self, ready: &mut Vec<ReadBlock>) {
        let has_move = |block: &ReadBlock| matches!(block.action, Action::Move(..) | Action::Corner(_));
        while let Some(block) = self.waiting.pop_front_if(|block| !has_move(block)) {
            ready.push(block);
        }
    }

    /// Gives a move of the tool centre to the first block that waits.
    fn give(&mut self, center_move: CenterMove, ready: &mut Vec<ReadBlock>) {
        let Some(block) = self.waiting.front() else { return };
        let (action, programmed) = match (center_move, &block.action) {
            (CenterMove::Corner(segment), _) => {
                return ready.push(ReadBlock {
                    context: block.context,
                    ..ReadBlock::new(block.line, Vec::new(), Action::Corner(segment))
                });
            }
            (CenterMove::Main(segment), Action::Move(programmed, stop)) => (Action::Move(segment, *stop), programmed),
            (CenterMove::Main(segment), Action::Corner(programmed)) => (Action::Corner(segment), programmed),
            (CenterMove::Main(_), _) => return,
        };
        let CenterMove::Main(center) = center_move else { return };
        let feed_cut_ppm = PPM - feed_ratio_ppm(programmed, &center, self.inside_arc_least_percent);
        let context = MoveContext { feed_cut_ppm, ..block.context };
        ready.extend(self.waiting.pop_front().map(|block| ReadBlock { action, context, ..block }));
    }
}

fn is_fault(block: &ReadBlock) -> bool {
    matches!(block.action, Action::Fault(_))
}

fn with_fault(block: ReadBlock, fault: Fault) -> ReadBlock {
    ReadBlock { action: Action::Fault(fault), ..block }
}

#[cfg(test)]
mod tests;
