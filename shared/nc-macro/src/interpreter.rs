//! Interpreter of macro programs: executes statements and returns the next action of the control.

mod blocks;

use alloc::boxed::Box;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use super::calls::{Continuation, SEQUENCE_MAX};
use super::code::{CodeCursor, Head, MacroCode};
use super::expression::{Evaluator, whole};
use super::print;
use super::program::{File, Library, ProgramLine, needs_interpreter};
use super::stack::{ModalCallTiming, SourceLine, Stack};
use super::step::{Ending, MacroSettings, MacroStep, PlainBlock, ProgramFault};
use super::variables::{Context, Effect, OutsideValues, SwitchedValues, Variables};
use arcfeed_nc::alarm::{Alarm, Fault, NotModelled};
use arcfeed_nc::macro_alarm::MacroAlarm;
use arcfeed_nc::settings::Tables;

/// Next action of the control; `None` if a statement asks for none.
type StepResult = Result<Option<MacroStep>, Fault>;

/// Executes a program with macro statements and calls, and returns one action of the control after the other.
#[derive(Debug)]
pub struct Interpreter {
    settings: MacroSettings,
    stack: Stack,
    variables: Variables,
    then: Continuation,
    /// The line in execution, counted from 0 in its file, and its place.
    index: u32,
    place: SourceLine,
    steps: u32,
    message: Vec<u8>,
}

impl Interpreter {
    /// Interpreter at the start of the first program in `text`; `library` supplies subprograms that are not in it. In
    /// DNC operation [`Interpreter::feed`] supplies the lines of the main program.
    pub fn new(text: &[u8], library: Box<dyn Library>, settings: MacroSettings, context: &Context) -> Self {
        let mut variables = Variables::new(*context);
        variables.outside = settings.outside;
        Interpreter {
            settings,
            stack: Stack::new(File::new(text), library),
            variables,
            then: Continuation::GoOn,
            index: 0,
            place: SourceLine::default(),
            steps: 0,
            message: Vec::new(),
        }
    }

    /// Supplies the line with this number of the main program, in DNC operation after [`MacroStep::Starved`].
    pub fn feed(&mut self, line: &[u8], number: u32) {
        self.stack.feed(line, number);
    }

    /// Sets the block-delete switches: bit n is 1 if that of `/n` is on.
    pub fn set_block_delete(&mut self, switches: u16) {
        self.settings.block_delete = switches;
    }

    /// Continues at the block with this sequence number of the running program. Returns whether there is one.
    pub fn seek(&mut self, sequence: u32) -> bool {
        self.stack.jump(sequence).is_some()
    }

    /// Sets the source of subprograms that are not in the main program's file.
    pub fn set_library(&mut self, library: Box<dyn Library>) {
        self.stack.set_library(library);
    }

    /// Sets the offsets: initially, and after a block that wrote some with G10.
    pub fn set_tables(&mut self, tables: &Tables) {
        *self.variables.tables = *tables;
    }

    /// Does what the control's reset key does: ends called programs, and clears the local variables and #100 to #199.
    /// Offsets and the common variables from #500 on stay.
    pub fn reset(&mut self) {
        self.stack.reset();
        self.variables.reset();
        (self.then, self.steps) = (Continuation::GoOn, 0);
    }

    /// The variables.
    pub fn variables(&self) -> &Variables {
        &self.variables
    }

    /// The variables, mutable, to preset common ones.
    pub fn variables_mut(&mut self) -> &mut Variables {
        &mut self.variables
    }

    /// The line executed last, and the lines from which the running programs were called, that in the main program
    /// first.
    pub fn place(&self) -> (SourceLine, Vec<SourceLine>) {
        (self.place, self.stack.calls())
    }

    /// Number of executions of each called program, by O number.
    pub fn executions(&self) -> &BTreeMap<u32, u32> {
        self.stack.executions()
    }

    /// Ends the program with this fault, at the line executed last.
    pub fn stop(&mut self, fault: Fault) -> ProgramFault {
        self.then = Continuation::End(Ending::Program);
        let (place, calls) = self.place();
        ProgramFault { fault, place, calls, message: core::mem::take(&mut self.message) }
    }

    /// Executes statements up to the next action of the control; `context` is the current state of the control.
    ///
    /// # Errors
    /// The alarm with which the control stops; the program has then ended.
    pub fn next(&mut self, context: &Context) -> Result<MacroStep, ProgramFault> {
        self.variables.context = *context;
        for _ in 0..self.settings.bounds.slice {
            match self.advance() {
                Ok(None) => {}
                Ok(Some(step)) => return Ok(step),
                Err(fault) => return Err(self.stop(fault)),
            }
        }
        Ok(MacroStep::Busy)
    }

    fn advance(&mut self) -> StepResult {
        match core::mem::take(&mut self.then) {
            Continuation::GoOn => {}
            Continuation::Call(call) => {
                self.stack.enter(*call, self.place, &mut self.variables.locals, &self.settings.bounds)?;
            }
            Continuation::Return(sequence) => return self.leave(sequence),
            Continuation::End(ending) => {
                self.then = Continuation::End(ending);
                return Ok(Some(MacroStep::End(ending)));
            }
        }
        if self.stack.is_at_end() {
            return self.at_end_of_text();
        }
        let Some((frame, file)) = self.stack.top() else { return Ok(None) };
        self.index = frame.line;
        frame.line += 1;
        let Some(line) = file.line(self.index).cloned() else { return Ok(None) };
        self.place = self.stack.place(self.index);
        self.steps += 1;
        if self.steps > self.settings.bounds.steps {
            return Err(Fault::in_macro(MacroAlarm::Endless, 1));
        }
        self.execute(line)
    }

    fn at_end_of_text(&mut self) -> StepResult {
        if !self.stack.is_in_main() {
            return Err(Fault::alarm(Alarm::EndOfRecord, 0));
        }
        if self.settings.is_dnc {
            return Ok(Some(MacroStep::Starved));
        }
        self.then = Continuation::End(Ending::Text);
        Ok(None)
    }

    fn leave(&mut self, sequence: Option<(u32, u16)>) -> StepResult {
        if self.stack.is_in_main() && self.settings.is_dnc {
            return Err(Fault::not_modelled(NotModelled::MCode(99), 1));
        }
        let has_returned = self.stack.leave(sequence, &mut self.variables.locals)?;
        Ok((!has_returned).then_some(MacroStep::Restart))
    }

    fn execute(&mut self, line: ProgramLine) -> StepResult {
        let code = MacroCode::new(&line.text);
        let mut cursor = code.cursor();
        let head = Head::read(&mut cursor);
        let is_off = |switch: u32| self.settings.block_delete.checked_shr(switch).unwrap_or(0) & 1 == 0;
        if head.delete.is_some() && self.settings.outside != OutsideValues::Assumed {
            return self.switched(line, cursor, &code, head.delete.is_none_or(is_off));
        }
        if line.text.is_empty() || !head.delete.is_none_or(is_off) {
            return Ok(None);
        }
        let is_block = !matches!(cursor.peek(), None | Some(b'O' | b':'));
        let calls_macro = is_block && self.stack.modal_call(ModalCallTiming::EveryBlock).is_some();
        if line.is_plain && !calls_macro {
            let code =
                if is_block || head.program.is_some() || head.sequence.is_some() { code } else { MacroCode::default() };
            return Ok(Some(self.emit(line.text, Vec::new(), &code)));
        }
        self.statement(&head, cursor, &code)
    }

    /// Emits a block with a `/` whatever its switch is: who reads the blocks as executed skips it. The order of execution must
    /// not depend on the block, nor the value of a variable.
    fn switched(
        &mut self,
        line: ProgramLine,
        cursor: CodeCursor<'_>,
        code: &MacroCode,
        is_executed: bool,
    ) -> StepResult {
        let timings = [ModalCallTiming::EveryBlock, ModalCallTiming::AfterMoves];
        let calls_macro = timings.into_iter().any(|timing| self.stack.modal_call(timing).is_some());
        let ends = self.variables.codes.clone().apply_block(code.cursor()).ends;
        if !line.is_plain || calls_macro || ends || matches!(cursor.peek(), Some(b'O' | b':')) {
            return Err(Fault::not_modelled(NotModelled::SwitchedStatement, 1));
        }
        let has_other = cursor.rest().iter().any(|byte| byte.is_ascii_uppercase() && !matches!(byte, b'M' | b'N'));
        let switched = if has_other { SwitchedValues::All } else { SwitchedValues::Functions };
        self.variables.switched = self.variables.switched.max(switched);
        if is_executed {
            return Ok(Some(self.emit(line.text, Vec::new(), code)));
        }
        let (text, place, calls) = (line.text, self.place, self.stack.calls());
        Ok(Some(MacroStep::Block(PlainBlock { text, place, calls, columns: Vec::new() })))
    }

    fn statement(&mut self, head: &Head, mut cursor: CodeCursor<'_>, code: &MacroCode) -> StepResult {
        let begin = cursor.column();
        if cursor.peek() == Some(b'#') {
            return self.assign(cursor, code);
        }
        if cursor.accept_keyword(b"IF") {
            return self.condition(cursor, code);
        }
        if cursor.accept_keyword(b"GOTO") {
            return self.go_to(cursor, begin, true);
        }
        if cursor.accept_keyword(b"WHILE") {
            let holds = self.evaluator().bracketed(&mut cursor)?;
            return self.begin_loop(cursor, begin, holds.unwrap_or(0.0) != 0.0);
        }
        if cursor.letters() == b"DO" {
            return self.begin_loop(cursor, begin, true);
        }
        if cursor.accept_keyword(b"END") {
            self.refuse_in_dnc(begin)?;
            cursor.loop_number()?;
            let (frame, file) = self.stack.top().ok_or(Fault::in_macro(MacroAlarm::EndMissing, begin))?;
            frame.line = file.other_end(self.index).ok_or(Fault::in_macro(MacroAlarm::EndMissing, begin))?;
            return Ok(None);
        }
        if let Some(output) = print::statement(&mut cursor, self.evaluator(), self.settings.print)? {
            return cursor.finish().map(|()| Some(MacroStep::Output(output)));
        }
        self.block(head, cursor)
    }

    fn evaluator(&self) -> Evaluator<'_> {
        Evaluator::new(&self.variables, self.settings.angles)
    }

    fn assign(&mut self, mut cursor: CodeCursor<'_>, code: &MacroCode) -> StepResult {
        let column = cursor.column();
        cursor.skip(1);
        let number = self.evaluator().variable_number(&mut cursor)?;
        if !cursor.accept(b"=") {
            return Err(cursor.fault(MacroAlarm::ExpressionFormat));
        }
        let value = self.evaluator().expression(&mut cursor)?;
        cursor.finish()?;
        match self.variables.write(number, value).map_err(|cause| Fault { cause, column })? {
            Effect::Kept => Ok(None),
            Effect::Stop => Ok(Some(MacroStep::Message(code.comment.clone()))),
            Effect::Ignore => Ok(Some(MacroStep::Ignore(self.variables.ignored))),
            Effect::Offset if self.settings.outside == OutsideValues::Assumed => Ok(Some(MacroStep::Offset)),
            Effect::Offset if needs_interpreter(code.bytes()) => {
                Err(Fault::not_modelled(NotModelled::OffsetStatement(number), column))
            }
            // The external origin is zero anyhow; the statement remains a block.
            Effect::Offset => Ok(Some(self.emit(code.bytes().to_vec(), Vec::new(), code))),
            Effect::Alarm(alarm) => {
                self.message.clone_from(&code.comment);
                Err(Fault::in_macro(MacroAlarm::User(alarm), column))
            }
        }
    }

    fn condition(&mut self, mut cursor: CodeCursor<'_>, code: &MacroCode) -> StepResult {
        let holds = self.evaluator().bracketed(&mut cursor)?.unwrap_or(0.0) != 0.0;
        let is_then = cursor.accept(b"THEN");
        let begin = cursor.column();
        if cursor.accept_keyword(b"GOTO") {
            return self.go_to(cursor, begin, holds);
        }
        match cursor.peek() {
            _ if !is_then => Err(cursor.fault(MacroAlarm::StatementFormat)),
            _ if !holds => Ok(None),
            Some(b'#') => self.assign(cursor, code),
            _ => {
                let output = print::statement(&mut cursor, self.evaluator(), self.settings.print)?
                    .ok_or(cursor.fault(MacroAlarm::StatementFormat))?;
                cursor.finish().map(|()| Some(MacroStep::Output(output)))
            }
        }
    }

    fn go_to(&mut self, mut cursor: CodeCursor<'_>, begin: u16, goes: bool) -> StepResult {
        self.refuse_in_dnc(begin)?;
        if !goes {
            return Ok(None);
        }
        let column = cursor.column();
        let value = self.evaluator().factor(&mut cursor)?;
        cursor.finish()?;
        let number = whole(value, 1..=SEQUENCE_MAX).ok_or(MacroAlarm::SequenceNumber);
        let gone = number.and_then(|number| self.stack.go_to(number, self.index));
        gone.map(|()| None).map_err(|alarm| Fault::in_macro(alarm, column))
    }

    fn begin_loop(&mut self, mut cursor: CodeCursor<'_>, begin: u16, holds: bool) -> StepResult {
        self.refuse_in_dnc(begin)?;
        if !cursor.accept(b"DO") {
            return Err(cursor.fault(MacroAlarm::StatementFormat));
        }
        cursor.loop_number()?;
        let missing = Fault::in_macro(MacroAlarm::EndMissing, begin);
        let (frame, file) = self.stack.top().ok_or(missing)?;
        let end = file.other_end(self.index).ok_or(missing)?;
        if !holds {
            frame.line = end.saturating_add(1);
        }
        Ok(None)
    }

    fn refuse_in_dnc(&self, column: u16) -> Result<(), Fault> {
        let is_allowed = !(self.settings.is_dnc && self.stack.is_in_main());
        is_allowed.then_some(()).ok_or(Fault::in_macro(MacroAlarm::NotInDnc, column))
    }
}
