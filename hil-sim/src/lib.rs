//! The machine in software: what the firmware and the host meet in place of hardware.
//!
//! One time base, simulated, in steps of one millisecond; no wall clock, no randomness. Modules stand in the order of
//! cause and effect: what the [`drives`] can do; bytes arrive at the [`control`], which moves the axes; the [`machine`] reports
<<<<<<< HEAD
//! them; the [`stock`] loses what the tool sweeps; [`cutting`] measures the chips from what the axes did, and
//! what they do to the tool; [`dynamics`] is how tool and workpiece give way; a [`process`] is all of
//! that together; [`faults`] spoil the controller on
=======
//! them; the [`stock`] loses what the tool sweeps; [`cutting`] measures the chips from what the axes did; [`fe`] knows how tools and workpieces vibrate; [`faults`] spoil the controller on
>>>>>>> fe
//! purpose; a [`decider`] has the override; the [`rig`] joins them all.

pub mod drives;

pub mod control;

pub mod machine;

pub mod stock;

pub mod cutting;

<<<<<<< HEAD
pub mod dynamics;

pub mod process;
=======
pub mod fe;
>>>>>>> fe

pub mod faults;

pub mod decider;

pub mod rig;
