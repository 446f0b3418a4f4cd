//! Where a cut begins to chatter: the process in the time domain, its chips measured in the material, against tables of
//! the linear theory that an independent program made.
//!
//! `ARCFEED_SOAK_SECONDS=1 cargo test -p arcfeed-tests --test stability -- --nocapture` goes through every row, some minutes.

#[path = "../cutting_forces/rows.rs"]
mod rows;

mod milling;

mod tables;

mod flip;
