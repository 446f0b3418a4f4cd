//! Simulation of the machine, which replaces the hardware for firmware and host.
//!
//! One simulated time base, in steps of one millisecond; no wall clock, no randomness. Modules are in the order of
//! cause and effect. [`drives`] has the limits of the axes. The [`control`] receives bytes and moves the axes; the
//! [`machine`] reports them. The [`stock`] loses the material that the tool sweeps. [`cutting`] measures chips from the
//! axes' motion, and the forces on the tool. [`fe`] computes the modes of tools and workpieces, [`dynamics`] their
//! displacement under forces, [`flexible`] the modes at the points of contact. A [`process`] combines these; a
//! [`finishing`] pass along a blade leaves marks. [`faults`] corrupt the controller on purpose. An [`override_source`]
//! sets the override; the [`simulation`] combines them all; [`removal`] cuts a stock with its run.

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
