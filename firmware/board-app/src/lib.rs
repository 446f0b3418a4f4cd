#![doc = include_str!("../README.md")]
//!
//! Application of a feed board.
//!
//! [`spsc`] connects main loop and tick; [`tap`] reads the program off the DNC line; [`application`] is a board between its
//! link and its tick; [`assembly`] puts one together; [`main_loop`] is its main loop; [`lockstep`] runs it synchronously
//! with a simulated machine.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

pub mod spsc;

pub mod tap;

pub mod application;

pub mod assembly;

pub mod main_loop;

pub mod lockstep;
