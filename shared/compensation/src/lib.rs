#![doc = include_str!("../README.md")]
//!
//! Cutter radius compensation: moves along a contour in, moves of the tool centre out.
//!
//! [`compensator::Compensator`] holds back one move in the plane until the next one is known, and with it the corner
//! between them. [`insertion::InsertedCorner`] joins two moves with a chamfer or a rounded corner. [`contour::ContourCommand`] is what a block of an [`arcfeed_nc::reader::Reader`] commands.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod vector;

mod element;

mod corner;

mod offset_path;

pub mod insertion;

pub mod inside_arc;

pub mod compensator;

pub mod contour;
