//! Programs with macro statements, calls and subprograms, as the control reads them ahead: one in memory, or one that comes
//! over the line and calls others in memory.
//!
//! A control works macro statements out when it reads them ahead, not when the blocks before them are done; so does this
//! one, and #5001 and on are where the last block read ends. Statements take time: one slice of them a step. What #3003 and
//! #3004 say counts from the next block on. Over the line GOTO, WHILE, DO and END are alarm PS0123.

use std::collections::VecDeque;

use arcfeed_shared::nc::alarm::{Alarm, Fault};
use arcfeed_shared::nc::macros::interpreter::Interpreter;
use arcfeed_shared::nc::macros::print::Output;
use arcfeed_shared::nc::macros::program::Library;
use arcfeed_shared::nc::macros::stack::Place;
use arcfeed_shared::nc::macros::step::{Ending, PlainBlock, Settings, Step, Trouble};
use arcfeed_shared::nc::macros::variables::{Context, Ignored};
use arcfeed_shared::nc::modal::{Pose, Stop};
use arcfeed_shared::nc::settings::Tables;
use arcfeed_shared::units::Micros;

use super::action::{Action, MoveContext, ReadBlock};
use super::plain::{Plain, PlainReader};
use super::restart::RestartList;
use super::search::{Approach, Found, Search, never};
use super::settings::{ControlSettings, Switches};

/// The program being read.
#[derive(Debug)]
pub struct Executive {
    reader: PlainReader,
    interpreter: Interpreter,
    line: u32,
    is_over: bool,
    /// A line of the DNC line, up to the block that it gives.
    fed: Option<Vec<u8>>,
    /// A block of a called program that comes behind the one of its call.
    pending: Option<ReadBlock>,
    outputs: Vec<Output>,
    messages: VecDeque<String>,
}

/// What comes next.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// A block.
    Block(Box<ReadBlock>),
    /// Nothing before the next step of time.
    Busy,
    /// Nothing before the next line of the DNC line.
    Starved,
    /// Nothing any more.
    Over,
}

impl Executive {
    /// At power-on, the axes at the origin; subprograms stand behind the program or in the library.
    pub fn new(text: &[u8], settings: &ControlSettings, library: Box<dyn Library>) -> Self {
        Executive::with(text, settings, library, false)
    }

    /// At power-on, the axes at the origin; the program comes by [`Executive::feed`].
    pub fn on_line(settings: &ControlSettings) -> Self {
        Executive::with(b"", settings, Box::new(()), true)
    }

    fn with(text: &[u8], settings: &ControlSettings, library: Box<dyn Library>, is_dnc: bool) -> Self {
        let reader = PlainReader::new(settings);
        let context = Context::with_length(reader.modal(), reader.machine(), Micros(0));
        let of_macros = Settings { is_dnc, ..Settings::default() };
        let mut interpreter = Interpreter::new(text, library, of_macros, &context);
        interpreter.set_tables(&settings.tables);
        Executive {
            reader,
            interpreter,
            line: 0,
            is_over: false,
            fed: None,
            pending: None,
            outputs: Vec::new(),
            messages: VecDeque::new(),
        }
    }

    /// Where subprograms come from that are not in the program's file.
    pub fn set_library(&mut self, library: Box<dyn Library>) {
        self.interpreter.set_library(library);
    }

    /// Takes the next line of the DNC line, when starved.
    pub fn feed(&mut self, text: Vec<u8>, line: u32) {
        self.interpreter.feed(&text, line);
        self.line = line;
        self.fed = Some(text);
    }

    /// Reset: ready for another program of the DNC line, in the modal state of power-on, the axes where they stand.
    /// Variables from #500 on and offsets are kept.
    pub fn reset(&mut self, settings: &ControlSettings, stands: Pose) {
        self.reader = PlainReader::new(settings);
        self.reader.stand_at(stands);
        self.interpreter.reset();
        (self.line, self.is_over, self.fed, self.pending) = (0, false, None, None);
        self.outputs.clear();
        self.messages.clear();
    }

    /// What #3003 and #3004 switch off behind what was read.
    pub fn ignored(&self) -> Ignored {
        self.interpreter.variables().ignored
    }

    /// Where the last move that was read ends.
    pub fn end(&self) -> Pose {
        self.reader.end()
    }

    /// The offsets as the program has left them.
    pub fn tables(&self) -> &Tables {
        &self.interpreter.variables().tables
    }

    /// The next block at `now`.
    pub fn next(&mut self, now: Micros, switches: &Switches) -> Next {
        let next =
            self.pending.take().map_or_else(|| self.advance(now, switches), |block| Next::Block(Box::new(block)));
        // What the DNC line brought is executed as one block, also where it is a statement or a call.
        let is_of_line = |block: &ReadBlock| !matches!(block.action, Action::Fault(_));
        match (self.fed.take(), next) {
            (Some(fed), Next::Starved) => Next::Block(Box::new(ReadBlock::new(self.line, fed, Action::Nothing))),
            (Some(fed), Next::Block(block)) if is_of_line(&block) => {
                self.pending = Some(*block);
                Next::Block(Box::new(ReadBlock::new(self.line, fed, Action::Nothing)))
            }
            (fed, Next::Busy) => {
                self.fed = fed;
                Next::Busy
            }
            (_, next) => next,
        }
    }

    fn advance(&mut self, now: Micros, switches: &Switches) -> Next {
        // Bit n - 1 of the panel is bit n of the interpreter.
        self.interpreter.set_block_delete(switches.block_delete << 1);
        self.reader.reader().set_delete_switches(switches.block_delete << 1);
        while !self.is_over {
            let context = Context::with_length(self.reader.modal(), self.reader.machine(), now);
            let block = match self.interpreter.next(&context) {
                Ok(Step::Block(block)) => self.read(block),
                Ok(Step::Message(text)) => self.wait_with(&text),
                Ok(Step::Busy) => return Next::Busy,
                Ok(Step::End(Ending::Text)) => {
                    self.is_over = true;
                    self.block(Action::Fault(Fault::alarm(Alarm::EndOfRecord, 0)))
                }
                Err(trouble) => {
                    self.is_over = true;
                    self.stop(&trouble)
                }
                Ok(Step::Ignore(ignored)) => self.own(Action::Ignore(ignored)),
                Ok(Step::Output(output)) => {
                    self.outputs.push(output);
                    continue;
                }
                Ok(Step::Offset) => {
                    self.reader.reader().set_tables(&self.interpreter.variables().tables);
                    continue;
                }
                Ok(Step::Restart) => continue,
                Ok(Step::Starved) => return Next::Starved,
                Ok(Step::End(Ending::Program)) => {
                    self.is_over = true;
                    continue;
                }
            };
            return Next::Block(Box::new(block));
        }
        Next::Over
    }

    /// What a search makes of what comes next; `None` if that takes more time.
    pub fn look(&mut self, search: Search, now: Micros, switches: &Switches, approach: &Approach) -> Option<Found> {
        if let Search::Sequence(wanted) = search {
            let is_there = self.interpreter.seek(wanted);
            return Some(if is_there { Found::Here(Vec::new()) } else { Found::Never(Box::new(never(self.line))) });
        }
        let Search::Restart(wanted) = search else { return None };
        let start = self.reader.end();
        match self.next(now, switches) {
            Next::Block(block) => Some(approach.restart_at(wanted, *block, start)),
            Next::Busy | Next::Starved => None,
            Next::Over => Some(Found::Never(Box::new(never(self.line)))),
        }
    }

    /// Whether nothing comes any more.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// What has gone to the punch since this was asked last.
    pub fn take_outputs(&mut self) -> Vec<Output> {
        std::mem::take(&mut self.outputs)
    }

    /// Messages of `#3006` and `#3000`, and where in a called program an alarm came up.
    pub fn messages(&self) -> impl Iterator<Item = &str> {
        self.messages.iter().map(String::as_str)
    }

    /// Keeps from now on what a restart must tell the operator.
    pub fn list_for_restart(&mut self) {
        self.reader.list_for_restart();
    }

    /// What was kept before the last block.
    pub fn take_restart_list(&mut self) -> Option<RestartList> {
        self.reader.take_restart_list()
    }

    fn read(&mut self, block: PlainBlock) -> ReadBlock {
        let (action, context) = match self.reader.read(&block.text) {
            Ok(Plain { action, context }) => (action, context),
            Err(fault) => (Action::Fault(block.in_source(fault)), MoveContext::default()),
        };
        if self.reader.has_set_data() {
            self.interpreter.set_tables(self.reader.reader().tables());
        }
        self.line = main_line(block.place, &block.calls);
        let is_of_main = block.place.library.is_none() && block.calls.is_empty();
        let fed = if is_of_main { self.fed.take() } else { None };
        // Of a block such as G67 no words are left.
        let text = fed.filter(|_| block.text.is_empty()).unwrap_or(block.text);
        ReadBlock { line: self.line, text, action, context }
    }

    fn wait_with(&mut self, message: &[u8]) -> ReadBlock {
        let message = String::from_utf8_lossy(message).into_owned();
        let text = format!("({message})").into_bytes();
        self.messages.push_back(message);
        let block = self.own(Action::Stop(Stop::Program));
        if block.text.is_empty() { ReadBlock { text, ..block } } else { block }
    }

    /// A statement that is a block by itself, with its text if the DNC line brought it.
    fn own(&mut self, action: Action) -> ReadBlock {
        ReadBlock { text: self.fed.take().unwrap_or_default(), ..self.block(action) }
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
        ReadBlock::new(self.line, Vec::new(), action)
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

    fn executive(program: &str) -> Executive {
        let settings = ControlSettings::fanuc_16i(arcfeed_shared::units::LengthUnit::Mm);
        Executive::new(program.as_bytes(), &settings, Box::new(()))
    }

    fn texts(executive: &mut Executive, switches: &Switches) -> Vec<String> {
        let mut texts = Vec::new();
        while let Next::Block(block) = executive.next(Micros(0), switches) {
            texts.push(String::from_utf8(block.text).unwrap());
        }
        texts
    }

    #[test]
    fn switches_delete_blocks_and_statements() {
        let program = "#1=1.\n/2#1=2.\n/X5.\nX#1\nM30\n";
        let switches = Switches { block_delete: 0b10, ..Switches::default() };
        assert_eq!(texts(&mut executive(program), &switches), ["/X5.", "X1.", "M30"]);
        assert_eq!(texts(&mut executive(program), &Switches::default()), ["/X5.", "X2.", "M30"]);
    }

    #[test]
    fn a_search_goes_on_at_its_block_and_a_restart_reads_what_is_before_it() {
        let program = "#1=4.\nG1F100.X1.\nN20Y#1\nM30\n";
        let stands = arcfeed_shared::nc::modal::Pose::default();
        let approach = Approach { stands, feed: arcfeed_shared::units::MmPerMin(1_000.0) };
        let off = Switches::default();
        let mut found = executive(program);
        assert_eq!(found.look(Search::Sequence(20), Micros(0), &off, &approach), Some(Found::Here(Vec::new())));
        assert_eq!(texts(&mut found, &off), ["N20", "M30"], "without #1 there is no Y");
        let mut restarted = executive(program);
        let mut look = || restarted.look(Search::Restart(20), Micros(0), &off, &approach);
        assert_eq!(look(), Some(Found::NotYet));
        let Some(Found::Here(blocks)) = look() else { panic!("N20 is there") };
        let ends: Vec<_> = blocks
            .iter()
            .filter_map(|block| match &block.action {
                Action::Move(segment, _) => Some(segment.end.linear.map(|axis| axis.to_mm())),
                _ => None,
            })
            .collect();
        assert_eq!(ends, [[1.0, 0.0, 0.0], [1.0, 4.0, 0.0]]);
    }
}
