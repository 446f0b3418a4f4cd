#![doc = include_str!("../README.md")]
//!
//! Custom macro B and subprograms: expansion of programs with variables into blocks of plain words.
//!
//! [`program`] divides a text once; the [`interpreter`] executes its statements and returns the next action of the
//! control: read a plain block, punch, stop, end. It does no I/O and has no clock. The caller sets the limits:
//! statements without a move, nesting of calls, and size of called programs.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

extern crate alloc;

pub mod code;

pub mod offsets;

mod plain_bytes;

pub mod program;

pub mod function;

pub mod codes;

pub mod variables;

pub mod expression;

pub mod print;

pub mod words;

pub mod arguments;

pub mod stack;

pub mod step;

pub mod calls;

pub mod interpreter;
