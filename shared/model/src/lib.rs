#![doc = include_str!("../README.md")]
//!
//! A milling job as both ends hold it: tools, cut rules, stock shapes, limits, and which blocks a law governs.
//!
//! Modules stand in the order in which data flows; a module imports only from those above it: what the machine can do
//! ([`machine`]), what is cut with what ([`tool`], [`engaged`], [`stock`], [`knots`], [`cut`], [`job`]), which blocks that governs ([`governed`]),
//! and what comes back ([`telemetry`], [`report`]).
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

pub mod machine;

pub mod tool;

pub mod engaged;

pub mod stock;

pub mod knots;

pub mod cut;

pub mod job;

pub mod governed;

pub mod telemetry;

pub mod report;
