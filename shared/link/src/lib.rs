#![doc = include_str!("../README.md")]
//!
//! The board link: frames on a serial line, and a session protocol on top of them.
//!
//! Normative: `docs/protocol.md`. Sans-IO throughout: the input is bytes and the time, the output is bytes and the
//! time of the next call. Both ends run the same [`link::Link`]. A line without a link ([`frame::FrameClass::Plain`]) uses
//! [`frame::encode`] and a [`deframer::Deframer`].
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

pub mod frame;

pub mod deframer;

pub mod state;

pub mod settings;

pub mod counters;

pub mod session;

pub mod clock;

pub mod rto;

pub mod pace;

pub mod reliable;

pub mod latest;

pub mod link;

pub mod message;

pub mod plain;
