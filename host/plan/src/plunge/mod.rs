//! Planning of plunge milling, one step per file: from the blades about a passage to the axes along which a mill bores it out.

pub mod measure;

pub mod machinability;

pub mod reach;

pub mod line;

pub mod step;

pub mod disc;

mod distance;

pub mod field;

pub mod boundary;

pub mod infeasibility;

pub mod mill;

pub mod passage;

pub mod section;

pub mod column;

mod material;

pub mod rows;

pub mod faces;

pub mod passage_plan;

pub mod left_over;

pub mod removed;

pub mod assembly;

pub mod plan;

pub mod proof;
