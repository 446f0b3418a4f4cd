//! Chamfers and rounded corners (`,C`, `,R`): a move with one waits for the next move of the contour.
//!
//! The inserted move is a block of its own between both ([`Action::Corner`]), with the feed and the context of the first.
//! A fault of the corner stops the control before the first move: it is not executed without its corner.

use arcfeed_compensation::insertion::InsertedCorner;
use arcfeed_nc::alarm::{Alarm, Fault};
use arcfeed_nc::modal::Corner;
use arcfeed_nc::segment::Segment;

use super::action::{Action, ReadBlock};

/// Move before a chamfer or rounded corner (`,C`, `,R`), which waits for the move behind it, and the blocks without
/// words between them.
#[derive(Debug, Default)]
pub struct CornerQueue {
    waiting: Vec<ReadBlock>,
}

impl CornerQueue {
    /// Accepts the next block that was read; returns the blocks that need not wait (any longer), in the order of execution.
    pub fn pass(&mut self, block: ReadBlock) -> Vec<ReadBlock> {
        let Some((first, corner)) = self.first() else { return self.admit(block) };
        let (line, plane) = (block.line, block.contour.plane);
        match &block.action {
            Action::Nothing | Action::Ignore(_) if !block.contour.has_words => {
                self.waiting.push(block);
                Vec::new()
            }
            Action::Move(second, stop) => match InsertedCorner::new(&first, second, plane, corner) {
                Ok(inserted) => {
                    let mut ready = self.insert(&inserted);
                    let action = Action::Move(inserted.second, *stop);
                    ready.extend(self.admit(ReadBlock { action, ..block }));
                    ready
                }
                Err(alarm) => self.refuse(alarm, (alarm != Alarm::ShortCorner).then_some(line)),
            },
            Action::Fault(_) => {
                self.waiting.clear();
                vec![block]
            }
            _ => self.refuse(Alarm::NoMoveBehindCorner, Some(line)),
        }
    }

    /// Returns the waiting blocks, the move without its corner, because no further block comes.
    pub fn end(&mut self) -> Vec<ReadBlock> {
        if self.waiting.is_empty() { Vec::new() } else { self.refuse(Alarm::NoMoveBehindCorner, None) }
    }

    fn first(&self) -> Option<(Segment, Corner)> {
        let block = self.waiting.first()?;
        match block.action {
            Action::Move(segment, _) => Some((segment, block.contour.corner?)),
            _ => None,
        }
    }

    fn admit(&mut self, block: ReadBlock) -> Vec<ReadBlock> {
        if matches!(block.action, Action::Move(..)) && block.contour.corner.is_some() {
            self.waiting.push(block);
            return Vec::new();
        }
        vec![block]
    }

    fn insert(&mut self, inserted: &InsertedCorner) -> Vec<ReadBlock> {
        let mut ready = std::mem::take(&mut self.waiting);
        let Some(first) = ready.first_mut() else { return ready };
        first.action = Action::Move(inserted.first, None);
        if let Some(segment) = inserted.between {
            let corner = ReadBlock { text: Vec::new(), action: Action::Corner(segment), ..first.clone() };
            ready.insert(1, corner);
        }
        ready
    }

    /// The first move with an alarm in its place, at its line or another.
    fn refuse(&mut self, alarm: Alarm, line: Option<u32>) -> Vec<ReadBlock> {
        let first = std::mem::take(&mut self.waiting).into_iter().next();
        let refused = |block: ReadBlock| ReadBlock {
            action: Action::Fault(Fault::alarm(alarm, 0)),
            line: line.unwrap_or(block.line),
            ..block
        };
        first.map(refused).into_iter().collect()
    }
}
