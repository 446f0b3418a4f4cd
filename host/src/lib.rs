//! Host part of arcfeed: commands that read a program and a job, plan feeds (`arcfeed-adapt`), send, simulate, report.
//!
//! The modules are in the order of the data flow; a module imports only from those above it. Only [`commands`] uses the
//! simulator.
#![deny(clippy::print_stdout, clippy::print_stderr)]

#[cfg(feature = "plan")]
use arcfeed_adapt::toml_reader;
pub use arcfeed_adapt::{
    adapt, axial_law, checksum, control, engagement, file_error, job, key_values, machine_file, post, program,
};
use arcfeed_adapt::{place, toml_values, unit_value};
pub use arcfeed_program::{clock, files};

mod plural;

pub mod features;

pub mod output;

pub mod trace;

pub mod console;

pub mod snippet;

#[cfg(feature = "plan")]
pub mod part;

pub mod init;

pub mod port;

pub use arcfeed_dnc as dnc;

pub mod board;

pub mod linuxcnc;

pub mod screen;

pub mod report;

pub mod web;

pub mod commands;
