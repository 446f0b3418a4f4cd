//! The DNC sender without I/O: what goes out, when, and what is known of it afterwards.
//!
//! ```text
//!            DC1                 DC3                            hold, resume: from Sending and Stopped and back
//! Waiting ---------> Sending ---------> Stopped                 abort: to the end of the block under way, then Cut
//!    |                 |  ^     DC1        |
//!    |                 |  +----------------+
//!    | nobody asks     | last character    | no DC1
//!    v                 v                   v
//!  Failed             Sent              Failed
//! ```
//! [`transmission`] is what is sent, [`pace`] says when, [`sender`] is the machine above, [`journal`] what a restart knows,
//! [`damage`] what the operating system has seen go wrong, [`readback`] what comes back from its memory, [`reports`] what the control says of itself, [`resume`] where and in which state it can take up the program, [`starvation`] where the line will be too slow. What is
//! guaranteed and what is not: docs/dnc.md.

pub mod pace;

pub mod transmission;

pub mod readback;

pub mod sender;

pub mod outbox;

pub mod damage;

pub mod events;

pub mod journal;

pub mod functions;

pub mod restore;

pub mod reports;

pub mod resume;

pub mod starvation;

pub use sender::{Sender, State};
