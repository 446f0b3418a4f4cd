//! The emulated board: its images built, started in QEMU, and talked to by its serial lines.

pub mod images;

pub mod log;

pub mod qemu;

pub mod lines;

pub mod host;

pub mod cable;

pub mod served;
