//! What the figures of the chip are measured with, the same on the desk and in the board images.
//!
//! [`thesis`] is the yardstick of the tick's cost: the source's own route, written down as printed. Nothing here is part
//! of the controller.
#![cfg_attr(not(test), no_std)]

pub mod thesis;
