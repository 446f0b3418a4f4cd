//! The emulated board: its images built, started in QEMU, and talked to by its serial lines.

pub mod images;

pub mod qemu;

pub mod log;

pub mod lines;

pub mod host;

pub mod cable;

pub mod served;

pub mod served_chip;
