//! What the figures of the chip are measured with, the same on the host and in the board images.
//!
//! [`thesis`] is the yardstick of the tick's cost: the source's own route, written down as printed. [`trace`] runs the
//! controller on [`random_case`]s that a seed fixes and hashes what it puts out: the bits must be the same everywhere. Both
//! stand on a [`board_io`] in place of hardware. Nothing here is part of the controller, and it may panic.
#![cfg_attr(not(test), no_std)]

pub mod board_io;

pub mod random;

pub mod random_case;

pub mod thesis;

pub mod trace;
