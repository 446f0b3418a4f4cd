//! Vibrations against closed forms, and milling that acts back on itself against runs of an independent program.

#[path = "../cutting_forces/rows.rs"]
mod rows;

mod regenerative;

mod sets;

mod structures;

mod milling;

mod steps;

mod verdicts;
