#![doc = include_str!("../README.md")]
//!
//! Plans the path of a cup mill, or of a plunge mill, between the blades of a rotor, or finishing passes over a blade, and proves that the tool
//! collides with nothing.
//!
//! M. Petean, *Roughing integrally bladed rotors using cup mill cutters*, master's thesis, Ecole Polytechnique de Montreal
//! 2004, chapters 3 and 4, without a CAD system; An Luling et al., *Five-axis plunge milling tool path generation of integral
//! impellers*. Nothing here reads or writes files.
//!
//! # Frames
//!
//! *Part*: the rotor's axis is z; blades count upwards with the angle about it. *Slot*: the tool's axis is z, pointing from the
//! part to the spindle; y is the rotor's axis seen along the tool, x completes them. Both share their origin. A slot's coordinates
//! are those of the NC program. All lengths are millimetres, all angles radians unless their names say otherwise.

pub mod vector;

pub mod search;

mod parallel;

pub mod geometry;

pub mod cutter;

pub mod frame;

pub mod path;

pub mod placement;

pub mod cup_mill;

pub mod proof;

pub mod axis_search;

pub mod optimisation;

pub mod rings;

pub mod plunge;

pub mod finish;

pub mod repair;

pub mod output;
