#![doc = include_str!("../README.md")]
//!
//! [`dynamics`] is the displacement of modes under forces, [`modal_point`] what the modes of a body are at one of its points, [`flexible`] a workpiece
//! with its modes at the points of contact with a tool.

pub mod modal_point;

pub mod dynamics;

pub mod flexible;
