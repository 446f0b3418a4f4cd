//! Custom macro B and subprograms: programs with variables to blocks of plain words.
//!
//! A text is taken apart once ([`program`]); the [`interpreter`] goes through it statement by statement and answers what a
//! control has to do next: read a plain block, punch, stop, end. It does no I/O and has no clock; how long it may go round
//! without a move, how deep calls nest and how large called programs may be are bounds that its caller sets.

pub mod code;

pub mod offsets;

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
