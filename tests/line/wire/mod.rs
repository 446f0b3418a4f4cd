//! The board link as docs/protocol.md promises it: two ends in virtual time over lines that lose, corrupt, repeat and delay, and
//! the document's own examples. `cargo xtask soak` runs the full sets, `cargo xtask test` a seeded part of each.

mod sim;

mod schedule;

mod campaign;

mod table;

mod restart;

mod corruption;

mod document;

mod python;
