//! Call stack: the programs in memory, the running ones, and the modal calls of G66.

use alloc::boxed::Box;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use super::program::{File, Library, LineRange};
use super::variables::Locals;
use arcfeed_nc::alarm::Fault;
use arcfeed_nc::macro_alarm::MacroAlarm;

/// Position of a line: the file of its program, and the line number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct SourceLine {
    /// Number of the library program whose file contains the line; `None` for the main program's file.
    pub library: Option<u32>,
    /// Line, counted from 1.
    pub line: u32,
}

/// Limits of the interpreter for nesting, statements and memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Maximum nesting of subprograms (M98).
    pub subprograms: usize,
    /// Maximum nesting of macros (G65, G66, G66.1).
    pub macros: usize,
    /// Maximum number of statements between two moves.
    pub steps: u32,
    /// Maximum number of statements that one call of [`super::interpreter::Interpreter::next`] executes.
    pub slice: u32,
    /// Maximum size of all library programs, bytes.
    pub memory: usize,
}

impl Default for Bounds {
    /// Four and four as on a 16i, a million statements, 16 MB.
    fn default() -> Self {
        Bounds { subprograms: 4, macros: 4, steps: 1_000_000, slice: 1_000, memory: 16 << 20 }
    }
}

/// A call of a subprogram or a macro.
#[derive(Clone, Debug)]
pub struct Call {
    /// Number of the program (O).
    pub number: u32,
    /// Number of times that the program is executed.
    pub repeats: u32,
    /// Local variables #1 to #33 of a called macro; `None` for a subprogram, which shares those of its caller.
    pub arguments: Option<Box<Locals>>,
    /// Whether it is a modal call (G66, G66.1).
    pub is_modal: bool,
    /// Whether the program is not searched in the main program's file (M198).
    pub is_external: bool,
    /// Column, in the calling line, of the program's number.
    pub column: u16,
}

/// The blocks at which a modal macro call is executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModalCallTiming {
    /// After blocks that move an axis (G66).
    AfterMoves,
    /// At every block (G66.1).
    EveryBlock,
}

/// A running program and where it stands.
#[derive(Clone, Debug)]
pub struct CallFrame {
    file: usize,
    span: LineRange,
    /// The line to execute next, counted from 0 in its file.
    pub line: u32,
    number: u32,
    repeats_left: u32,
    arguments: Option<Box<Locals>>,
    callers: Option<Box<Locals>>,
    is_modal: bool,
    /// Line from which this program was called.
    pub from: SourceLine,
}

/// Stack of running programs, the main program first.
#[derive(Debug)]
pub struct Stack {
    files: Vec<(Option<u32>, File)>,
    library: Box<dyn Library>,
    library_bytes: usize,
    frames: Vec<CallFrame>,
    modal: Vec<(ModalCallTiming, Call)>,
    /// Number of modal calls that are running and therefore not called again.
    masked: usize,
    /// Number of lines of a main program in DNC operation before the current one.
    lines_before: u32,
    executions: BTreeMap<u32, u32>,
}

impl Stack {
    /// A stack ready to execute the first program of a text.
    pub fn new(main: File, library: Box<dyn Library>) -> Self {
        let span = main.main();
        let mut stack = Stack {
            files: Vec::from([(None, main)]),
            library,
            library_bytes: 0,
            frames: Vec::new(),
            modal: Vec::new(),
            masked: 0,
            lines_before: 0,
            executions: BTreeMap::new(),
        };
        stack.frames.extend(span.map(|span| CallFrame {
            file: 0,
            span,
            line: span.first,
            number: 0,
            repeats_left: 0,
            arguments: None,
            callers: None,
            is_modal: false,
            from: SourceLine::default(),
        }));
        stack
    }

    /// Sets the source of programs that are not loaded yet.
    pub fn set_library(&mut self, library: Box<dyn Library>) {
        self.library = library;
    }

    /// Ends all called programs, and cancels all modal calls.
    pub fn reset(&mut self) {
        self.frames.truncate(1);
        self.modal.clear();
        self.masked = 0;
    }

    /// Replaces the line of a main program in DNC operation by the next one.
    pub fn feed(&mut self, line: &[u8], number: u32) {
        self.lines_before = number.saturating_sub(1);
        let file = File::new(line);
        if let (Some(frame), Some(span)) = (self.frames.first_mut(), file.main()) {
            frame.span = span;
            frame.line = 0;
        }
        if let Some((_, main)) = self.files.first_mut() {
            *main = file;
        }
    }

    /// The running program with its file.
    pub fn top(&mut self) -> Option<(&mut CallFrame, &File)> {
        let frame = self.frames.last_mut()?;
        let (_, file) = self.files.get(frame.file)?;
        Some((frame, file))
    }

    /// Whether the main program is running.
    pub fn is_in_main(&self) -> bool {
        self.frames.len() <= 1
    }

    /// Position of a line of the running program; `index` counts from 0 in its file.
    pub fn place(&self, index: u32) -> SourceLine {
        let library = self.frames.last().and_then(|frame| self.files.get(frame.file)?.0);
        let is_of_main = self.frames.last().is_some_and(|frame| frame.file == 0);
        let before = if is_of_main { self.lines_before } else { 0 };
        SourceLine { library, line: before.saturating_add(index).saturating_add(1) }
    }

    /// Lines from which the running programs were called, the main program's call first.
    pub fn calls(&self) -> Vec<SourceLine> {
        self.frames.iter().skip(1).map(|frame| frame.from).collect()
    }

    /// Number of executions of each called program, by O number.
    pub fn executions(&self) -> &BTreeMap<u32, u32> {
        &self.executions
    }

    fn count(&mut self, number: u32) {
        let count = self.executions.entry(number).or_default();
        *count = count.saturating_add(1);
    }

    /// Starts a called program.
    ///
    /// # Errors
    /// PS0077, PS0078, PS0122, or a library that is too large.
    pub fn enter(&mut self, call: Call, from: SourceLine, locals: &mut Locals, bounds: &Bounds) -> Result<(), Fault> {
        let fault = |alarm| Fault::in_macro(alarm, call.column);
        let macros = self.frames.iter().filter(|frame| frame.arguments.is_some()).count();
        let subprograms = self.frames.len().saturating_sub(macros + 1);
        match &call.arguments {
            Some(_) if macros >= bounds.macros => return Err(fault(MacroAlarm::MacroNesting)),
            None if subprograms >= bounds.subprograms => return Err(fault(MacroAlarm::SubprogramNesting)),
            _ => {}
        }
        let (file, span) = self.find(&call, bounds.memory).map_err(fault)?;
        let Some(repeats_left) = call.repeats.checked_sub(1) else { return Ok(()) };
        let callers = call.arguments.as_ref().map(|arguments| Box::new(core::mem::replace(locals, **arguments)));
        self.masked += usize::from(call.is_modal);
        let Call { number, arguments, is_modal, .. } = call;
        self.count(number);
        let line = span.first;
        self.frames.push(CallFrame { file, span, line, number, repeats_left, arguments, callers, is_modal, from });
        Ok(())
    }

    /// Finds a program in the loaded files, then in the library.
    fn find(&mut self, call: &Call, memory: usize) -> Result<(usize, LineRange), MacroAlarm> {
        let Call { number, is_external, .. } = *call;
        let known = |(index, (name, file)): (usize, &(Option<u32>, File))| {
            if is_external && name.is_none() {
                return None;
            }
            let named = file.main().filter(|_| *name == Some(number));
            Some((index, file.program(number).or(named)?))
        };
        if let Some(found) = self.files.iter().enumerate().find_map(known) {
            return Ok(found);
        }
        let text = self.library.load(number).ok_or(MacroAlarm::ProgramNotFound)?;
        self.library_bytes = self.library_bytes.saturating_add(text.len());
        if self.library_bytes > memory {
            return Err(MacroAlarm::TooLarge);
        }
        self.files.push((Some(number), File::new(&text)));
        self.files.iter().enumerate().find_map(known).ok_or(MacroAlarm::ProgramNotFound)
    }

    /// Executes M99: starts the running program again if repetitions remain, otherwise returns to its caller, at the
    /// block with the given sequence number if there is one. Returns false if the main program runs, which then starts
    /// again.
    ///
    /// # Errors
    /// PS0078 if there is no such block.
    pub fn leave(&mut self, sequence: Option<(u32, u16)>, locals: &mut Locals) -> Result<bool, Fault> {
        let is_main = self.is_in_main();
        let Some(frame) = self.frames.last_mut() else { return Ok(false) };
        if is_main {
            frame.line = frame.span.first;
        } else if frame.repeats_left > 0 && sequence.is_none() {
            frame.repeats_left -= 1;
            frame.line = frame.span.first;
            frame.arguments.iter().for_each(|arguments| *locals = **arguments);
            let number = frame.number;
            self.count(number);
        } else {
            self.masked -= usize::from(frame.is_modal);
            frame.callers.iter().for_each(|callers| *locals = **callers);
            self.frames.pop();
        }
        if let Some((number, column)) = sequence {
            self.jump(number).ok_or(Fault::in_macro(MacroAlarm::ProgramNotFound, column))?;
        }
        Ok(!is_main)
    }

    /// Continues the running program at the block with this sequence number; `None` if there is no such block.
    pub fn jump(&mut self, number: u32) -> Option<()> {
        let (frame, file) = self.top()?;
        frame.line = file.find(number, frame.span, frame.line)?;
        Some(())
    }

    /// Executes GOTO in line `from`, counted from 0 in its file.
    ///
    /// # Errors
    /// PS0128 if there is no such block; PS0124 if it lies in a loop that does not contain this line.
    pub fn go_to(&mut self, number: u32, from: u32) -> Result<(), MacroAlarm> {
        let (frame, file) = self.top().ok_or(MacroAlarm::SequenceNumber)?;
        let line = file.find(number, frame.span, from).ok_or(MacroAlarm::SequenceNumber)?;
        if file.enters_loop(from, line) {
            return Err(MacroAlarm::EndMissing);
        }
        frame.line = line;
        Ok(())
    }

    /// Whether the running program is at the end of its text.
    pub fn is_at_end(&self) -> bool {
        self.frames.last().is_none_or(|frame| frame.line >= frame.span.end)
    }

    /// The modal macro call that has to be executed now, if there is one. Its faults are reported for the whole block
    /// (column 0).
    pub fn modal_call(&self, when: ModalCallTiming) -> Option<Call> {
        let active = self.modal.len().checked_sub(self.masked + 1)?;
        let call = self.modal.get(active).filter(|(of, _)| *of == when).map(|(_, call)| call.clone());
        call.map(|call| Call { column: 0, ..call })
    }

    /// Executes G66 or G66.1. Returns false if a modally called macro is running, in which another modal call is not
    /// allowed.
    ///
    /// # Errors
    /// PS0122 for too deep nesting.
    pub fn set_modal(&mut self, when: ModalCallTiming, call: Call, bounds: &Bounds) -> Result<bool, Fault> {
        if self.modal.len() >= bounds.macros {
            return Err(Fault::in_macro(MacroAlarm::MacroNesting, call.column));
        }
        if self.masked == 0 {
            self.modal.push((when, call));
        }
        Ok(self.masked == 0)
    }

    /// Executes G67, which cancels the last modal call. Returns false if the macro of that call is running.
    pub fn cancel_modal(&mut self) -> bool {
        if self.masked == 0 {
            self.modal.pop();
        }
        self.masked == 0
    }
}
