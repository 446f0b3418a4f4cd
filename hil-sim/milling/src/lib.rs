#![doc = include_str!("../README.md")]
//!
//! Milling: chips, forces and vibrations.
//!
//! [`cutting`] measures the chip of every edge in the stock and works out the forces on the tool. A [`process`] combines these
//! with the modes of tool and workpiece; [`stability`] has the depth limits of the linear theory.

pub mod cutting;

pub mod process;

pub mod stability;
