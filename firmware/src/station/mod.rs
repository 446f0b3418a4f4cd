//! The application of a board: the same object in process and on the chip.
//!
//! ```text
//! main loop:   bytes of the link -> Desk -- orders (in order), words (at once) --+        bytes of the link <- Desk
//!                                                                                v                              ^
//! each tick:   Sensors --------------------------------------------------> Ticker -> Output, to the lines       |
//!                                                                                +--- told ---------------------+
//! ```
//!
//! [`desk::Desk`] decodes, checks and prepares; [`ticker::Ticker`] decides, and is never in the main loop's way nor it in
//! its. Between them are three queues of one producer and one consumer. No clock, no I/O: `now` and bytes are arguments. What
//! happens after which fault, and how soon, is in docs/board-safety.md.

pub mod arcs;

pub mod papers;

pub mod identity;

pub mod order;

pub mod report;

pub mod sensors;

pub mod ticker;

pub mod knobs;

pub mod dispatch;

pub mod clerk;

pub mod desk;
