//! Programs with macro statements: interpreted to their end, as a control with them in memory would run them.
//!
//! Time advances by one millisecond per slice of statements only, so that a program that waits for a timer continues.
//! The first macro alarm ends the program. Faults of plain blocks are collected, each once for its place.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use arcfeed_nc::alarm::{Alarm, Cause, Fault, NotModelled};
use arcfeed_nc::block::{Notice, NoticeKind, Parsed, Reading, is_title, parse_line};
use arcfeed_nc::macro_alarm::MacroAlarm;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::settings::{Settings, Tables};
use arcfeed_nc::text::{Lines, RawLine};
use arcfeed_nc::word::{column, is_mark, small_letter};
use arcfeed_nc_macro::interpreter::Interpreter;
use arcfeed_nc_macro::program::{Library, first_macro};
use arcfeed_nc_macro::stack::{Bounds, SourceLine};
use arcfeed_nc_macro::step::{Ending, MacroSettings, MacroStep, PlainBlock, ProgramFault};
use arcfeed_nc_macro::variables::{Context, Ignored, OutsideValues};
use arcfeed_units::Micros;

use super::advice::is_flow_word;
use super::contour_check::contour_diagnostics;
use super::diagnostic::is_blank;
use super::library::Folder;
use super::lines::lines_read;
use super::run_faults::{RunFaults, in_main};
use super::{Diagnostic, MoveTrace, PathSummary, Program, ProgramSummary};
use crate::clock::Instant;

/// Reason for which an adapted program must not start again by itself.
const RESTARTS: &str = "it would start the program again with the last feed in force; end it with M30";
/// Interpreted time of a slice of statements.
const SLICE: Micros = Micros::from_ms(1);

/// Limits for interpreting a program with macro statements, which might not end.
#[derive(Clone, Copy, Debug)]
pub struct RunBounds {
    /// Largest number of blocks in all, and of statements between two moves.
    pub blocks: u32,
    /// Longest time that the interpreter may take.
    pub time: Duration,
    /// The command has options that raise these limits, which messages then name.
    pub has_options: bool,
}

impl Default for RunBounds {
    /// Two million blocks, a minute.
    fn default() -> Self {
        RunBounds { blocks: 2_000_000, time: Duration::from_secs(60), has_options: false }
    }
}

impl RunBounds {
    /// Describes the bound that is reached, with the setting that raises it.
    fn check(&self, step: &Result<MacroStep, ProgramFault>, blocks: u32, time: Duration) -> Option<String> {
        let is_endless = |trouble: &ProgramFault| trouble.fault.cause == Cause::Macro(MacroAlarm::Endless);
        let (bound, option) = match step {
            Err(trouble) if is_endless(trouble) => {
                (format!("{} statements since the last move", self.blocks), "--max-blocks")
            }
            Ok(MacroStep::Block(_)) if blocks >= self.blocks => (format!("at most {}", self.blocks), "--max-blocks"),
            Ok(_) if time > self.time => (format!("{} s", self.time.as_secs()), "--max-seconds"),
            _ => return None,
        };
        let remedy = if self.has_options { format!("; {option} raises the bound") } else { String::new() };
        Some(format!("{blocks} blocks executed, {bound}{remedy}"))
    }
}

/// Settings for interpreting a program with macro statements.
#[derive(Clone, Debug)]
pub struct Expansion<'a> {
    /// Settings of the control.
    pub settings: Settings,
    /// Offsets of the control.
    pub tables: Tables,
    /// Folder with subprograms that are not in the program's file.
    pub library: Option<&'a Path>,
    /// The moves of the run are kept, for [`Program::executed_moves`].
    pub keeps_moves: bool,
    /// Limits of the run.
    pub bounds: RunBounds,
    /// Treatment of values that only the real control has, when the program reads one.
    pub outside: OutsideValues,
}

/// Step of an interpreted program.
pub enum ExecutedStep<'a> {
    /// A block; with its meaning, which is `None` if the block has a fault; and the control after it.
    Block(&'a PlainBlock, Option<&'a InterpretedLine>, &'a Reader),
    /// A stop with this message (#3000, #3006).
    Message(&'a [u8]),
    /// Output to the serial line (DPRNT and the like).
    Output,
    /// Change of the functions that the program makes the control ignore (#3004).
    Ignored(Ignored),
}

/// Result of interpreting a program to its end.
pub struct RunEnd {
    /// Errors and warnings in the order in which they were found.
    pub found: Vec<Diagnostic>,
    /// Number of executions of each called program, by O number.
    pub executions: BTreeMap<u32, u32>,
}

impl Program {
    /// Reads a program as a control runs it from memory: a program with macro statements or calls is interpreted to its
    /// end, one without them is read by [`Program::parse_with`]. A program without M02, M30 or M99 ends in PS5010.
    pub fn run(path: &Path, bytes: &[u8], expansion: Expansion<'_>) -> Self {
        if first_macro(bytes).is_none() {
            let mut program = Program::parse_with(path, bytes, expansion.settings, expansion.tables);
            program.diagnostics.extend(contour_diagnostics(bytes, expansion.settings, expansion.tables));
            program.diagnostics.sort_by_key(|diagnostic| (diagnostic.line, diagnostic.column));
            let summary = ProgramSummary::new(program.lines());
            if summary.blocks > 0 && !summary.may_end {
                let text = Lines::new(bytes).last().map(|line| line.text).unwrap_or_default();
                let fault = Fault::alarm(Alarm::EndOfRecord, 0);
                program.diagnostics.push(Diagnostic::of_fault(summary.lines, text, fault));
            }
            return program;
        }
        let mut program = Program::empty(path, bytes, &Reader::with(expansion.settings, expansion.tables));
        let (lines_read, mut has_trailer) = (lines_read(bytes), false);
        program.lines_alone = Some(lines_read);
        for (index, RawLine { text, .. }) in Lines::new(bytes).enumerate() {
            if index < lines_read {
                program.check_alone(index + 1, text, &expansion.settings);
            } else if !has_trailer && !is_blank(text) && !is_mark(text) {
                has_trailer = true;
                program.diagnostics.push(Diagnostic::of_text_behind_the_end(index + 1, text));
            }
        }
        let keeps_moves = expansion.keeps_moves;
        let mut path = PathSummary::new(expansion.settings.unit);
        path.add_tool_list(Lines::new(bytes).map(|line| line.text));
        let (moves, run) = (&mut program.moves, &mut program.run);
        let end = expansion.run(bytes, |step, _| {
            let ExecutedStep::Block(block, Some(understood), reader) = step else { return };
            moves.add(understood);
            let line = in_main(block.place, &block.calls).line as usize;
            let modal = reader.modal();
            path.add_block(line, understood, &modal.machining(), &modal.work_origin());
            if keeps_moves {
                run.extend(MoveTrace::of_block(line, understood, reader));
            }
        });
        program.run_summary = Some(path);
        program.executions = end.executions;
        program.diagnostics.extend(end.found);
        program.diagnostics.sort_by_key(|diagnostic| (diagnostic.line, diagnostic.column));
        program
    }

    /// Adds the diagnostics that a line of an interpreted program, counted from 1, has by itself.
    fn check_alone(&mut self, line: usize, text: &[u8], settings: &Settings) {
        let parsed = parse_line(text, settings.reading).ok();
        let numbers = |parsed: &Parsed| parsed.block.check_numbers(text, settings).ok().flatten();
        for notice in parsed.iter().flat_map(|parsed| parsed.notices.iter().copied().chain(numbers(parsed))) {
            self.diagnostics.push(Diagnostic::of_notice(line, text, notice));
        }
        let is_code = !is_title(text) && !is_mark(text);
        if let Some(offset) = small_letter(text).filter(|_| is_code) {
            let column = column(offset);
            match settings.reading {
                Reading::Strict => {
                    let fault = Fault::alarm(Alarm::Character, column);
                    self.diagnostics.push(Diagnostic::of_fault(line, text, fault));
                }
                // The reader of plain lines has noticed those that it can read.
                Reading::Lenient if parsed.is_none() => {
                    let notice = Notice { kind: NoticeKind::SmallLetter, column };
                    self.diagnostics.push(Diagnostic::of_notice(line, text, notice));
                }
                Reading::Lenient => {}
            }
        }
    }
}

impl Expansion<'_> {
    /// Interprets a program; passes each step to `each`, with the interpreter after it.
    pub(super) fn run(self, bytes: &[u8], mut each: impl FnMut(ExecutedStep<'_>, &Interpreter)) -> RunEnd {
        let folder = self.library.map(|path| Folder(path.to_owned()));
        let mut reader = Reader::with(self.settings, self.tables).at_unknown_position();
        let mut interpreter = self.interpreter(bytes, folder.clone(), &reader);
        let texts: Vec<&[u8]> = Lines::new(bytes).map(|line| line.text).collect();
        let flow_words = (1..).zip(&texts).filter(|(line, text)| *line <= lines_read(bytes) && is_flow_word(text));
        let flow_words: Vec<Diagnostic> = flow_words.map(|(line, text)| Diagnostic::of_flow_word(line, text)).collect();
        let (end, mut faults) = (texts.len() as u32, RunFaults::new(texts, folder.as_ref(), &self.settings));
        if !flow_words.is_empty() {
            // The order of the blocks is not known.
            return RunEnd { found: flow_words, executions: BTreeMap::new() };
        }
        let (mut now, mut blocks, started) = (Micros(0), 0, Instant::now());
        loop {
            let step = interpreter.next(&context(&reader, now));
            if let Some(reached) = self.bounds.check(&step, blocks, started.elapsed()) {
                let ProgramFault { fault, place, calls, .. } =
                    interpreter.stop(Fault::in_macro(MacroAlarm::Endless, 1));
                faults.add(fault, place, &calls, reached.as_bytes());
                break;
            }
            match step {
                Ok(MacroStep::Block(block)) => {
                    blocks += 1;
                    let understood = faults.read(&mut reader, &block, self.settings.reading);
                    each(ExecutedStep::Block(&block, understood.as_ref(), &reader), &interpreter);
                    if understood.is_some_and(|block| block.step.sets_data) {
                        interpreter.set_tables(reader.tables());
                    }
                }
                Ok(MacroStep::Output(_)) => each(ExecutedStep::Output, &interpreter),
                Ok(MacroStep::Message(text)) => each(ExecutedStep::Message(&text), &interpreter),
                Ok(MacroStep::Ignore(ignored)) => each(ExecutedStep::Ignored(ignored), &interpreter),
                Ok(MacroStep::Offset) => reader.set_tables(&interpreter.variables().tables),
                Ok(MacroStep::Busy) => now = now.after(SLICE),
                Ok(MacroStep::Restart) if self.outside != OutsideValues::Assumed => {
                    let (place, calls) = interpreter.place();
                    faults.add(Fault::not_modelled(NotModelled::MCode(99), 0), place, &calls, RESTARTS.as_bytes());
                    break;
                }
                // M99 in a main program: the following text has been executed before.
                Ok(MacroStep::Restart | MacroStep::Starved | MacroStep::End(Ending::Program)) => break,
                Ok(MacroStep::End(Ending::Text)) => {
                    faults.add(Fault::alarm(Alarm::EndOfRecord, 0), SourceLine { library: None, line: end }, &[], b"");
                    break;
                }
                Err(ProgramFault { fault, place, calls, message }) => {
                    faults.add(fault, place, &calls, &message);
                    break;
                }
            }
        }
        faults.stop_contour();
        RunEnd { found: faults.list, executions: interpreter.executions().clone() }
    }

    fn interpreter(&self, bytes: &[u8], folder: Option<Folder>, reader: &Reader) -> Interpreter {
        let library: Box<dyn Library> = match folder {
            Some(folder) => Box::new(folder),
            None => Box::new(()),
        };
        let settings = MacroSettings {
            block_delete: self.settings.delete_switches,
            bounds: Bounds { steps: self.bounds.blocks, ..Bounds::default() },
            outside: self.outside,
            ..MacroSettings::default()
        };
        let mut interpreter = Interpreter::new(bytes, library, settings, &context(reader, Micros(0)));
        interpreter.set_tables(&self.tables);
        interpreter
    }
}

fn context(reader: &Reader, now: Micros) -> Context {
    let context = Context::with_length(reader.modal(), reader.machine(), now);
    Context { is_position_known: reader.is_position_known(), ..context }
}
