#![doc = include_str!("../README.md")]
//!
//! The workpiece, and what a moving tool takes from it: a tri-dexel model.
//!
//! Three families of parallel rays, along x, y and z, through the centres of the same cubic cells; of each ray its
//! stretches of material. A cut takes from every ray the stretch that the tool sweeps, computed in closed form for
//! a straight move of a tool with a fixed axis; other moves are made of such. What this costs and how far it is from the
//! truth: docs/stock.md.

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

pub mod level;

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
