//! Blocks ready for execution: their actions and the context of their moves.

use arcfeed_compensation::contour::ContourCommand;
use arcfeed_compensation::inside_arc::PPM;
use arcfeed_nc::alarm::Fault;
use arcfeed_nc::machining::Machining;
use arcfeed_nc::modal::{Pose, ProgramStop};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::series::Series;
use arcfeed_nc_macro::program::is_statement;
use arcfeed_nc_macro::variables::Ignored;
use arcfeed_units::{Micros, Nm};

/// One block that the control has read ahead and prepared for execution.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadBlock {
    /// Line number of the block in the program as received, counted from 1; for a block of a library program, that of its call.
    pub line: u32,
    /// Bytes of the block, without the line end; macro expressions are replaced by their values.
    pub text: Vec<u8>,
    /// Action of the block.
    pub action: Action,
    /// Context of the block's moves.
    pub context: MoveContext,
    /// Cutter compensation commanded by the block.
    pub contour: ContourCommand,
}

/// Action that a block makes the control do: a move, a dwell, a stop, or nothing.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// A comment, a title or modal words only: takes no time, and the axes do not stop for it.
    Nothing,
    /// An M, S or T function: takes no time in this model, but the axes come to rest before it.
    Auxiliary,
    /// A move in machine coordinates, and the program stop (M0, M1, M2, M30) of the same block, after it.
    Move(Segment, Option<ProgramStop>),
    /// A move that cutter compensation (G41, G42) or `,C` and `,R` insert at a corner, in machine coordinates. Except for an inserted
    /// chamfer or rounding it belongs to the block after it.
    Corner(Segment),
    /// Several moves in program coordinates (canned cycle, G28, G30), and the program stop of the same block, after them.
    Series(Box<Series>, Option<ProgramStop>),
    /// A dwell of this time (G4).
    Dwell(Micros),
    /// A program stop or end: M0, M1, M2, M30.
    Stop(ProgramStop),
    /// Change of the functions that the program switches off by #3003 and #3004; applies to the following blocks.
    Ignore(Ignored),
    /// An alarm that stops the control when it executes this block.
    Fault(Fault),
}

impl Action {
    /// Whether the control reads no further block before it has executed this one.
    pub fn stops_reading(&self) -> bool {
        matches!(self, Action::Stop(_) | Action::Move(_, Some(_)) | Action::Series(_, Some(_)) | Action::Fault(_))
    }
}

impl ReadBlock {
    /// Block with the default context and without cutter compensation.
    pub fn new(line: u32, text: Vec<u8>, action: Action) -> Self {
        ReadBlock { line, text, action, context: MoveContext::default(), contour: ContourCommand::default() }
    }

    /// Whether the block is an inserted chamfer or rounded corner: it belongs to the block before it and has the F of that block.
    pub fn is_inserted(&self) -> bool {
        matches!(self.action, Action::Corner(_)) && self.contour.corner.is_some()
    }

    /// Whether a control in single block waits after this block. It does not after a block that is only a comment,
    /// after a macro statement or after a call.
    pub fn stops_single_block(&self) -> bool {
        let code = self.text.split(|&byte| byte == b'(').next().unwrap_or_default();
        match self.action {
            Action::Nothing => !code.trim_ascii().is_empty() && !is_statement(&self.text),
            Action::Ignore(_) | Action::Corner(_) => false,
            _ => true,
        }
    }
}

/// Context of all moves of a block: coordinates, and what the program has commanded for them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MoveContext {
    /// Machine coordinates of the workpiece's origin: that of the work coordinate system, with the tool length added to
    /// Z.
    pub origin: Pose,
    /// Tool length along Z, which `origin` already includes.
    pub tool: Nm,
    /// Whether no feed law may change the feed of the moves: canned cycles, and moves under G41, G42, G43.4 and G95.
    pub is_special: bool,
    /// Whether the moves are tapping (G63, or a tap in its hole): the override counts as 100 %, and feed hold acts only afterwards.
    pub is_tapping: bool,
    /// Which path the programmed coordinates describe: that of the axes, of the tool tip, or of the contour.
    pub programmed_path: ProgrammedPath,
    /// Tool and spindle commanded by the program.
    pub machining: Machining,
    /// Whether the position on the workpiece is known.
    pub place: WorkpiecePlace,
    /// Reduction of the feed that the control applies on an arc inside a contour under cutter compensation, parts per million of F.
    pub feed_cut_ppm: u32,
}

impl MoveContext {
    /// Factor on the programmed feed: 1, or less on an arc inside a contour where the control reduces the feed.
    pub fn feed_ratio(&self) -> f64 {
        1.0 - f64::from(self.feed_cut_ppm) / f64::from(PPM)
    }
}

/// Knowledge of the position of a block's moves on the workpiece. Unknown is a machine position (G28, G30, G53) without a work
/// offset, up to the end of the move that gives the last of its axes again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WorkpiecePlace {
    /// All moves.
    #[default]
    Known,
    /// The move to the intermediate point of G28 or G30, but not the next one.
    ToIntermediate,
    /// No move.
    Unknown,
}

/// Which path the coordinates of a program describe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProgrammedPath {
    /// Path of the axes: that of the tool's centre.
    #[default]
    Axes,
    /// Path of the tool tip relative to the workpiece, under G43.4.
    Tip,
    /// Contour of the workpiece, under G41 or G42 with a D whose radius is 0: the control moves the tool's centre on it.
    Contour,
}
