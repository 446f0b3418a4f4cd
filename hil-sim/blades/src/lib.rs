#![doc = include_str!("../README.md")]
//!
//! Blades and the tools that finish them: modes, and the surface that is left.
//!
//! [`beam`], [`blade`] and [`disk`] are shapes for the finite elements of `arcfeed-fe`; [`cyclic`] and [`disk_field`] compute the modes of a disk from one
//! sector. A [`finishing`] pass along a blade leaves marks.

pub mod beam;

pub mod blade;

pub mod disk;

pub mod cyclic;

pub mod disk_field;

pub mod finishing;
