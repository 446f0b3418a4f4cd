//! The board link: frames on a serial line, and what both ends promise each other on top of them.
//!
//! Normative: `docs/protocol.md`. Sans-IO throughout: bytes and the time go in, bytes and the time of the next call come out; both
//! ends run the same [`link::Link`]. A line that needs no link ([`frame::Class::Plain`]) has [`frame::encode`] and a
//! [`deframer::Deframer`].

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
