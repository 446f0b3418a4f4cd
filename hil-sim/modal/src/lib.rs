#![doc = include_str!("../README.md")]
//!
//! Modes of tools and workpieces, and their motion under forces.
//!
//! [`fe`] computes modes by finite elements, [`dynamics`] the displacement of modes under forces, [`flexible`] the modes at the
//! points of contact with a tool.

pub mod fe;

pub mod dynamics;

pub mod flexible;
