//! An STM32F405RG as arcfeed's board: what the image of this folder is made of. Wiring, pins and levels: README.md.
//!
//! One idea a file, in the order in which data flows. [`machine`] has what differs from machine to machine; [`program`] the
//! job and its blocks; [`reset_cause`], [`panel`] and [`guard`] are pure and are tested on the host; the others own a
//! peripheral each, and hold the only `unsafe`: registers. [`board_io`] joins them to one tick.
#![no_std]

pub mod machine;

pub mod program;

pub mod reset_cause;

pub mod clock;

pub mod pins;

pub mod watchdog;

pub mod tick_timer;

pub mod encoders;

pub mod spindle;

pub mod dial;

pub mod panel;

pub mod lines;

pub mod guard;

pub mod board_io;
