//! arcfeed: constant chip load on circular moves, from the NC program to the override of the control.
#![deny(clippy::print_stdout, clippy::print_stderr)]

use std::panic::resume_unwind;
use std::process::ExitCode;
use std::thread::Builder;

use arcfeed::commands::{
    STACK_BYTES, adapt::Adapt, board::BoardCommand, call, check::Check, engage::Engage, init::Init, law::Law,
    lobes::Lobes, measure::Measure, parameters::Parameters, plan::PlanCommand, ports::Ports, post::Post, serve::Serve,
    simulate::Simulate, stream::Stream, sweep::Sweep, verify::Verify, view::ViewCommand,
};
use clap::{Parser, Subcommand};

/// Constant chip load on circular moves, from the NC program to the override of the control
///
/// Exit codes: 0 done; 1 the program or the job is at fault; 2 usage; 3 the line or the machine failed; 4 a person must
/// decide first; 130 stopped by the operator; 141 the reader of stdout is gone.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Check(Check),
    Init(Init),
    Engage(Engage),
    Adapt(Adapt),
    Plan(PlanCommand),
    Post(Post),
    Stream(Box<Stream>),
    Verify(Verify),
    View(ViewCommand),
    Simulate(Simulate),
    Sweep(Sweep),
    Measure(Measure),
    Lobes(Lobes),
    Law(Law),
    Serve(Serve),
    Ports(Ports),
    Board(BoardCommand),
    Parameters(Parameters),
}

fn main() -> ExitCode {
    match Builder::new().name("main".to_owned()).stack_size(STACK_BYTES).spawn(run) {
        Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
        Err(_no_thread) => run(),
    }
}

fn run() -> ExitCode {
    let ended = match Arguments::parse().command {
        Command::Check(command) => command.run(),
        Command::Init(command) => command.run(),
        Command::Engage(command) => command.run(),
        Command::Adapt(command) => call::adapt(&command),
        Command::Plan(command) => command.run(),
        Command::Post(command) => command.run(),
        Command::Stream(command) => command.run(),
        Command::Verify(command) => command.run(),
        Command::View(command) => command.run(),
        Command::Simulate(command) => command.run(),
        Command::Sweep(command) => command.run(),
        Command::Measure(command) => command.run(),
        Command::Lobes(command) => command.run(),
        Command::Law(command) => command.run(),
        Command::Serve(command) => command.run(),
        Command::Ports(command) => command.run(),
        Command::Board(command) => command.run(),
        Command::Parameters(command) => command.run(),
    };
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => ExitCode::from(failure.report()),
    }
}
