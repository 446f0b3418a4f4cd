//! Onset of chatter: the process in the time domain, with chips measured in the material, compared with tables of the
//! linear theory made by an independent program; and the product's own limits of that theory.
//!
//! `ARCFEED_SOAK_SECONDS=1 cargo test -p arcfeed-tests --test machine stability:: -- --nocapture` goes through every row, some minutes.

mod milling;

mod tables;

mod flip;

mod limits;

mod lobes;
