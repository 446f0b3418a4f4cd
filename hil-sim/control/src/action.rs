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

/// One block, ready to execute.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadBlock {
    /// Line of the block as received, counted from 1; for a block of a library program, the line of the call.
    pub line: u32,
    /// Bytes of the block, without the line end; values replace its expressions.
    pub text: Vec<u8>,
    /// Action of the block.
    pub action: Action,
    /// Context of the block's moves.
    pub context: MoveContext,
    /// Cutter compensation commanded by the block.
    pub contour: ContourCommand,
}

/// Action of a block: motion, dwell, stop and others.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// A comment, a title, modal words: no time, and moves flow through it.
    Nothing,
    /// An M, S or T function: takes no time here, but moves before it come to rest.
    Auxiliary,
    /// A move in machine coordinates, and the stop after it.
    Move(Segment, Option<ProgramStop>),
    /// A move around a corner of a contour (G41, G42), in machine coordinates. It belongs to the block behind it.
    Corner(Segment),
    /// Several moves in program coordinates (see `plain.rs`), and the stop after them.
    Series(Box<Series>, Option<ProgramStop>),
    /// G4.
    Dwell(Micros),
    /// M0, M1, M2, M30.
    Stop(ProgramStop),
    /// Functions switched off from here on: #3003, #3004.
    Ignore(Ignored),
    /// The control stops here with an alarm.
    Fault(Fault),
}

impl Action {
    /// Whether the control reads no further block before it has executed this one.
    pub fn stops_reading(&self) -> bool {
        matches!(self, Action::Stop(_) | Action::Move(_, Some(_)) | Action::Series(_, Some(_)) | Action::Fault(_))
    }
}

impl ReadBlock {
    /// A block with the default context.
    pub fn new(line: u32, text: Vec<u8>, action: Action) -> Self {
        ReadBlock { line, text, action, context: MoveContext::default(), contour: ContourCommand::default() }
    }

    /// Whether the block is an inserted chamfer or rounded corner, which belongs to the block before it and has its
    /// F. Other moves around a corner belong to the block behind it.
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

/// Context of all moves of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MoveContext {
    /// Machine coordinates of the workpiece's origin: that of the work coordinate system, with the tool length added to
    /// Z.
    pub origin: Pose,
    /// Tool length, which is part of `origin`.
    pub tool: Nm,
    /// Whether a law must not govern the moves: canned cycles, and moves under G41, G42, G43.4 and G95.
    pub is_special: bool,
    /// G63, or a tap in its hole: the override is 100 %, and feed hold waits.
    pub is_tapping: bool,
    /// Meaning of the programmed path.
    pub programmed_path: ProgrammedPath,
    /// Tool and spindle commanded by the program.
    pub machining: Machining,
    /// Part of the feed that the control takes away on an arc inside a contour, parts per million.
    pub feed_cut_ppm: u32,
}

impl MoveContext {
    /// Feed on the move over its F: below one on an arc inside a contour, if the control reduces the feed there.
    pub fn feed_ratio(&self) -> f64 {
        1.0 - f64::from(self.feed_cut_ppm) / f64::from(PPM)
    }
}

/// Meaning of the path that a program describes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProgrammedPath {
    /// Path of the axes.
    #[default]
    Axes,
    /// Path of the tool tip on the part: G43.4.
    Tip,
    /// Contour of the part under G41 or G42 with a D of no radius: the control does not know the tool.
    Contour,
}
