//! C interface of the feed controller, `include/arcfeed.h`: a controller in the caller's memory, its parameters, moves
//! by program line, and a tick.
//!
//! [`status`] has the results of the calls, [`values`] the structs; [`moves`] stores the moves by line; [`adaptive`]
//! combines the override with that of a control whose override input only reduces; [`controller`] is the controller
//! without pointers; [`exports`] has the functions that C calls.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

#[cfg(test)]
mod random;

pub mod status;

pub mod values;

pub mod moves;

pub mod adaptive;

pub mod controller;

pub mod exports;
