//! The feed controller: from segment, position and spindle speed to the override.
//!
//! No heap, no clock, no I/O: one call of [`supervisor::Supervisor::tick`] per sample of the position. Modules stand
//! in the order in which data flows: the [`law`] says which feed per tooth the tool's centre needs, [`progress`] says
//! where on the segment it is, [`ramp`] turns a wanted ratio into an override the control can follow, [`envelope`] lowers it in time for what comes further on, [`active`] is a segment with
//! all of that prepared, [`controller`] follows the position along it, [`supervisor`] decides whether the law may act and where the override goes, [`queue`] finds the segment in work where nobody tells, [`spsc`] is
//! what lies between main loop and tick, [`tap`] reads the program off the DNC line,
//! [`input`] makes sense of what a board counts and measures, [`output`] carries the override to the control, [`board`] is
//! the seam to the hardware, [`application`] a whole board between its link and its tick,
//! [`assembly`] puts one together, [`main_loop`] is
//! its side of the main loop, [`lockstep`] runs it at the pace of a simulated machine.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]
#![doc = include_str!("../README.md")]

pub mod law;

pub mod progress;

pub mod ramp;

pub mod envelope;

pub mod active;

pub mod controller;

pub mod supervisor;

pub mod queue;

pub mod spsc;

pub mod tap;

pub mod input;

pub mod output;

pub mod board;

pub mod application;

pub mod assembly;

pub mod main_loop;

pub mod lockstep;
