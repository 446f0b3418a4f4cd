//! Cutter compensation (G41, G42) between the reader and the look-ahead: blocks wait here until the corner behind them is
//! known.
//!
//! A block keeps its text, its line and its context, and gets the move of the tool centre. Moves around a corner are
//! blocks of their own in front of it ([`Action::Corner`]). A fault of the contour stops the control where the move
//! would begin.

use std::collections::VecDeque;

use arcfeed_compensation::compensator::{CenterMove, CenterMoves, CompensationFault, Compensator};
use arcfeed_compensation::contour::ContourCommand;
use arcfeed_nc::alarm::Fault;

use super::action::{Action, ReadBlock};
use super::settings::ControlSettings;

/// Blocks that wait for the move of the tool centre.
#[derive(Debug)]
pub struct ContourQueue {
    compensator: Compensator,
    waiting: VecDeque<ReadBlock>,
}

impl ContourQueue {
    /// An empty queue, without an offset.
    pub fn new(settings: &ControlSettings) -> Self {
        ContourQueue { compensator: Compensator::new(settings.nc.compensation), waiting: VecDeque::new() }
    }

    /// Accepts the next block; returns the blocks that can be executed.
    pub fn pass(&mut self, block: ReadBlock) -> Vec<ReadBlock> {
        let command = ContourCommand {
            stops_reading: block.contour.stops_reading || block.action.stops_reading(),
            ..block.contour
        };
        let result = match &block.action {
            Action::Fault(_) => self.compensator.end_held(),
            Action::Move(segment, _) => command.apply(Some(segment), &mut self.compensator),
            _ => command.apply(None, &mut self.compensator),
        };
        match result {
            Err(CompensationFault::Given(fault)) => {
                let mut ready = self.end();
                if !ready.iter().any(is_fault) {
                    ready.push(ReadBlock { action: Action::Fault(fault), ..block });
                }
                self.clear();
                ready
            }
            result => {
                self.waiting.push_back(block);
                self.release(result)
            }
        }
    }

    /// Ends the contour where it is: no further block comes.
    pub fn end(&mut self) -> Vec<ReadBlock> {
        let result = self.compensator.end_held();
        self.release(result)
    }

    /// Discards all blocks and the offset.
    pub fn clear(&mut self) {
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
        while let Some(block) = self.waiting.pop_front_if(|block| !matches!(block.action, Action::Move(..))) {
            ready.push(block);
        }
    }

    /// Gives a move of the tool centre to the first block that waits.
    fn give(&mut self, center_move: CenterMove, ready: &mut Vec<ReadBlock>) {
        let Some(block) = self.waiting.front() else { return };
        match (center_move, &block.action) {
            (CenterMove::Corner(segment), _) => ready.push(ReadBlock {
                context: block.context,
                ..ReadBlock::new(block.line, Vec::new(), Action::Corner(segment))
            }),
            (CenterMove::Main(segment), Action::Move(_, stop)) => {
                let action = Action::Move(segment, *stop);
                ready.extend(self.waiting.pop_front().map(|block| ReadBlock { action, ..block }));
            }
            (CenterMove::Main(_), _) => {}
        }
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
