//! Moves in the order of execution, for following a machine's axes.

use arcfeed_nc::modal::Motion;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::series::SeriesAction;
use arcfeed_units::Nm;

use super::{Program, ProgramLine};

/// One executed move, with its line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveTrace {
    /// Line in the main program's file, counted from 1.
    pub line: usize,
    /// Move in path coordinates (docs/dialect.md).
    pub segment: Segment,
    /// See [`ProgramLine::tool_length`].
    pub tool_length: Nm,
    /// See [`ProgramLine::follows_tip`].
    pub follows_tip: bool,
}

impl MoveTrace {
    /// Moves of a block, those of cycles and reference returns one by one; `reader` is the control after the block.
    pub fn of_block(line: usize, block: &InterpretedLine, reader: &Reader) -> impl Iterator<Item = MoveTrace> {
        let (tool_length, follows_tip) = tool_of(reader);
        segments(block).map(move |segment| MoveTrace { line, segment, tool_length, follows_tip })
    }

    fn of_line(line: usize, of: &ProgramLine) -> Vec<MoveTrace> {
        let ProgramLine { tool_length, follows_tip, .. } = *of;
        let segments = of.meaning.iter().flat_map(segments);
        segments.map(move |segment| MoveTrace { line, segment, tool_length, follows_tip }).collect()
    }
}

impl Program {
    /// All moves. For a program with macro statements: those of its run, if the run kept them.
    pub fn executed_moves(&self) -> Vec<MoveTrace> {
        if self.macro_line.is_some() {
            return self.run.clone();
        }
        (1..).zip(self.lines()).flat_map(|(number, line)| MoveTrace::of_line(number, &line)).collect()
    }
}

/// Tool length offset in Z in machine coordinates, and whether G43.4 is in force.
pub(super) fn tool_of(reader: &Reader) -> (Nm, bool) {
    let modal = reader.modal();
    (modal.tool_length(reader.tables()), modal.follows_tool_center)
}

/// Moves of a block on the path, those of cycles and reference returns one by one.
fn segments(block: &InterpretedLine) -> impl Iterator<Item = Segment> {
    block.segment.into_iter().chain(series_segments(block))
}

/// Moves of a block's cycle or reference return.
pub(super) fn series_segments(block: &InterpretedLine) -> impl Iterator<Item = Segment> {
    let sequence = block.parsed.block.sequence;
    let segment = move |motion: Motion| Segment::from_motion(&motion, sequence).ok();
    block.step.series.iter().flat_map(|series| series.actions()).filter_map(move |act| match act {
        SeriesAction::Move(motion) => segment(motion),
        SeriesAction::Dwell(_) | SeriesAction::Spindle(_) => None,
    })
}
