//! Programs with macro statements, calls and subprograms, as the control reads them ahead: a program in memory, or one
//! that comes over the line and calls others in memory.
//!
//! A control evaluates macro statements when it reads them ahead, not when the blocks before them are done. This model
//! does the same, so #5001 and on give the end of the last block read. Statements take time: one slice of them a step.
//! Values of #3003 and #3004 apply from the next block on. Over the line GOTO, WHILE, DO and END are alarm PS0123.

use std::collections::VecDeque;

use arcfeed_compensation::contour::ContourCommand;
use arcfeed_nc::alarm::{Alarm, Fault};
use arcfeed_nc::modal::{Pose, ProgramStop};
use arcfeed_nc::settings::Tables;
use arcfeed_nc_macro::interpreter::Interpreter;
use arcfeed_nc_macro::print::Output;
use arcfeed_nc_macro::program::Library;
use arcfeed_nc_macro::stack::SourceLine;
use arcfeed_nc_macro::step::{Ending, MacroSettings, MacroStep, PlainBlock, ProgramFault};
use arcfeed_nc_macro::variables::{Context, Ignored};
use arcfeed_units::Micros;

use super::action::{Action, MoveContext, ReadBlock};
use super::plain::{Plain, PlainReader};
use super::restart::RestartList;
use super::search::{Approach, Search, SearchResult, never};
use super::settings::{ControlSettings, Switches};

/// Reader of a whole program: interprets macro statements and calls, and returns the blocks in the order of execution.
#[derive(Debug)]
pub struct Executive {
    reader: PlainReader,
    interpreter: Interpreter,
    line: u32,
    is_over: bool,
    /// Line of the DNC line, until it gives its block.
    fed: Option<Vec<u8>>,
    /// Block of a called program, which follows the block of its call.
    pending: Option<ReadBlock>,
    outputs: Vec<Output>,
    messages: VecDeque<String>,
}

/// Result of asking for the next block: the block, or the reason why there is none now.
#[derive(Clone, Debug, PartialEq)]
pub enum NextBlock {
    /// The next block to execute.
    Block(Box<ReadBlock>),
    /// Macro statements used up the time of this step; a block may come in the next one.
    Busy,
    /// The next line of the program has not arrived on the serial (DNC) line yet.
    Starved,
    /// The program is over: no further block comes.
    Over,
}

impl Executive {
    /// Executive for a program in memory at power-on, with the axes at the origin; subprograms are in `text` after the program, or
    /// in the library.
    pub fn new(text: &[u8], settings: &ControlSettings, library: Box<dyn Library>) -> Self {
        Executive::with(text, settings, library, false)
    }

    /// Executive for a program from the serial (DNC) line at power-on, with the axes at the origin; [`Executive::feed`] gives its lines.
    pub fn on_line(settings: &ControlSettings) -> Self {
        Executive::with(b"", settings, Box::new(()), true)
    }

    fn with(text: &[u8], settings: &ControlSettings, library: Box<dyn Library>, is_dnc: bool) -> Self {
        let reader = PlainReader::new(settings);
        let context = Context::with_length(reader.modal(), reader.machine(), Micros(0));
        let of_macros = MacroSettings { is_dnc, ..MacroSettings::default() };
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

    /// Sets the library of subprograms that are not in the program's file.
    pub fn set_library(&mut self, library: Box<dyn Library>) {
        self.interpreter.set_library(library);
    }

    /// Accepts the next line of a program from the serial line, after [`NextBlock::Starved`]; `line` is its number, from 1.
    pub fn feed(&mut self, text: Vec<u8>, line: u32) {
        self.interpreter.feed(&text, line);
        self.line = line;
        self.fed = Some(text);
    }

    /// Reset: makes ready for another program from the serial line, in the modal state of power-on, with the axes at `position`.
    /// Variables from #500 on and offsets are kept.
    pub fn reset(&mut self, settings: &ControlSettings, position: Pose) {
        self.reader = PlainReader::new(settings);
        self.reader.stand_at(position);
        self.interpreter.reset();
        (self.line, self.is_over, self.fed, self.pending) = (0, false, None, None);
        self.outputs.clear();
        self.messages.clear();
    }

    /// Functions that #3003 and #3004 have switched off after the blocks read so far.
    pub fn ignored(&self) -> Ignored {
        self.interpreter.variables().ignored
    }

    /// End of the last move that was read.
    pub fn end(&self) -> Pose {
        self.reader.end()
    }

    /// Work offsets and tool lengths as last written by the program.
    pub fn tables(&self) -> &Tables {
        &self.interpreter.variables().tables
    }

    /// Reads up to the next block; `now` is the time for the clock variables of macros.
    pub fn next(&mut self, now: Micros, switches: &Switches) -> NextBlock {
        let next =
            self.pending.take().map_or_else(|| self.advance(now, switches), |block| NextBlock::Block(Box::new(block)));
        // A line of the DNC line is executed as one block, also if it is a statement or a call.
        let is_of_line = |block: &ReadBlock| !matches!(block.action, Action::Fault(_));
        match (self.fed.take(), next) {
            (Some(fed), NextBlock::Starved) => {
                NextBlock::Block(Box::new(ReadBlock::new(self.line, fed, Action::Nothing)))
            }
            (Some(fed), NextBlock::Block(block)) if is_of_line(&block) => {
                self.pending = Some(*block);
                NextBlock::Block(Box::new(ReadBlock::new(self.line, fed, Action::Nothing)))
            }
            (fed, NextBlock::Busy) => {
                self.fed = fed;
                NextBlock::Busy
            }
            (_, next) => next,
        }
    }

    fn advance(&mut self, now: Micros, switches: &Switches) -> NextBlock {
        // Bit n - 1 of the panel is bit n of the interpreter.
        self.interpreter.set_block_delete(switches.block_delete << 1);
        self.reader.reader().set_delete_switches(switches.block_delete << 1);
        while !self.is_over {
            let context = Context::with_length(self.reader.modal(), self.reader.machine(), now);
            let block = match self.interpreter.next(&context) {
                Ok(MacroStep::Block(block)) => self.read(block),
                Ok(MacroStep::Message(text)) => self.wait_with(&text),
                Ok(MacroStep::Busy) => return NextBlock::Busy,
                Ok(MacroStep::End(Ending::Text)) => {
                    self.is_over = true;
                    self.block(Action::Fault(Fault::alarm(Alarm::EndOfRecord, 0)))
                }
                Err(trouble) => {
                    self.is_over = true;
                    self.stop(&trouble)
                }
                Ok(MacroStep::Ignore(ignored)) => self.own(Action::Ignore(ignored)),
                Ok(MacroStep::Output(output)) => {
                    self.outputs.push(output);
                    continue;
                }
                Ok(MacroStep::Offset) => {
                    self.reader.reader().set_tables(&self.interpreter.variables().tables);
                    continue;
                }
                Ok(MacroStep::Restart) => continue,
                Ok(MacroStep::Starved) => return NextBlock::Starved,
                Ok(MacroStep::End(Ending::Program)) => {
                    self.is_over = true;
                    continue;
                }
            };
            return NextBlock::Block(Box::new(block));
        }
        NextBlock::Over
    }

    /// Reads the next block and checks whether it is the target of the operator's search; `None` if no whole block has arrived yet.
    pub fn search(
        &mut self,
        search: Search,
        now: Micros,
        switches: &Switches,
        approach: &Approach,
    ) -> Option<SearchResult> {
        if let Search::Sequence(wanted) = search {
            let is_there = self.interpreter.seek(wanted);
            return Some(if is_there {
                SearchResult::Here(Vec::new())
            } else {
                SearchResult::Never(Box::new(never(self.line)))
            });
        }
        let Search::Restart(wanted) = search else { return None };
        let start = self.reader.end();
        match self.next(now, switches) {
            NextBlock::Block(block) => Some(approach.restart_at(wanted, *block, start)),
            NextBlock::Busy | NextBlock::Starved => None,
            NextBlock::Over => Some(SearchResult::Never(Box::new(never(self.line)))),
        }
    }

    /// Whether no further block comes.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// Takes the outputs of POPEN, DPRNT, BPRNT and PCLOS since the last call.
    pub fn take_outputs(&mut self) -> Vec<Output> {
        std::mem::take(&mut self.outputs)
    }

    /// Messages that the program has issued by `#3006` and `#3000`; if an alarm came up in a called program, one more message names the
    /// place of it there.
    pub fn messages(&self) -> impl Iterator<Item = &str> {
        self.messages.iter().map(String::as_str)
    }

    /// Begins to collect the functions (M, S, T) that a restart must show to the operator.
    pub fn list_for_restart(&mut self) {
        self.reader.list_for_restart();
    }

    /// Takes the collected functions of all blocks before the last one read.
    pub fn take_restart_list(&mut self) -> Option<RestartList> {
        self.reader.take_restart_list()
    }

    fn read(&mut self, block: PlainBlock) -> ReadBlock {
        let Plain { action, context, contour } = self.reader.read(&block.text).unwrap_or_else(|fault| Plain {
            action: Action::Fault(block.in_source(fault)),
            context: MoveContext::default(),
            contour: ContourCommand::default(),
        });
        if self.reader.has_set_data() {
            self.interpreter.set_tables(self.reader.reader().tables());
        }
        self.line = main_line(block.place, &block.calls);
        let is_of_main = block.place.library.is_none() && block.calls.is_empty();
        let fed = if is_of_main { self.fed.take() } else { None };
        // A block such as G67 has no words left.
        let text = fed.filter(|_| block.text.is_empty()).unwrap_or(block.text);
        ReadBlock { line: self.line, text, action, context, contour }
    }

    fn wait_with(&mut self, message: &[u8]) -> ReadBlock {
        let message = String::from_utf8_lossy(message).into_owned();
        let text = format!("({message})").into_bytes();
        self.messages.push_back(message);
        let block = self.own(Action::Stop(ProgramStop::Program));
        if block.text.is_empty() { ReadBlock { text, ..block } } else { block }
    }

    /// A statement that is a block of its own, with its text if the DNC line brought it.
    fn own(&mut self, action: Action) -> ReadBlock {
        ReadBlock { text: self.fed.take().unwrap_or_default(), ..self.block(action) }
    }

    fn stop(&mut self, trouble: &ProgramFault) -> ReadBlock {
        let ProgramFault { fault, place, calls, message } = trouble;
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

/// Line of the main program's file to which a place belongs: its own, or that of the call that led to it.
fn main_line(place: SourceLine, calls: &[SourceLine]) -> u32 {
    let of_main = |place: &&SourceLine| place.library.is_none();
    std::iter::once(&place).chain(calls.iter().rev()).find(of_main).map_or(0, |place| place.line)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn executive(program: &str) -> Executive {
        let settings = ControlSettings::fanuc_16i(arcfeed_units::LengthUnit::Mm);
        Executive::new(program.as_bytes(), &settings, Box::new(()))
    }

    fn texts(executive: &mut Executive, switches: &Switches) -> Vec<String> {
        let mut texts = Vec::new();
        while let NextBlock::Block(block) = executive.next(Micros(0), switches) {
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
    fn a_search_starts_at_its_block_and_a_restart_reads_the_blocks_before_it() {
        let program = "#1=4.\nG1F100.X1.\nN20Y#1\nM30\n";
        let position = arcfeed_nc::modal::Pose::default();
        let approach = Approach { position, feed: arcfeed_units::MmPerMin(1_000.0) };
        let off = Switches::default();
        let mut found = executive(program);
        assert_eq!(
            found.search(Search::Sequence(20), Micros(0), &off, &approach),
            Some(SearchResult::Here(Vec::new()))
        );
        assert_eq!(texts(&mut found, &off), ["N20", "M30"], "without #1 there is no Y");
        let mut restarted = executive(program);
        let mut search = || restarted.search(Search::Restart(20), Micros(0), &off, &approach);
        assert_eq!(search(), Some(SearchResult::NotYet));
        let Some(SearchResult::Here(blocks)) = search() else { panic!("N20 is there") };
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
