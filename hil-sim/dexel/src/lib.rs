#![doc = include_str!("../README.md")]
//!
//! The workpiece as a tri-dexel model, and the material that a moving tool removes from it.
//!
//! Three families of parallel rays, along x, y and z, pass through the centres of the same cubic cells; each ray (dexel) is
//! stored as its intervals of material. A cut removes from every ray the interval that the tool sweeps. That interval is computed
//! in closed form for a straight move of a tool with a fixed axis (a sweep); all other moves are approximated by sweeps. Cost and
//! accuracy: docs/stock.md.

pub mod frame;

pub mod dexel;

pub mod lattice;

pub mod profile;

pub mod slab;

pub mod monotone;

pub mod tool;

pub mod quadratic;

pub mod section;

pub mod flat;

pub mod band;

pub mod level;

pub mod ball;

mod slab_shape;

pub mod sweep;

pub mod grid;

pub mod motion;

pub mod solid;

pub mod mesh;

pub mod outline;

pub mod files;

pub mod workpiece;

pub mod surface;

pub mod deviation;
