//! The machine in software: what the firmware and the host meet in place of hardware.
//!
//! One time base, simulated, in steps of one millisecond; no wall clock, no randomness. Modules stand in the order of
//! cause and effect: what the [`drives`] can do; bytes arrive at the [`control`], which moves the axes; the [`machine`] reports
//! them; the [`stock`] loses what the tool sweeps; [`cutting`] measures the chips from what the axes did, and
//! what they do to the tool; [`fe`] knows how tools and workpieces vibrate, [`dynamics`] how they give way to forces, [`flexible`] where; a
//! [`process`] is all of that together, a [`finishing`] pass along a blade one that leaves its marks; [`faults`] corrupt the
//! controller on purpose; a [`override_source`] has the override; the [`simulation`] joins them all; [`removal`] cuts a stock with what it does.

pub mod drives;

pub mod control;

pub mod machine;

pub mod stock;

pub mod cutting;

pub mod fe;

pub mod dynamics;

pub mod flexible;

pub mod process;

pub mod finishing;

pub mod faults;

pub mod override_source;

pub mod simulation;

pub mod removal;
