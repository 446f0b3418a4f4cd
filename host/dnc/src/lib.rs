#![doc = include_str!("../README.md")]
//!
//! DNC sender without I/O: the characters to send, the times at which they may go out, and the records for a restart.
//!
//! ```text
//!            DC1                 DC3                            hold, resume: from Sending and Stopped and back
//! Waiting ---------> Sending ---------> Stopped                 abort: to the end of the block under way, then Aborted
//!    |                 |  ^     DC1        |
//!    |                 |  +----------------+
//!    | no request      | last character    | no DC1
//!    v                 v                   v
//!  Failed             Sent              Failed
//! ```
//! [`transmission`] is the text to be sent, [`pace`] its timing, [`sender`] the state machine above, [`journal`] the
//! record for a restart, [`damage`] the monitor of damaged characters, [`readback`] the comparison with the control's
//! memory, [`reports`] the position reports of the control, [`resume`] the line and state of a restart, [`starvation`]
//! the prediction of waits for the line. Guarantees and limits: docs/dnc.md.

pub mod pace;

pub mod transmission;

pub mod readback;

pub mod sender;

pub mod outbox;

pub mod damage;

pub mod events;

pub mod journal;

pub mod functions;

pub mod restored_state;

pub mod reports;

pub mod resume;

pub mod starvation;

pub use sender::{Sender, State};
