//! Measurement code for the figures of the chip, the same on the host and in the board images.
//!
//! [`thesis`] is the reference for the tick's cost: the source's own formulas as printed. [`trace`] runs the
//! controller on [`random_case`]s of a seed and hashes its outputs, which must be bit-identical everywhere. Both use a
//! [`board_io`] in place of hardware. This code is not part of the controller and may panic.
#![cfg_attr(not(test), no_std)]

pub mod board_io;

pub mod random;

pub mod random_case;

pub mod thesis;

pub mod trace;
