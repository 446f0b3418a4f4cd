#![doc = include_str!("../README.md")]
//!
//! Kinematics of five-axis machines: poses of the tool, positions of the axes, and the motion between two poses.
//!
//! Everything is f64. Lengths are millimetres, angles degrees. Frames:
//!
//! | frame | what |
//! |---|---|
//! | part | what CL data are written in; fixed to the part |
//! | machine | fixed to the bed; at positions zero of all axes the part's axes are parallel to it |
//!
//! A rotary axis counts positive where it turns the *tool relative to the part* by the right-hand rule about its direction
//! vector (ISO 841 for A, B, C about +X, +Y, +Z). A table whose scale counts the other way has the vector reversed.
//!
//! docs/kinematics.md has conventions, machines and figures.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

extern crate alloc;

pub mod vector;

pub mod machine;

pub mod forward;

pub mod inverse;

pub mod deviation;

pub mod branch_selection;

pub mod branch_change;

pub mod singularity;

pub mod linearise;

pub mod feed;

pub mod tip_feed;
