//! Where a cut begins to chatter: the process in the time domain, its chips measured in the material, against tables of
//! the linear theory that an independent program made.
//!
//! `ARCFEED_SOAK_SECONDS=1 cargo test -p arcfeed-tests --test machine stability:: -- --nocapture` goes through every row, some minutes.

mod milling;

mod tables;

mod flip;
