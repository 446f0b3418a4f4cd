//! Code that the host program and the feed board share.
//!
//! Modules are listed in the order of the data flow; a module imports only from those above it: NC text ->
//! [`nc::word`] -> [`nc::block`] -> [`nc::modal`] -> [`radius`] -> [`segment`] -> [`reader`], then the data of a job
//! ([`machine`], `kinematics`, [`tool`], [`engaged`], [`stock`], [`knots`], [`cut`], [`job`], [`governed`]), the
//! machine's reports ([`telemetry`], [`report`]), and the link to a board ([`wire`]).
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

#[cfg(any(feature = "macros", feature = "kinematics"))]
extern crate alloc;

pub mod units;

pub mod fmath;

pub mod nc;

pub mod radius;

pub mod segment;

pub mod reader;

pub mod machine;

#[cfg(feature = "kinematics")]
pub mod kinematics;

pub mod tool;

pub mod engaged;

pub mod stock;

pub mod knots;

pub mod cut;

pub mod job;

pub mod governed;

pub mod telemetry;

pub mod report;

pub mod wire;
