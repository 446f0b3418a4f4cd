//! Commands of the program. Each reads its arguments, does its work and reports its result.

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
