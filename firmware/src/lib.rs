//! The feed controller: from segment, position and spindle speed to the override.
//!
//! No heap, no clock, no I/O: one call of [`supervisor::Supervisor::tick`] per sample of the position. Modules in the
//! order of the data flow: `arcfeed-law` gives the feed per tooth that the tool's centre needs; [`progress`] finds the
//! position on the segment; [`ramp`] turns a wanted ratio into an override that the control can follow; [`envelope`]
//! lowers the ratio in time for later demands; [`active`] is a segment prepared with all of these; [`controller`]
//! follows the position along it; [`supervisor`] decides whether the law may act, and on the override; [`queue`] finds
//! the segment in execution if the control does not report it; [`input`] converts readings of a board; [`output`] passes
//! the override to the control; [`board`] is the hardware interface.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]
#![doc = include_str!("../README.md")]

pub mod progress;

pub mod ramp;

pub mod envelope;

pub mod active;

pub mod controller;

pub mod supervisor;

pub mod queue;

pub mod input;

pub mod output;

pub mod board;
