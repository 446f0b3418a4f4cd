//! What an interpreter is set to and what it answers.

use alloc::vec::Vec;

use super::function::Angles;
use super::print::{Output, PrintStyle};
use super::stack::{Bounds, Place};
use super::variables::Ignored;
use crate::nc::alarm::Fault;

/// How the control is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// Range of ATAN and ASIN.
    pub angles: Angles,
    /// How DPRNT writes.
    pub print: PrintStyle,
    /// Switches of block delete that are on: bit n for `/n`.
    pub block_delete: u16,
    /// Whether the main program comes line by line over the DNC line.
    pub is_dnc: bool,
    /// Bounds.
    pub bounds: Bounds,
}

/// What the control does next.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Reads a block of plain words.
    Block(PlainBlock),
    /// Sends something to the punch.
    Output(Output),
    /// From here on passes over what #3003 and #3004 say.
    Ignore(Ignored),
    /// An offset is set: the reader of plain blocks gets those of [`super::variables::Variables`].
    Offset,
    /// Stops with a message until the operator presses cycle start (#3006).
    Message(Vec<u8>),
    /// Begins the main program again (M99 in it).
    Restart,
    /// Nothing yet: [`Bounds::slice`] statements without one of the others. Time passes.
    Busy,
    /// Waits for the next line of its main program (DNC operation).
    Starved,
    /// Is at its end.
    End(Ending),
}

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// M02 or M30.
    Program,
    /// The text is over; a control raises PS5010.
    Text,
}

/// A block without expressions, and where it comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlainBlock {
    /// What the reader of plain blocks reads.
    pub text: Vec<u8>,
    /// Its source line.
    pub place: Place,
    /// Where the programs it stands in were called, the main program's call first.
    pub calls: Vec<Place>,
    /// The source column of each byte of `text`; nothing if `text` is the line as written.
    pub(super) columns: Vec<u16>,
}

impl PlainBlock {
    /// A fault of `text` in terms of the source line.
    pub fn in_source(&self, fault: Fault) -> Fault {
        let at = usize::from(fault.column).checked_sub(1);
        let column = at.and_then(|at| self.columns.get(at).or(self.columns.last()).copied());
        Fault { column: column.unwrap_or(fault.column), ..fault }
    }
}

/// Why a program stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct Trouble {
    /// What is wrong, and the column.
    pub fault: Fault,
    /// The line.
    pub place: Place,
    /// Where the programs it stands in were called, the main program's call first.
    pub calls: Vec<Place>,
    /// The text beside `#3000`.
    pub message: Vec<u8>,
}
