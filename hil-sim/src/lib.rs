#![doc = include_str!("../README.md")]
//!
//! Simulation of the machine, which replaces the hardware for firmware and host.
//!
//! One simulated time base, in steps of one millisecond; no wall clock, no randomness. The control and its axes are in
//! `arcfeed-control`, the stock in `arcfeed-dexel`, modes in `arcfeed-modal`, chips and forces in `arcfeed-milling`. Here [`faults`] corrupt the
//! controller on purpose, an [`override_source`] sets the override, [`move_override`] records it,
//! [`planned_conditions`] come with moves, the [`simulated_machine`] executes them, a [`simulation`] combines machine and override source,
//! [`removal`] cuts a stock with its run, and a [`path_trace`] has the tool's path.

pub mod faults;

pub mod move_override;

pub mod override_source;

pub mod planned_conditions;

pub mod simulated_machine;

pub mod simulation;

pub mod removal;

pub mod path_trace;
