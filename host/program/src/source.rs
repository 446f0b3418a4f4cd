//! Text of a program, and the control that reads it. Lines are read on demand, so that a command needs memory for the
//! text but not for the meaning of each line.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arcfeed_nc::alarm::{Alarm, Fault};
use arcfeed_nc::reader::Reader;
use arcfeed_nc::settings::{Settings, Tables};
use arcfeed_nc::text::Lines;
use arcfeed_nc_macro::program::first_macro;
use arcfeed_nc_macro::variables::OutsideValues;
use memchr::memchr;

use crate::files;

use super::contour_check::contour_diagnostics;
use super::lines::LineReader;
use super::summary::ProgramSummary;
use super::{Diagnostic, ExecutedPlaces, Expansion, Program, ProgramLine, RunBounds};

/// Largest size of a file with a program or CL data, in bytes.
pub const BYTES_MAX: u64 = 80 << 20;
/// Largest number of lines of a program for commands that keep something of each line in memory, about a kilobyte.
pub const LINES_MAX: usize = 1 << 20;

/// NC program as text, with the settings of the control that is to read it.
#[derive(Clone, Debug)]
pub struct Source {
    /// Path of the file.
    pub path: PathBuf,
    /// Bytes of the file.
    pub bytes: Vec<u8>,
    /// Settings of the control.
    pub settings: Settings,
    /// Offsets of the control.
    pub tables: Tables,
    /// First line with a macro statement or a call, counted from 1, if there is one.
    pub macro_line: Option<usize>,
    /// For a program given as its executed blocks: place of each block in the program's file. `None` if the lines are those of the file.
    pub places: Option<Arc<ExecutedPlaces>>,
}

/// Reader of the lines of a program, which keeps one line at a time.
pub struct SourceLines<'a> {
    rest: Lines<'a>,
    reader: LineReader,
    line: ProgramLine,
    /// Diagnostics of the line.
    found: Vec<Diagnostic>,
}

impl SourceLines<'_> {
    /// Reads and returns the next line, if there is one more.
    pub fn next_line(&mut self) -> Option<&ProgramLine> {
        self.read_next().then_some(&self.line)
    }

    /// Reads the next line; returns whether there was one. [`SourceLines::line`] returns the line.
    pub fn read_line(&mut self) -> bool {
        self.read_next()
    }

    /// The last line read.
    pub fn line(&self) -> &ProgramLine {
        &self.line
    }

    /// State of the control after the last line read.
    pub fn control(&self) -> &Reader {
        self.reader.control()
    }

    fn read_next(&mut self) -> bool {
        let Some(raw) = self.rest.next() else { return false };
        self.found.clear();
        self.reader.read_into(raw, &mut self.line, &mut self.found);
        true
    }
}

/// Reads a file of at most 80 MiB.
///
/// # Errors
/// It cannot be read, or is larger: in words, with its path.
pub fn read_bounded(path: &Path) -> Result<Vec<u8>, String> {
    let name = path.display();
    let too_large = |size: u64| {
        format!(
            "{name}: {size} bytes, and at most {BYTES_MAX} ({} MiB) of a program are read; split it between two operations \
             into programs of its own",
            BYTES_MAX >> 20
        )
    };
    let read = || -> std::io::Result<Result<Vec<u8>, u64>> {
        let (file, size) = files::open(path)?;
        if size > BYTES_MAX {
            return Ok(Err(size));
        }
        let mut bytes = Vec::with_capacity(usize::try_from(size).unwrap_or(0) + 1);
        // A pipe reports no size.
        file.take(BYTES_MAX + 1).read_to_end(&mut bytes)?;
        let read = bytes.len() as u64;
        Ok(if read > BYTES_MAX { Err(read) } else { Ok(bytes) })
    };
    read().map_err(|error| format!("{name}: {error}"))?.map_err(too_large)
}

/// Rejects a program of more than [`LINES_MAX`] lines, for a command that keeps something of each.
///
/// # Errors
/// It has more: in words, with its path.
pub fn check_line_count(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let count = Lines::new(bytes).count();
    if count <= LINES_MAX {
        return Ok(());
    }
    Err(format!(
        "{}: {count} lines, and this command keeps something of each of them in memory (about 1 kB) and takes at most {LINES_MAX}; split it \
         between two operations into programs of its own (`check` and `adapt` take any number of lines)",
        path.display()
    ))
}

impl Source {
    /// Reads a program file, for a control with these settings.
    ///
    /// # Errors
    /// It cannot be read, or is larger than 80 MiB: in words, with its path.
    pub fn read(path: &Path, settings: Settings, tables: Tables) -> Result<Self, String> {
        let bytes = read_bounded(path)?;
        Ok(Source { path: path.to_owned(), macro_line: first_macro(&bytes), bytes, settings, tables, places: None })
    }

    /// Reader with the control's state before the first line.
    pub fn reader(&self) -> LineReader {
        LineReader::new(self.settings, self.tables)
    }

    /// Lines of the program, one after the other.
    pub fn lines(&self) -> SourceLines<'_> {
        SourceLines {
            rest: Lines::new(&self.bytes),
            reader: self.reader().with_slashes(memchr(b'/', &self.bytes).is_some()),
            line: ProgramLine::default(),
            found: Vec::new(),
        }
    }

    /// Counts the content of the program, passes each line to `line`, and reports its diagnostics with the line's text, in
    /// order of place. As a `run` the program also has to begin with `%`, and to end, and its contours are checked: their
    /// diagnostics come last.
    pub fn survey(
        &self,
        is_run: bool,
        mut line: impl FnMut(&ProgramLine),
        mut each: impl FnMut(Diagnostic, &[u8]),
    ) -> ProgramSummary {
        let (mut lines, mut summary) = (self.lines(), ProgramSummary::default());
        let mut has_contours = false;
        while lines.read_next() {
            let SourceLines { line: read, found, reader, .. } = &mut lines;
            has_contours |= reader.control().modal().compensation.is_some() || read.ends_in_corner();
            if is_run && summary.lines == 0 {
                read.missing_label().into_iter().for_each(|lost| each(lost, &read.text));
            }
            summary.add(read);
            line(read);
            if !found.is_empty() {
                found.drain(..).for_each(|diagnostic| each(diagnostic, &read.text));
            }
        }
        if is_run && summary.blocks > 0 && !summary.may_end {
            let last = &lines.line.text;
            each(Diagnostic::of_fault(summary.lines, last, Fault::alarm(Alarm::EndOfRecord, 0)), last);
        }
        if is_run && has_contours {
            for found in contour_diagnostics(&self.bytes, self.settings, self.tables) {
                let text = Lines::new(&self.bytes).nth(found.line - 1).map_or(&[][..], |raw| raw.text);
                each(found, text);
            }
        }
        summary
    }

    /// Converts a diagnostic of a line to its place in the file.
    #[must_use]
    pub fn in_file(&self, found: Diagnostic) -> Diagnostic {
        match &self.places {
            Some(places) => places.in_file(found),
            None => found,
        }
    }

    /// Line of the file to which a line belongs, both counted from 1.
    pub fn line_in_file(&self, line: usize) -> usize {
        self.places.as_ref().map_or(line, |places| places.line_in_file(line))
    }

    /// The program as a whole.
    ///
    /// # Errors
    /// It has more than [`LINES_MAX`] lines: in words, with its path.
    pub fn whole(&self) -> Result<Program, String> {
        check_line_count(&self.path, &self.bytes)?;
        Ok(self.program())
    }

    /// The program as a whole, of any length.
    pub(super) fn program(&self) -> Program {
        let program = Program::parse_with(&self.path, &self.bytes, self.settings, self.tables);
        Program { places: self.places.clone(), ..program }
    }

    /// The program as a whole, run to its end (see [`Program::run`]).
    ///
    /// # Errors
    /// See [`Source::whole`].
    pub fn run(&self, library: Option<&Path>, keeps_moves: bool, bounds: RunBounds) -> Result<Program, String> {
        check_line_count(&self.path, &self.bytes)?;
        let (settings, tables) = (self.settings, self.tables);
        let outside = OutsideValues::Assumed;
        Ok(Program::run(&self.path, &self.bytes, Expansion { settings, tables, library, keeps_moves, bounds, outside }))
    }
}
