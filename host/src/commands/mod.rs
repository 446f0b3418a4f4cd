//! Commands of the program. Each reads its arguments, does its work and reports its result.

/// Stack of a thread that executes commands or runs: a run without optimisation needs more than 2 MiB. The first thread of a program has
/// 8 MiB on Linux and macOS, and 1 MiB on Windows.
pub const STACK_BYTES: usize = 8 << 20;

pub mod outcome;

mod executed_blocks;

pub mod control_args;

pub mod job_values;

pub mod job_input;

pub mod line_args;

pub mod five_axis;

pub mod check;

pub mod post;

pub mod init;

mod for_control;

pub mod adapt;

pub mod simulate;

pub mod measure;

pub mod lobes;

pub mod law;

pub mod engage;

pub mod board;

pub mod parameters;

#[cfg(not(target_family = "wasm"))]
pub mod stream;

#[cfg(not(target_family = "wasm"))]
pub mod sweep;

#[cfg(not(target_family = "wasm"))]
pub mod verify;

#[cfg(not(target_family = "wasm"))]
pub mod serve;

#[cfg(not(target_family = "wasm"))]
pub mod ports;

pub mod plan;

pub mod call;

pub mod view;
