#![doc = include_str!("../README.md")]
//!
//! The Fanuc dialect: text to words to blocks to modal motions. Only macros allocate memory.
//!
//! The parser needs only the line as context, the interpreter only [`modal::Modal`]. Every fault carries its column;
//! the caller knows the line.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

pub mod tape_code;

pub mod macro_alarm;

pub mod alarm;

pub mod number;

pub mod word;

pub mod text;

pub mod motion;

pub mod settings;

mod scale;

pub mod block;

pub mod axis_scaling;

pub mod frame;

pub mod series;

pub mod machining;

pub mod modal;

pub mod address;

pub(crate) mod rollback;

mod codes;

mod moves;

mod corners;

mod scaling;

mod oneshot;

mod cycles;

pub mod interpret;

pub mod radius;

pub mod segment;

pub mod reader;
