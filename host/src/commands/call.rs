//! Commands as functions, for callers in the same process: the Python package ([docs/python.md](../../../docs/python.md)).
//!
//! A command gets the words of the command line, so that a function can do what the program does, with the same figures.
//! [`captured`](crate::console::captured) keeps its output from the streams of the process.

use std::ffi::OsString;
use std::path::Path;

use arcfeed_law::SegmentLaw;
use arcfeed_nc::segment::Segment;
use clap::Parser;

use super::adapt::Adapt;
use super::check::Check;
use super::init::Init;
use super::job_input::load_text;
use super::law::Law;
use super::lobes::Lobes;
use super::outcome::Failure;
use super::plan::PlanCommand;
use super::simulate::Simulate;
#[cfg(not(target_family = "wasm"))]
use super::sweep::Sweep;
use crate::adapt::{BlockLaw, Known, adapt_with};
use crate::plural::counted;

/// Commands that a caller can run as functions: they need no terminal and no line.
#[derive(Debug, Parser)]
#[command(name = "arcfeed")]
enum Function {
    Check(Check),
    Init(Init),
    Adapt(Adapt),
    Plan(PlanCommand),
    Simulate(Box<Simulate>),
    Lobes(Lobes),
    Law(Law),
    #[cfg(not(target_family = "wasm"))]
    Sweep(Sweep),
}

/// Feed law of one move of a program, with the move.
#[derive(Clone, Debug)]
pub struct LineLaw {
    /// Move for which the law is evaluated.
    pub segment: Segment,
    /// Feed law of that move.
    pub law: SegmentLaw,
}

/// Runs a command: its name, then its options and arguments.
///
/// # Errors
/// Any error of the command; words that are no command or option.
pub fn call(words: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let words = std::iter::once("arcfeed".into()).chain(words);
    let function = Function::try_parse_from(words).map_err(|error| Failure::Usage(error.to_string()))?;
    match function {
        Function::Check(command) => command.run(),
        Function::Init(command) => command.run(),
        Function::Adapt(command) => adapt(&command),
        Function::Plan(command) => command.run(),
        Function::Simulate(command) => command.run(),
        Function::Lobes(command) => command.run(),
        Function::Law(command) => command.run(),
        #[cfg(not(target_family = "wasm"))]
        Function::Sweep(command) => command.run(),
    }
}

/// Adapts a program, and writes the report of its run if one is requested.
///
/// # Errors
/// Those of the command.
pub fn adapt(command: &Adapt) -> Result<(), Failure> {
    command.run()?;
    match command.report() {
        Some((input, path)) => Simulate::report_of(input.clone(), path.to_owned()).run(),
        None => Ok(()),
    }
}

/// Law of the first move on line `line` (counted from 1) of the program that the job file `job` names.
///
/// # Errors
/// The job or its program is at fault; no cut rule matches a move on this line.
pub fn law_of_line(job: &Path, line: usize) -> Result<LineLaw, Failure> {
    let (file, source, _) = load_text(job)?;
    let program = source.whole().map_err(Failure::Input)?;
    let adapted = adapt_with(&program, &file.job, Known::of(&file));
    let path = program.path.display();
    let refusal = |why: &str| Failure::Input(format!("{path}:{line}:1: error: {why}"));
    let block = adapted.blocks.iter().find(|block| source.line_in_file(block.line) == line);
    let Some(block) = block else {
        let lines = counted(program.texts().count(), "line");
        return Err(refusal(&format!("no block with a move is on this line (the program has {lines}); name another")));
    };
    let law = block.law(&file.job, block.teeth_per_min.unwrap_or(f64::NAN));
    let Some(BlockLaw { segment, law, .. }) = law else {
        let reason = block.reason.label();
        return Err(refusal(&format!(
            "no law governs this move ({reason}); name another, or add a [[cut]] for it to the job"
        )));
    };
    Ok(LineLaw { segment, law })
}
