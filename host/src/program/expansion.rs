//! Programs with macro statements: interpreted to their end, as a control with them in memory would run them.
//!
//! Time advances by one millisecond per slice of statements only, so that a program that waits for a timer continues.
//! The first macro alarm ends the program. Faults of plain blocks are collected, each once for its place.

use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use arcfeed_nc::alarm::{Alarm, Cause, Fault};
use arcfeed_nc::block::{Parsed, Reading, parse_line};
use arcfeed_nc::macro_alarm::MacroAlarm;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::settings::{Settings, Tables};
use arcfeed_nc::text::{Lines, RawLine};
use arcfeed_nc_macro::interpreter::Interpreter;
use arcfeed_nc_macro::program::{Library, first_macro};
use arcfeed_nc_macro::stack::{Bounds, SourceLine};
use arcfeed_nc_macro::step::{self as macros, Ending, PlainBlock, ProgramFault};
use arcfeed_nc_macro::variables::Context;
use arcfeed_units::Micros;

use super::contour_check::{ContourCheck, ContourFinding, contour_diagnostics};
use super::{Diagnostic, MoveCounts, MoveTrace, Program, ProgramLine, ProgramSummary};

/// Most places for which faults are reported.
const FAULTS_MAX: usize = 200;
/// Interpreted time of a slice of statements.
const SLICE: Micros = Micros::from_ms(1);

/// Folder with subprograms, one per file: `O9010`, with `.nc` or without, or `9010.nc`.
#[derive(Clone, Debug)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// Path of a program's file.
    pub fn file(&self, number: u32) -> Option<PathBuf> {
        let names = [format!("O{number:04}"), format!("O{number}"), format!("{number:04}"), format!("{number}")];
        let paths =
            names.iter().flat_map(|name| ["", ".nc", ".NC"].map(|ending| self.0.join(format!("{name}{ending}"))));
        paths.into_iter().find(|path| path.is_file())
    }
}

impl Library for Folder {
    fn load(&mut self, number: u32) -> Option<Vec<u8>> {
        let mut text = Vec::new();
        // One byte more than all programs may have is enough to reject it.
        let most = Bounds::default().memory as u64 + 1;
        std::fs::File::open(self.file(number)?).ok()?.take(most).read_to_end(&mut text).ok()?;
        Some(text)
    }
}

/// Bounds of a program's run.
#[derive(Clone, Copy, Debug)]
pub struct RunBounds {
    /// Most blocks in all, and most statements between two moves.
    pub blocks: u32,
    /// Longest time of the interpreter.
    pub time: Duration,
}

impl RunBounds {
    /// Describes the bound that is reached, with the setting that raises it.
    fn check(&self, step: &Result<macros::MacroStep, ProgramFault>, blocks: u32, time: Duration) -> Option<String> {
        let is_endless = |trouble: &ProgramFault| trouble.fault.cause == Cause::Macro(MacroAlarm::Endless);
        let (bound, option) = match step {
            Err(trouble) if is_endless(trouble) => {
                (format!("{} statements since the last move", self.blocks), "--max-blocks")
            }
            Ok(macros::MacroStep::Block(_)) if blocks >= self.blocks => {
                (format!("at most {}", self.blocks), "--max-blocks")
            }
            Ok(_) if time > self.time => (format!("{} s", self.time.as_secs()), "--max-seconds"),
            _ => return None,
        };
        Some(format!("{blocks} blocks executed, {bound}; {option} raises the bound"))
    }
}

/// Settings for interpreting a program.
#[derive(Clone, Debug)]
pub struct Expansion<'a> {
    /// Settings of the control.
    pub settings: Settings,
    /// Offsets of the control.
    pub tables: Tables,
    /// Folder with subprograms that are not in the file.
    pub library: Option<&'a Path>,
    /// The moves of the run are kept, for [`Program::executed_moves`].
    pub keeps_moves: bool,
    /// Bounds of the run.
    pub bounds: RunBounds,
}

impl Program {
    /// Reads a program as a control runs it from memory: a program with macro statements or calls is interpreted to its
    /// end, one without them is read by [`Program::parse_with`]. A program without M02, M30 or M99 ends in PS5010.
    pub fn run(path: &Path, bytes: &[u8], expansion: Expansion<'_>) -> Self {
        let Some(macro_line) = first_macro(bytes) else {
            let mut program = Program::parse_with(path, bytes, expansion.settings, expansion.tables);
            program.diagnostics.extend(contour_diagnostics(bytes, expansion.settings, expansion.tables));
            program.diagnostics.sort_by_key(|diagnostic| (diagnostic.line, diagnostic.column));
            let summary = ProgramSummary::new(&program.lines);
            if summary.blocks > 0 && !summary.may_end {
                let text = program.lines.last().map(|line| line.text.clone()).unwrap_or_default();
                let fault = Fault::alarm(Alarm::EndOfRecord, 0);
                program.diagnostics.push(Diagnostic::of_fault(program.lines.len(), &text, fault));
            }
            return program;
        };
        let mut program = Program::empty(path, Some(macro_line), &Reader::with(expansion.settings, expansion.tables));
        for RawLine { text, ending } in Lines::new(bytes) {
            program.keep(text, ending, &expansion.settings);
        }
        let (found, moves, run) = expansion.run(bytes, &program.lines);
        (program.moves, program.run) = (moves, run);
        program.diagnostics.extend(found);
        program.diagnostics.sort_by_key(|diagnostic| (diagnostic.line, diagnostic.column));
        program
    }

    /// Keeps a line as it stands. Only a line without code has a meaning by itself.
    fn keep(&mut self, text: &[u8], ending: &[u8], settings: &Settings) {
        let parsed = parse_line(text, settings.reading).ok();
        let numbers = |parsed: &Parsed| parsed.block.check_numbers(text, settings).ok().flatten();
        for notice in parsed.iter().flat_map(|parsed| parsed.notices.iter().copied().chain(numbers(parsed))) {
            self.diagnostics.push(Diagnostic::of_notice(self.lines.len() + 1, text, notice));
        }
        let without_code = parsed.filter(|parsed| parsed.block.is_empty());
        let meaning = without_code.map(|parsed| InterpretedLine { parsed, ..InterpretedLine::default() });
        let (text, ending) = (text.to_vec(), ending.to_vec());
        self.lines.push(ProgramLine { text, ending, meaning, ..ProgramLine::default() });
    }
}

impl Expansion<'_> {
    /// Interprets a program. Returns its faults in the order found, and its moves: counted, and kept if requested.
    fn run(self, bytes: &[u8], lines: &[ProgramLine]) -> (Vec<Diagnostic>, MoveCounts, Vec<MoveTrace>) {
        let folder = self.library.map(|path| Folder(path.to_owned()));
        let library: Box<dyn Library> = match &folder {
            Some(folder) => Box::new(folder.clone()),
            None => Box::new(()),
        };
        let bounds = Bounds { steps: self.bounds.blocks, ..Bounds::default() };
        let settings = macros::MacroSettings {
            block_delete: self.settings.delete_switches,
            bounds,
            ..macros::MacroSettings::default()
        };
        let mut reader = Reader::with(self.settings, self.tables).at_unknown_position();
        let mut found = Findings::new(lines, folder.as_ref(), &self.settings);
        let mut interpreter = Interpreter::new(bytes, library, settings, &context(&reader, Micros(0)));
        interpreter.set_tables(&self.tables);
        let (mut now, mut blocks, mut moves, mut run) = (Micros(0), 0, MoveCounts::default(), Vec::new());
        let started = Instant::now();
        loop {
            let step = interpreter.next(&context(&reader, now));
            if let Some(reached) = self.bounds.check(&step, blocks, started.elapsed()) {
                let ProgramFault { fault, place, calls, .. } =
                    interpreter.stop(Fault::in_macro(MacroAlarm::Endless, 1));
                found.add(fault, place, &calls, reached.as_bytes());
                break;
            }
            match step {
                Ok(macros::MacroStep::Block(block)) => {
                    blocks += 1;
                    let understood = found.read(&mut reader, &block, self.settings.reading);
                    understood.iter().for_each(|block| moves.add(block));
                    if let Some(understood) = understood.as_ref().filter(|_| self.keeps_moves) {
                        let line = in_main(block.place, &block.calls).line as usize;
                        run.extend(MoveTrace::of_block(line, understood, &reader));
                    }
                    if understood.is_some_and(|block| block.step.sets_data) {
                        interpreter.set_tables(reader.tables());
                    }
                }
                Ok(macros::MacroStep::Output(_) | macros::MacroStep::Message(_) | macros::MacroStep::Ignore(_)) => {}
                Ok(macros::MacroStep::Offset) => reader.set_tables(&interpreter.variables().tables),
                Ok(macros::MacroStep::Busy) => now = now.after(SLICE),
                // M99 in a main program: the following text has been executed before.
                Ok(
                    macros::MacroStep::Restart | macros::MacroStep::Starved | macros::MacroStep::End(Ending::Program),
                ) => break,
                Ok(macros::MacroStep::End(Ending::Text)) => {
                    let end = SourceLine { library: None, line: lines.len() as u32 };
                    found.add(Fault::alarm(Alarm::EndOfRecord, 0), end, &[], b"");
                    break;
                }
                Err(ProgramFault { fault, place, calls, message }) => {
                    found.add(fault, place, &calls, &message);
                    break;
                }
            }
        }
        found.stop_contour();
        (found.list, moves, run)
    }
}

/// Line in the main program's file; for a place in the library that of the call that led to it.
fn in_main(place: SourceLine, calls: &[SourceLine]) -> SourceLine {
    let call = || calls.iter().rev().find(|call| call.library.is_none()).copied().unwrap_or_default();
    if place.library.is_none() { place } else { call() }
}

fn context(reader: &Reader, now: Micros) -> Context {
    Context::with_length(reader.modal(), reader.machine(), now)
}

/// Faults found so far.
struct Findings<'a> {
    lines: &'a [ProgramLine],
    folder: Option<&'a Folder>,
    contours: ContourCheck<usize>,
    reported: BTreeSet<(Option<u32>, u32, u16)>,
    list: Vec<Diagnostic>,
}

impl<'a> Findings<'a> {
    fn new(lines: &'a [ProgramLine], folder: Option<&'a Folder>, settings: &Settings) -> Self {
        let (contours, reported) = (ContourCheck::new(settings), BTreeSet::new());
        Findings { lines, folder, contours, reported, list: Vec::new() }
    }

    fn read(&mut self, reader: &mut Reader, block: &PlainBlock, reading: Reading) -> Option<InterpretedLine> {
        let line = in_main(block.place, &block.calls).line as usize;
        match reader.read(&block.text) {
            Ok(understood) => {
                let of_contour = self.contours.add(&understood, reader, line);
                self.add_contour(of_contour);
                if understood.lacks_feed() && self.is_new(0, block.place) {
                    let text = self.text(block.place);
                    self.list.push(Diagnostic::of_missing_feed(block.place.line as usize, &text, reading));
                }
                Some(understood)
            }
            Err(fault) => {
                self.stop_contour();
                self.add(block.in_source(fault), block.place, &block.calls, b"");
                None
            }
        }
    }

    fn stop_contour(&mut self) {
        let of_contour = self.contours.stop();
        self.add_contour(of_contour);
    }

    /// Adds a finding in a contour, at its line in the main program's file.
    fn add_contour(&mut self, finding: Option<ContourFinding<usize>>) {
        let Some(finding) = finding else { return };
        let text = |line: usize| self.lines.get(line.saturating_sub(1)).map_or(&[][..], |line| line.text.as_slice());
        let diagnostic = finding.diagnostic(|line| (line.max(1), text(line)));
        let place = SourceLine { library: None, line: diagnostic.line as u32 };
        if self.is_new(diagnostic.column as u16, place) {
            self.list.push(diagnostic);
        }
    }

    fn is_new(&mut self, column: u16, place: SourceLine) -> bool {
        self.reported.len() < FAULTS_MAX && self.reported.insert((place.library, place.line, column))
    }

    fn text(&self, place: SourceLine) -> Vec<u8> {
        let line = self.lines.get((place.line as usize).saturating_sub(1));
        line.map(|line| line.text.clone()).unwrap_or_default()
    }

    /// Adds a fault. A fault in a program of the library is reported at the call in the main program's file that led to
    /// it.
    fn add(&mut self, fault: Fault, place: SourceLine, calls: &[SourceLine], message: &[u8]) {
        if !self.is_new(fault.column, place) {
            return;
        }
        let (own, inner) = match place.library {
            None => ((place, fault), None),
            Some(number) => ((in_main(place, calls), Fault { column: 0, ..fault }), Some(number)),
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
