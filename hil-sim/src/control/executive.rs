//! A program as the control reads it ahead: lines of the DNC line, or a text in memory with macros and subprograms.
//!
//! A control works macro statements out when it reads them ahead, not when the blocks before them are done; so does this
//! one, and #5001 and on are where the last block read ends. Statements take time: one slice of them a step. In DNC
//! operation the main program comes line by line; its subprograms are in the library.

use std::collections::VecDeque;

use arcfeed_shared::nc::alarm::{Alarm, Fault};
use arcfeed_shared::nc::block::Reading;
use arcfeed_shared::nc::macros::interpreter::Interpreter;
use arcfeed_shared::nc::macros::program::{Library, needs_interpreter};
use arcfeed_shared::nc::macros::stack::Place;
use arcfeed_shared::nc::macros::step::{Ending, PlainBlock, Settings, Step, Trouble};
use arcfeed_shared::nc::macros::variables::Context;
use arcfeed_shared::nc::modal::Stop;
use arcfeed_shared::reader::Reader;
use arcfeed_shared::units::{LengthUnit, Micros};

use super::reader::{Action, ReadBlock, action};

/// The program being read.
#[derive(Debug)]
pub struct Executive {
    reader: Reader,
    interpreter: Interpreter,
    /// A block that is none of the interpreter's: the fault of a mark where none belongs.
    pending: Option<ReadBlock>,
    line: u32,
    has_begun: bool,
    is_over: bool,
    output: Vec<u8>,
    messages: VecDeque<String>,
}

/// What comes next.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// A block.
    Block(Box<ReadBlock>),
    /// Nothing before the next step of time.
    Busy,
    /// Nothing before the next line.
    Starved,
    /// Nothing any more.
    Over,
}

/// Whether a text has macro statements or calls, and so must be in memory as a whole.
pub fn has_macros(text: &[u8]) -> bool {
    text.split(|&byte| byte == b'\n').any(needs_interpreter)
}

impl Executive {
    /// A program that comes line by line.
    pub fn on_line(unit: LengthUnit, library: Box<dyn Library>) -> Self {
        Executive::new(b"", unit, library, Settings { is_dnc: true, ..Settings::default() })
    }

    /// A program in memory; its subprograms stand behind it or in the library.
    pub fn in_memory(text: &[u8], unit: LengthUnit, library: Box<dyn Library>) -> Self {
        Executive::new(text, unit, library, Settings::default())
    }

    fn new(text: &[u8], unit: LengthUnit, library: Box<dyn Library>, settings: Settings) -> Self {
        let reader = Reader::new(unit, Reading::Lenient);
        let context = Context::new(reader.modal(), Micros(0));
        let interpreter = Interpreter::new(text, library, settings, &context);
        Executive {
            reader,
            interpreter,
            pending: None,
            line: 0,
            has_begun: false,
            is_over: false,
            output: Vec::new(),
            messages: VecDeque::new(),
        }
    }

    /// Takes a line, when [`Next::Starved`]; `%` and empty lines are no blocks.
    pub fn take(&mut self, text: &[u8]) {
        self.line += 1;
        let is_mark = text.first() == Some(&b'%');
        // The first mark begins the program, the next one ends it: a program that has not stopped before has no end.
        if is_mark && self.has_begun {
            let action = Action::Fault(Fault::alarm(Alarm::EndOfRecord, 1));
            self.pending = Some(ReadBlock { line: self.line, text: text.to_vec(), action });
        } else if !is_mark {
            self.interpreter.feed(text, self.line);
        }
        self.has_begun |= !text.is_empty();
    }

    /// The next block at `now`.
    pub fn next(&mut self, now: Micros) -> Next {
        if let Some(block) = self.pending.take() {
            return Next::Block(Box::new(block));
        }
        while !self.is_over {
            let context = Context::new(self.reader.modal(), now);
            match self.interpreter.next(&context) {
                Ok(Step::Block(block)) => return Next::Block(Box::new(self.read(block))),
                Ok(Step::Output(bytes)) => self.output.extend(bytes),
                Ok(Step::Message(text)) => return Next::Block(Box::new(self.wait_with(&text))),
                Ok(Step::Restart) => {}
                Ok(Step::Busy) => return Next::Busy,
                Ok(Step::Starved) => return Next::Starved,
                Ok(Step::End(ending)) => {
                    self.is_over = true;
                    if ending == Ending::Text {
                        let fault = Fault::alarm(Alarm::EndOfRecord, 0);
                        return Next::Block(Box::new(self.block(Action::Fault(fault))));
                    }
                }
                Err(trouble) => {
                    self.is_over = true;
                    return Next::Block(Box::new(self.stop(&trouble)));
                }
            }
        }
        Next::Over
    }

    /// The line read last, counted from 1.
    pub fn line(&self) -> u32 {
        self.line
    }

    /// What the program has sent to the punch.
    pub fn output(&self) -> &[u8] {
        &self.output
    }

    /// Messages of `#3006` and `#3000`, and where in a called program an alarm came up.
    pub fn messages(&self) -> impl Iterator<Item = &str> {
        self.messages.iter().map(String::as_str)
    }

    fn read(&mut self, block: PlainBlock) -> ReadBlock {
        let action = match self.reader.read(&block.text) {
            Ok(understood) => action(&understood),
            Err(fault) => Action::Fault(block.in_source(fault)),
        };
        self.line = main_line(block.place, &block.calls);
        ReadBlock { line: self.line, text: block.text, action }
    }

    fn wait_with(&mut self, message: &[u8]) -> ReadBlock {
        let message = String::from_utf8_lossy(message).into_owned();
        let text = format!("({message})").into_bytes();
        self.messages.push_back(message);
        ReadBlock { text, ..self.block(Action::Stop(Stop::Program)) }
    }

    fn stop(&mut self, trouble: &Trouble) -> ReadBlock {
        let Trouble { fault, place, calls, message } = trouble;
        if !message.is_empty() {
            self.messages.push_back(String::from_utf8_lossy(message).into_owned());
        }
        if let Some(program) = place.library {
            self.messages.push_back(format!("in O{program}, line {}, column {}", place.line, fault.column));
        }
        self.line = main_line(*place, calls);
        self.block(Action::Fault(*fault))
    }

    fn block(&self, action: Action) -> ReadBlock {
        ReadBlock { line: self.line, text: Vec::new(), action }
    }
}

/// The line of the main program's file to which a place belongs: its own, or that of the call that led to it.
fn main_line(place: Place, calls: &[Place]) -> u32 {
    let of_main = |place: &&Place| place.library.is_none();
    std::iter::once(&place).chain(calls.iter().rev()).find(of_main).map_or(0, |place| place.line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_shared::nc::alarm::Cause;
    use arcfeed_shared::nc::macro_alarm::MacroAlarm;

    fn actions(program: &str) -> Vec<Action> {
        let mut executive = Executive::on_line(LengthUnit::Inch, Box::new(()));
        let mut actions = Vec::new();
        for line in program.lines() {
            executive.take(line.as_bytes());
            while let Next::Block(block) = executive.next(Micros(0)) {
                actions.push(block.action);
            }
        }
        actions
    }

    #[test]
    fn marks_and_empty_lines_are_no_blocks() {
        assert_eq!(actions("%\n\nOTITLE\n(NOTE)\nG20\n"), vec![Action::Nothing; 3]);
    }

    #[test]
    fn the_mark_behind_a_program_that_has_no_end_is_an_alarm() {
        assert_eq!(actions("%\nG20\n%").last(), Some(&Action::Fault(Fault::alarm(Alarm::EndOfRecord, 1))));
    }

    #[test]
    fn a_cutting_move_without_feed_stops_the_control() {
        assert_eq!(actions("G1X1."), [Action::Fault(Fault::alarm(Alarm::NoFeed, 0))]);
        assert!(matches!(actions("G0X1.").as_slice(), [Action::Move(..)]));
    }

    #[test]
    fn a_program_may_end_in_the_block_of_its_last_move() {
        assert!(matches!(actions("G0X1.M30").as_slice(), [Action::Move(_, Some(Stop::End))]));
    }

    #[test]
    fn auxiliary_functions_are_told_from_modal_words() {
        assert_eq!(
            actions("M8\nT1\nS1000M3\nG64"),
            [Action::Auxiliary, Action::Auxiliary, Action::Auxiliary, Action::Nothing]
        );
    }

    #[test]
    fn over_the_line_variables_work_and_jumps_are_refused() {
        let moves = actions("#1=2.\nG0X#1");
        assert!(matches!(moves.as_slice(), [Action::Move(segment, None)] if segment.end.linear[0].to_mm() == 50.8));
        for line in ["GOTO5", "IF[1EQ1]GOTO5", "WHILE[1EQ1]DO1", "DO1"] {
            let refused = actions(line);
            let Some(Action::Fault(fault)) = refused.last() else { panic!("{line}: {refused:?}") };
            assert_eq!(fault.cause, Cause::Macro(MacroAlarm::NotInDnc), "{line}");
        }
    }
}
