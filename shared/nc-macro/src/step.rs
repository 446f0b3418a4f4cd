//! Settings of the macro interpreter, and the actions and faults that it returns.

use alloc::vec::Vec;

use super::function::AngleRange;
use super::print::{Output, PrintStyle};
use super::stack::{Bounds, SourceLine};
use super::variables::{Ignored, OutsideValues};
use arcfeed_nc::alarm::Fault;

/// Settings of the macro interpreter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MacroSettings {
    /// Range of the angles that ATAN and ASIN return.
    pub angles: AngleRange,
    /// Number format of DPRNT.
    pub print: PrintStyle,
    /// Block-delete switches that are on: bit n for `/n`.
    pub block_delete: u16,
    /// Whether the main program arrives line by line over the DNC line.
    pub is_dnc: bool,
    /// Treatment of values that do not follow from program and settings. If they are refused, the interpreter returns
    /// the same blocks on every control with these settings: it also refuses a `/` before a statement, and offsets
    /// that a statement sets, and returns blocks with a `/` whatever their switch is.
    pub outside: OutsideValues,
    /// Limits for nesting, statements and memory.
    pub bounds: Bounds,
}

/// Next action of the control in a program with macro statements.
#[derive(Clone, Debug, PartialEq)]
pub enum MacroStep {
    /// Interpret this block of plain words.
    Block(PlainBlock),
    /// Send this output over the serial line.
    Output(Output),
    /// From here on, ignore these functions, such as the feed override (#3003, #3004).
    Ignore(Ignored),
    /// A statement has set an offset: pass the tables of [`super::variables::Variables`] to the reader of plain
    /// blocks.
    Offset,
    /// Stop with a message until the operator presses cycle start (#3006).
    Message(Vec<u8>),
    /// Start the main program again (M99 in it).
    Restart,
    /// No action yet: [`Bounds::slice`] statements were executed without a result; call again.
    Busy,
    /// Wait for the next line of the main program (DNC operation).
    Starved,
    /// The program has ended.
    End(Ending),
}

/// Reason why a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// By M02 or M30.
    Program,
    /// By the end of its text; a control raises PS5010.
    Text,
}

/// A block of words with plain numbers, and the line of the program from which it results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlainBlock {
    /// Text for the reader of plain blocks.
    pub text: Vec<u8>,
    /// Line of the program from which the block results.
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

    /// The same fault, with its column in `text` converted to the column in the line of the program.
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
    /// Line of the program in which it occurred.
    pub place: SourceLine,
    /// Lines from which the running programs were called, the main program's call first.
    pub calls: Vec<SourceLine>,
    /// Comment of the block with `#3000`, if that has raised the alarm; otherwise empty.
    pub message: Vec<u8>,
}
