//! Cutting forces against closed forms and runs of independent programs.
//!
//! The tests give the chip (the sine law, or [`trochoid`]): the library has its own from the stock.

pub mod trochoid;

pub mod rows;

mod chips;

mod closed_form;

mod milling;

mod reference_runs;

mod edges;

mod materials;
