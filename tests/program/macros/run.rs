//! Runs macro programs through the interpreter and the reader, and keeps what came out.

use std::collections::BTreeMap;

use arcfeed_nc::alarm::{Cause, Fault};
use arcfeed_nc::block::Reading;
use arcfeed_nc::reader::Reader;
use arcfeed_nc::segment::Segment;
use arcfeed_nc_macro::interpreter::Interpreter;
use arcfeed_nc_macro::stack::{Bounds, SourceLine};
use arcfeed_nc_macro::step::{Ending, MacroSettings, MacroStep, ProgramFault};
use arcfeed_nc_macro::variables::Context;
use arcfeed_tests::root;
use arcfeed_units::{LengthUnit, Micros};

/// Result of a program.
#[derive(Debug)]
pub struct Run {
    /// Moves, each with its line.
    pub moves: Vec<(SourceLine, Segment)>,
    /// Punched output.
    pub output: Vec<u8>,
    /// Messages of #3006.
    pub messages: Vec<String>,
    /// End of the run.
    pub ended: Result<Ending, ProgramFault>,
    /// The interpreter at its end.
    pub interpreter: Interpreter,
}

impl Run {
    /// A variable at the end.
    pub fn variable(&self, number: u32) -> Option<f64> {
        self.interpreter.variables().read(number).expect("a variable")
    }

    /// Ends of the moves, mm.
    pub fn ends_mm(&self) -> Vec<[f64; 3]> {
        self.moves.iter().map(|(_, segment)| segment.end.linear.map(|axis| axis.to_mm())).collect()
    }

    /// Alarm number and column that it stopped with.
    pub fn alarm(&self) -> Option<(u16, u16)> {
        let Fault { cause, column } = self.ended.as_ref().err()?.fault;
        match cause {
            Cause::Macro(alarm) => Some((alarm.number()?, column)),
            Cause::Alarm(alarm) => Some((alarm.number(), column)),
            Cause::NotModelled(_) => None,
        }
    }
}

/// A program of the corpus.
pub fn corpus(name: &str) -> String {
    let path = root().join("tests/corpus/macro").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Runs a text in millimetres with few statements allowed.
pub fn run(text: &str) -> Run {
    run_with(
        text,
        &[],
        MacroSettings { bounds: Bounds { steps: 100_000, ..Bounds::default() }, ..MacroSettings::default() },
    )
}

/// With a library of programs, and settings.
pub fn run_with(text: &str, library: &[(u32, &str)], settings: MacroSettings) -> Run {
    let library: BTreeMap<u32, Vec<u8>> =
        library.iter().map(|(number, text)| (*number, text.as_bytes().to_vec())).collect();
    let mut reader = Reader::new(LengthUnit::Mm, Reading::Lenient);
    let mut now = Micros(0);
    let context = Context::new(reader.modal(), now);
    let interpreter = Interpreter::new(text.as_bytes(), Box::new(library), settings, &context);
    let (moves, output, messages) = (Vec::new(), Vec::new(), Vec::new());
    let mut run = Run { moves, output, messages, ended: Ok(Ending::Text), interpreter };
    // Restarts count as an end.
    for _ in 0..100_000 {
        match run.interpreter.next(&Context::with_length(reader.modal(), reader.machine(), now)) {
            Ok(MacroStep::Block(block)) => match reader.read(&block.text) {
                Ok(understood) => {
                    run.moves.extend(understood.segment.map(|segment| (block.place, segment)));
                    if understood.step.sets_data {
                        run.interpreter.set_tables(reader.tables());
                    }
                }
                Err(fault) => {
                    let (place, calls) = (block.place, block.calls.clone());
                    run.ended = Err(ProgramFault { fault: block.in_source(fault), place, calls, message: Vec::new() });
                    return run;
                }
            },
            Ok(MacroStep::Output(output)) => run.output.extend(output.bytes()),
            Ok(MacroStep::Offset) => reader.set_tables(&run.interpreter.variables().tables),
            Ok(MacroStep::Ignore(_)) => {}
            Ok(MacroStep::Message(text)) => run.messages.push(String::from_utf8_lossy(&text).into_owned()),
            Ok(MacroStep::Busy) => now = now.after(Micros::from_ms(1)),
            Ok(MacroStep::Starved | MacroStep::Restart) => return run,
            Ok(MacroStep::End(ending)) => {
                run.ended = Ok(ending);
                return run;
            }
            Err(trouble) => {
                run.ended = Err(trouble);
                return run;
            }
        }
    }
    panic!("100 000 steps and no end");
}
