//! An STM32F405RG as arcfeed's board: modules of this folder's image. Wiring, pins and levels: README.md.
//!
//! Modules in the order of the data flow: [`machine`] has the machine's constants; [`program`] the job and its blocks;
//! [`reset_cause`], [`panel`] and [`guard`] are pure and tested on the host. Each of the others owns a peripheral and
//! contains the only `unsafe` code, the access to registers. [`board_io`] combines them into the tick.
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
