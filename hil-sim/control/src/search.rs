//! Sequence number search and program restart: starting a program in its middle.
//!
//! A *search* skips everything before the block: the modal state stays as it was. A *restart* reads everything before
//! the block, so that the block has the modal state of a run from the beginning, and moves the axes to the end of the
//! block before it: rotary axes first, then one linear axis after the other, at the dry run feed. A missing number is
//! alarm PS0060.
//!
//! Source: the steps of program restart in Fanuc's operator's manuals; the order of the axes is parameter 7310 there,
//! X, Y, Z here.

use arcfeed_nc::alarm::{Alarm, Fault, NotModelled};
use arcfeed_nc::modal::{Feed, Pose, ProgramStop};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{MmPerMin, Nm};

use super::action::{Action, ReadBlock};
use super::reader::{BlockReader, sequence_of};
use super::settings::Switches;
use super::tape::ReceivedBlock;

/// Target of the operator's search for a block in the middle of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Sequence number search: block with this N; everything before it is skipped, so the modal state stays as it is.
    Sequence(u32),
    /// Program restart: block with this N; everything before it is read, so the block gets its modal state and start position.
    Restart(u32),
}

/// Result of checking one block in a search.
#[derive(Debug, PartialEq)]
pub enum SearchResult {
    /// The block is not the target.
    NotYet,
    /// The block is the target: the moves to its start position, then the block itself.
    Here(Vec<ReadBlock>),
    /// The target does not exist or cannot be used: a block that stops the control with the alarm.
    Never(Box<ReadBlock>),
}

impl Search {
    /// Checks whether the next block is the target.
    pub fn apply(
        self,
        received: ReceivedBlock,
        reader: &mut BlockReader,
        switches: &Switches,
        approach: &Approach,
    ) -> SearchResult {
        match self {
            Search::Sequence(wanted) => {
                let is_end = reader.skip(&received);
                match &received {
                    ReceivedBlock::Block(text) if sequence_of(text) == Some(wanted) => {
                        reader.unread();
                        SearchResult::Here(reader.read(received, switches).into_iter().collect())
                    }
                    _ if is_end => SearchResult::Never(Box::new(never(reader.line()))),
                    _ => SearchResult::NotYet,
                }
            }
            Search::Restart(wanted) => {
                let start = reader.end();
                let Some(block) = reader.read(received, switches) else { return SearchResult::NotYet };
                approach.restart_at(wanted, block, start)
            }
        }
    }
}

/// Block that raises alarm PS0060: the sequence number of the search does not exist.
pub fn never(line: u32) -> ReadBlock {
    let fault = Fault::alarm(Alarm::SequenceNotFound, 0);
    ReadBlock::new(line, Vec::new(), Action::Fault(fault))
}

/// Way in which the axes move to the start position of a program restart.
#[derive(Clone, Copy, Debug)]
pub struct Approach {
    /// Present position of the axes.
    pub position: Pose,
    /// Feed of the moves to the start position.
    pub feed: MmPerMin,
}

impl Approach {
    /// Checks whether `block` is the one with N `wanted`; `start` is the position at which the block before it ends.
    pub fn restart_at(&self, wanted: u32, block: ReadBlock, start: Pose) -> SearchResult {
        if sequence_of(&block.text) == Some(wanted) {
            if block.contour.continues && block.contour.offset != Nm(0) {
                let fault = Fault::not_modelled(NotModelled::RestartInContour, 0);
                return SearchResult::Never(Box::new(ReadBlock::new(block.line, block.text, Action::Fault(fault))));
            }
            let mut blocks = self.blocks(start, block.line);
            blocks.push(block);
            return SearchResult::Here(blocks);
        }
        match &block.action {
            Action::Stop(ProgramStop::End)
            | Action::Move(_, Some(ProgramStop::End))
            | Action::Series(_, Some(ProgramStop::End)) => SearchResult::Never(Box::new(never(block.line))),
            Action::Fault(fault) if *fault == Fault::alarm(Alarm::EndOfRecord, 1) => {
                SearchResult::Never(Box::new(never(block.line)))
            }
            Action::Fault(_) => SearchResult::Never(Box::new(block)),
            _ => SearchResult::NotYet,
        }
    }

    /// One move for each axis that is at another position.
    fn blocks(&self, to: Pose, line: u32) -> Vec<ReadBlock> {
        let feed = Feed::PerMinute(Nm::from_mm(f64::from(self.feed.0)));
        let mut at = self.position;
        let mut blocks = Vec::new();
        let mut go = |end: Pose| {
            if end != at {
                let segment = Segment { sequence: None, start: at, end, feed, path: Path::Line };
                blocks.push(ReadBlock::new(line, Vec::new(), Action::Move(segment, None)));
                at = end;
            }
        };
        let mut end = Pose { linear: self.position.linear, rotary: to.rotary };
        go(end);
        for axis in 0..end.linear.len() {
            end.linear[axis] = to.linear[axis];
            go(end);
        }
        blocks
    }
}
