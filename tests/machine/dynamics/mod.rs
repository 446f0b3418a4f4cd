//! Vibrations against closed forms, and milling that acts back on itself against runs of an independent program.

mod regenerative;

mod sets;

mod structures;

mod milling;

mod steps;

mod verdicts;
