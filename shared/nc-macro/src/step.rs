//! Settings and results of the macro interpreter.

use alloc::vec::Vec;

use super::function::AngleRange;
use super::print::{Output, PrintStyle};
use super::stack::{Bounds, SourceLine};
use super::variables::{Ignored, OutsideValues};
use arcfeed_nc::alarm::Fault;

/// Settings of the macro interpreter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MacroSettings {
    /// Range of ATAN and ASIN.
    pub angles: AngleRange,
    /// Number format of DPRNT.
    pub print: PrintStyle,
    /// Block-delete switches that are on: bit n for `/n`.
    pub block_delete: u16,
    /// Whether the main program arrives line by line over the DNC line.
    pub is_dnc: bool,
    /// Treatment of values from outside the program. Where they are refused, a `/` before a statement and an offset set
    /// by one are, too: the blocks are then the same on every control with these settings. A block with a `/` is emitted
    /// whatever its switch is.
    pub outside: OutsideValues,
    /// Limits.
    pub bounds: Bounds,
}

/// Next action of the control in a program with macro statements.
#[derive(Clone, Debug, PartialEq)]
pub enum MacroStep {
    /// Read a block of plain words.
    Block(PlainBlock),
    /// Send output to the punch.
    Output(Output),
    /// Ignore the functions of #3003 and #3004 from here on.
    Ignore(Ignored),
    /// An offset was set: pass the tables of [`super::variables::Variables`] to the reader of plain blocks.
    Offset,
    /// Stop with a message until the operator presses cycle start (#3006).
    Message(Vec<u8>),
    /// Restart the main program (M99 in it).
    Restart,
    /// None yet: [`Bounds::slice`] statements were executed without another result.
    Busy,
    /// Wait for the next line of the main program (DNC operation).
    Starved,
    /// The program has ended.
    End(Ending),
}

/// Reason why a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// M02 or M30.
    Program,
    /// End of the text; a control raises PS5010.
    Text,
}

/// A block without expressions, with its origin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlainBlock {
    /// Text for the reader of plain blocks.
    pub text: Vec<u8>,
    /// Source line of the block.
    pub place: SourceLine,
    /// Lines from which the running programs were called, the main program's call first.
    pub calls: Vec<SourceLine>,
    /// Source column of each byte of `text`; empty if `text` is the line as written.
    pub(super) columns: Vec<u16>,
}

impl PlainBlock {
    /// Source column of each byte of the text; empty if the text is the line as written.
    pub fn columns(&self) -> &[u16] {
        &self.columns
    }

    /// Converts the column of a fault from `text` to the source line.
    pub fn in_source(&self, fault: Fault) -> Fault {
        let at = usize::from(fault.column).checked_sub(1);
        let column = at.and_then(|at| self.columns.get(at).or(self.columns.last()).copied());
        Fault { column: column.unwrap_or(fault.column), ..fault }
    }
}

/// Fault that stopped a program.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramFault {
    /// Cause and column.
    pub fault: Fault,
    /// Source line.
    pub place: SourceLine,
    /// Lines from which the running programs were called, the main program's call first.
    pub calls: Vec<SourceLine>,
    /// Comment of the `#3000` block.
    pub message: Vec<u8>,
}
