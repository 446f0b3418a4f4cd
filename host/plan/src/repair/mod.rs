//! Planning of the milling of repaired blades, one step per file: from measured points to what finishing leaves on the nominal surface.
//!
//! Source: Feng, Ren, Xu, *Tool path planning in milling of repaired blades of blisks*. The paper names the steps and gives few formulas; the files
//! state which are its own and which of its equations are corrected. Its parameters are u from the root (0) to the tip (1) and v from the leading (0)
//! to the trailing edge (1).

pub mod blend;

pub mod arc_length;

pub mod stepover;

pub mod registration;

pub mod evenness;

pub mod scan;

pub mod blade;

pub mod cloud_check;

pub mod field;

pub mod border;

pub mod regions;

pub mod passes;

pub mod plan;

pub mod tool_path;

pub mod prediction;

pub mod solids;
