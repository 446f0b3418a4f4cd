#![doc = include_str!("../README.md")]
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub use arcfeed_program as program;
pub use arcfeed_program::files;

pub mod place;

pub mod toml_values;

pub mod toml_reader;

pub mod unit_value;

pub mod key_values;

pub mod file_error;

pub mod checksum;

pub mod control;

pub mod machine_file;

pub mod post;

pub mod engagement;

pub mod axial_law;

pub mod job;

pub mod adapt;
