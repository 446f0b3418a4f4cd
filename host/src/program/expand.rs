//! Programs with macro statements: interpreted to their end, as a control with them in memory would run them.
//!
//! Time stands still but for a millisecond that a slice of statements takes, so that a program which waits for a timer gets
//! on. The first macro alarm ends the program; faults of plain blocks are collected, each once for its place.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use arcfeed_shared::nc::alarm::{Alarm, Fault};
use arcfeed_shared::nc::block::Reading;
use arcfeed_shared::nc::macro_alarm::MacroAlarm;
use arcfeed_shared::nc::macros::interpreter::Interpreter;
use arcfeed_shared::nc::macros::program::{Library, needs_interpreter};
use arcfeed_shared::nc::macros::stack::Place;
use arcfeed_shared::nc::macros::step::{PlainBlock, Settings, Step, Trouble};
use arcfeed_shared::nc::macros::variables::Context;
use arcfeed_shared::reader::Reader;
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::{LengthUnit, Micros};

use super::Diagnostic;

/// Most blocks that are interpreted.
const BLOCKS_MAX: usize = 2_000_000;
/// Most places that faults are told of.
const FAULTS_MAX: usize = 200;
/// What a slice of statements takes.
const SLICE: Micros = Micros::from_ms(1);

/// A folder with subprograms, one a file: `O9010`, with `.nc` or without, or `9010.nc`.
#[derive(Clone, Debug)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// The file of a program.
    pub fn file(&self, number: u32) -> Option<PathBuf> {
        let names = [format!("O{number:04}"), format!("O{number}"), format!("{number:04}"), format!("{number}")];
        let paths =
            names.iter().flat_map(|name| ["", ".nc", ".NC"].map(|ending| self.0.join(format!("{name}{ending}"))));
        paths.into_iter().find(|path| path.is_file())
    }
}

impl Library for Folder {
    fn load(&mut self, number: u32) -> Option<Vec<u8>> {
        std::fs::read(self.file(number)?).ok()
    }
}

/// Where a program's first macro statement or call stands: line, counted from 1, and its text.
pub fn first_macro(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let lines = bytes.split(|&byte| byte == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line));
    (1..).zip(lines).find(|(_, line)| needs_interpreter(line))
}

/// How a program is interpreted.
#[derive(Debug)]
pub struct Expansion<'a> {
    /// Unit at power-on.
    pub unit: LengthUnit,
    /// Strict or lenient.
    pub reading: Reading,
    /// Subprograms that are not in the file.
    pub library: Option<&'a Path>,
}

impl Expansion<'_> {
    /// Interprets a program: every move to `on_move`; answers what is wrong, in the order found.
    pub fn run(&self, bytes: &[u8], mut on_move: impl FnMut(&Segment)) -> Vec<Diagnostic> {
        let lines: Vec<&[u8]> = bytes.split(|&byte| byte == b'\n').collect();
        let folder = self.library.map(|path| Folder(path.to_owned()));
        let library: Box<dyn Library> = match &folder {
            Some(folder) => Box::new(folder.clone()),
            None => Box::new(()),
        };
        let mut reader = Reader::new(self.unit, self.reading);
        let mut now = Micros(0);
        let mut found = Findings { lines: &lines, folder: folder.as_ref(), told: BTreeSet::new(), list: Vec::new() };
        let mut interpreter = Interpreter::new(bytes, library, Settings::default(), &Context::new(reader.modal(), now));
        let mut blocks = 0;
        loop {
            match interpreter.next(&Context::new(reader.modal(), now)) {
                Ok(Step::Block(block)) if blocks == BLOCKS_MAX => {
                    found.add(Fault::in_macro(MacroAlarm::Endless, 1), block.place, &block.calls, b"");
                    break;
                }
                Ok(Step::Block(block)) => {
                    blocks += 1;
                    let segment = found.read(&mut reader, &block, self.reading);
                    segment.iter().for_each(&mut on_move);
                }
                Ok(Step::Output(_) | Step::Message(_)) => {}
                Ok(Step::Busy) => now = now.after(SLICE),
                // M99 in a main program: what follows is what was.
                Ok(Step::Restart | Step::Starved | Step::End(_)) => break,
                Err(Trouble { fault, place, calls, message }) => {
                    found.add(fault, place, &calls, &message);
                    break;
                }
            }
        }
        found.list
    }
}

/// What was found so far.
struct Findings<'a> {
    lines: &'a [&'a [u8]],
    folder: Option<&'a Folder>,
    told: BTreeSet<(Option<u32>, u32, u16)>,
    list: Vec<Diagnostic>,
}

impl Findings<'_> {
    fn read(&mut self, reader: &mut Reader, block: &PlainBlock, reading: Reading) -> Option<Segment> {
        match reader.read(&block.text) {
            Ok(understood) => {
                if understood.lacks_feed() && self.is_new(Fault::alarm(Alarm::NoFeed, 0), block.place) {
                    let text = self.text(block.place);
                    self.list.push(Diagnostic::of_missing_feed(block.place.line as usize, &text, reading));
                }
                understood.segment
            }
            Err(fault) => {
                self.add(block.in_source(fault), block.place, &block.calls, b"");
                None
            }
        }
    }

    fn is_new(&mut self, fault: Fault, place: Place) -> bool {
        self.told.len() < FAULTS_MAX && self.told.insert((place.library, place.line, fault.column))
    }

    fn text(&self, place: Place) -> Vec<u8> {
        let line = self.lines.get((place.line as usize).saturating_sub(1)).copied().unwrap_or_default();
        line.strip_suffix(b"\r").unwrap_or(line).to_vec()
    }

    /// A fault in a program of the library is told at the call in the main program's file that led to it.
    fn add(&mut self, fault: Fault, place: Place, calls: &[Place], message: &[u8]) {
        if !self.is_new(fault, place) {
            return;
        }
        let (own, inner) = match place.library {
            None => ((place, fault), None),
            Some(number) => {
                let call = calls.iter().rev().find(|call| call.library.is_none()).copied().unwrap_or_default();
                ((call, Fault { column: 0, ..fault }), Some(number))
            }
        };
        let ((place_in_main, fault_in_main), text) = (own, self.text(own.0));
        let mut diagnostic = Diagnostic::of_fault((place_in_main.line as usize).max(1), &text, fault_in_main);
        if !message.is_empty() {
            diagnostic.message = format!("{}: {}", diagnostic.message, message.escape_ascii());
        }
        if let Some(number) = inner {
            let file = self.folder.and_then(|folder| folder.file(number));
            let file = file.map_or(format!("O{number}"), |path| path.display().to_string());
            let (line, column) = (place.line, fault.column.max(1));
            diagnostic.message = format!("in {file}:{line}:{column}: {}", diagnostic.message);
        } else if let Some(call) = calls.last() {
            diagnostic.message = format!("{} (called from line {})", diagnostic.message, call.line);
        }
        self.list.push(diagnostic);
    }
}
