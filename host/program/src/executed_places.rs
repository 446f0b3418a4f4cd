//! Places in the program's files of the blocks that were executed.

use std::collections::BTreeMap;
use std::path::PathBuf;

use arcfeed_nc_macro::stack::SourceLine;

use super::Diagnostic;
use super::library::Folder;
use super::run_faults::{file_of, in_main};

/// Place in the program's files of each executed block, by its line in the list of executed blocks.
#[derive(Clone, Debug, Default)]
pub struct ExecutedPlaces {
    /// Content of the program's own file.
    pub file: Vec<u8>,
    /// Folder of the called programs that are not in that file.
    pub library: Option<PathBuf>,
    /// Number of executed statements that produce output, which the blocks do not.
    pub outputs: usize,
    /// First place at which the program makes the control ignore feed hold, override or exact stop (#3004); `None` if it never does.
    pub ignores_feed: Option<SourceLine>,
    lines: Vec<Option<ExecutedLine>>,
    chains: Vec<Vec<SourceLine>>,
    known_chains: BTreeMap<Vec<SourceLine>, u32>,
}

/// Place of a line.
#[derive(Clone, Debug)]
struct ExecutedLine {
    place: SourceLine,
    chain: u32,
    /// Source column of each byte; empty if the text is the line as written.
    columns: Box<[u16]>,
}

impl ExecutedPlaces {
    /// Number of lines in the list of executed blocks.
    pub fn len(&self) -> usize {
        self.lines.len()
    }

    /// Whether the list has no lines.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Adds a line that arcfeed has added and that is in no file.
    pub fn add_own(&mut self) {
        self.lines.push(None);
    }

    /// Adds a line of the file or the library, with the calls that led to it.
    pub fn add(&mut self, place: SourceLine, calls: &[SourceLine], columns: &[u16]) {
        let chain = self.known_chains.get(calls).copied().unwrap_or_else(|| {
            let next = self.chains.len() as u32;
            self.chains.push(calls.to_vec());
            self.known_chains.insert(calls.to_vec(), next);
            next
        });
        self.lines.push(Some(ExecutedLine { place, chain, columns: columns.into() }));
    }

    /// Place of the line with this number, counted from 1; `None` for a line that arcfeed has added.
    pub fn place(&self, line: usize) -> Option<SourceLine> {
        self.line(line).map(|line| line.place)
    }

    /// Line of the program's file, counted from 1; `None` for a line of the library, and for one that is not in the file.
    pub fn own_line(&self, line: usize) -> Option<usize> {
        self.place(line).filter(|place| place.library.is_none()).map(|place| place.line as usize)
    }

    /// Line of the main program's file, counted from 1, to which a line belongs: for a line of the library that of the
    /// call that led to it.
    pub fn line_in_file(&self, line: usize) -> usize {
        let found = self.line(line).map(|found| in_main(found.place, self.calls(found)).line as usize);
        found.unwrap_or(1).max(1)
    }

    /// Place of a line: `line 9` of the program's file, or file and line of the library.
    pub fn name(&self, line: usize) -> String {
        self.line(line).map_or("line 1".into(), |line| self.place_name(line.place))
    }

    /// Calls that led to a line, the innermost first, as a phrase that begins with a comma; empty without calls.
    pub fn called_from(&self, line: usize) -> String {
        let calls = self.line(line).map(|line| self.calls(line)).unwrap_or_default();
        calls.iter().rev().map(|call| format!(", called from {}", self.place_name(*call))).collect()
    }

    /// Converts a diagnostic of a line to its place in the main program's file.
    #[must_use]
    pub fn in_file(&self, found: Diagnostic) -> Diagnostic {
        let line = self.line_in_file(found.line);
        match self.line(found.line) {
            Some(ExecutedLine { place, .. }) if place.library.is_some() => {
                let message = format!("in {}: {}", self.place_name(*place), found.message);
                Diagnostic { line, column: 1, end_column: 2, message, ..found }
            }
            Some(ExecutedLine { columns, .. }) => {
                let column = columns.get(found.column - 1).map_or(found.column, |column| usize::from(*column));
                Diagnostic { line, column, end_column: column + found.end_column - found.column, ..found }
            }
            None => Diagnostic { line, ..found },
        }
    }

    fn line(&self, line: usize) -> Option<&ExecutedLine> {
        self.lines.get(line.checked_sub(1)?)?.as_ref()
    }

    fn calls(&self, line: &ExecutedLine) -> &[SourceLine] {
        self.chains.get(line.chain as usize).map(Vec::as_slice).unwrap_or_default()
    }

    fn place_name(&self, place: SourceLine) -> String {
        let folder = self.library.as_ref().map(|folder| Folder(folder.clone()));
        match place.library {
            None => format!("line {}", place.line),
            Some(_) => format!("{}:{}", file_of(folder.as_ref(), place), place.line),
        }
    }
}
