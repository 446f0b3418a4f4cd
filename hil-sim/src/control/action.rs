//! Blocks as they are executed: what each does, and how.

use arcfeed_shared::nc::alarm::Fault;
use arcfeed_shared::nc::machining::Machining;
use arcfeed_shared::nc::macros::program::is_statement;
use arcfeed_shared::nc::macros::variables::Ignored;
use arcfeed_shared::nc::modal::{Pose, Stop};
use arcfeed_shared::nc::series::Series;
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::{Micros, Nm};

/// One block, ready to execute.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadBlock {
    /// Its line in what was received, counted from 1; of a program of the library the line of the call.
    pub line: u32,
    /// Its bytes, without the line end; where it has expressions, with their values in their place.
    pub text: Vec<u8>,
    /// What it does.
    pub action: Action,
    /// How its moves are made.
    pub context: MoveContext,
}

/// What a block does.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// A comment, a title, modal words: no time, and moves flow through it.
    Nothing,
    /// An M, S or T function: no time here, but moves before it come to rest.
    Auxiliary,
    /// A move in machine coordinates, and where the program goes on after it.
    Move(Segment, Option<Stop>),
    /// Several moves, on the path (see `plain.rs`), and where the program goes on after them.
    Series(Box<Series>, Option<Stop>),
    /// G4.
    Dwell(Micros),
    /// M0, M1, M2, M30.
    Stop(Stop),
    /// What counts for nothing from here on: #3003, #3004.
    Ignore(Ignored),
    /// The control stops here with an alarm.
    Fault(Fault),
}

impl Action {
    /// Whether nothing behind this block is read before it is executed.
    pub fn stops_reading(&self) -> bool {
        matches!(self, Action::Stop(_) | Action::Move(_, Some(_)) | Action::Series(_, Some(_)) | Action::Fault(_))
    }
}

impl ReadBlock {
    /// A block that asks for nothing special.
    pub fn new(line: u32, text: Vec<u8>, action: Action) -> Self {
        ReadBlock { line, text, action, context: MoveContext::default() }
    }

    /// Whether a control in single block waits after it: not after one with nothing but a comment, not after a macro
    /// statement or a call.
    pub fn is_halt_of_single_block(&self) -> bool {
        let code = self.text.split(|&byte| byte == b'(').next().unwrap_or_default();
        match self.action {
            Action::Nothing => !code.trim_ascii().is_empty() && !is_statement(&self.text),
            Action::Ignore(_) => false,
            _ => true,
        }
    }
}

/// What holds for all moves of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MoveContext {
    /// Machine coordinates of the workpiece's origin: of the work coordinate system, Z longer by the tool.
    pub origin: Pose,
    /// What of it is the tool's length.
    pub tool: Nm,
    /// Whether a law cannot govern its moves: canned cycles, and what is under G41, G42, G43.4 and G95.
    pub is_special: bool,
    /// G63, or a tap in its hole: the override counts 100 %, and feed hold waits.
    pub is_tapping: bool,
    /// Whose way its moves are.
    pub way: Way,
    /// Tool and spindle, as the program has commanded them.
    pub machining: Machining,
}

/// Whose way a block's moves are written as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Way {
    /// The axes'.
    #[default]
    Axes,
    /// The tool tip's on the part: G43.4.
    Tip,
    /// The part's contour: G41, G42.
    Contour,
}
