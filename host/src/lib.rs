//! Host part of arcfeed: reads a program and a job, plans feeds, sends, reports.
//!
//! The modules are in the order of the data flow; a module imports only from those above it. Only [`commands`] uses the
//! simulator.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod place;

pub use arcfeed_program::{clock, files};

mod plural;

pub mod features;

mod toml_values;

mod toml_reader;

pub mod key_values;

mod unit_value;

pub mod output;

pub mod trace;

pub mod console;

pub mod checksum;

pub mod file_error;

pub mod control;

pub mod machine_file;

pub use arcfeed_program as program;

pub mod post;

pub mod snippet;

pub mod engagement;

pub mod axial_law;

pub mod job;

#[cfg(feature = "plan")]
pub mod part;

pub mod init;

pub mod adapt;

pub mod port;

pub use arcfeed_dnc as dnc;

pub mod board;

pub mod linuxcnc;

pub mod screen;

pub mod report;

pub mod web;

pub mod commands;
