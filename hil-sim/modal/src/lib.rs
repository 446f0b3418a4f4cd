#![doc = include_str!("../README.md")]
//!
//! [`modal_point`] has the mode shapes at one point of a body, [`dynamics`] the displacement of modes under forces, [`flexible`] a workpiece with its modes
//! at the points of contact with a tool.

pub mod modal_point;

pub mod dynamics;

pub mod flexible;
