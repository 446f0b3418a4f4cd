//! Material removal of a run: cuts the executed path of the axes from a stock, block by block.
//!
//! The path is the executed one, sampled once a millisecond, not the programmed one. [`trail`] approximates it by
//! chords, [`periods`] gives its periods one by one, [`placement`] computes the tool's position on the part, [`cutter`]
//! removes the material, [`rate`] computes removal rates. [`loads`] computes chips and forces of the edges, [`load_statistics`]
//! their statistics, [`tooth_passes`] the passes of the teeth, [`marks`] the marks that they leave on the walls. [`flexible_workpiece`] is a workpiece that bends
//! under them, [`tilted`] the workpiece in layers square to a tilted tool; [`engagement`] finds the engaged arcs, [`sections`] the engaged sections of descending moves. Omissions and accuracy: docs/simulate.md.

pub mod trail;

pub mod periods;

pub mod placement;

pub mod rate;

pub mod cutter;

pub mod load_statistics;

pub mod tooth_passes;

pub mod chatter_detection;

pub mod tip_path;

pub mod envelope;

pub mod marks;

pub mod flexible_workpiece;

pub mod tilted;

pub mod loads;

pub mod sections;

mod heading;

pub mod engagement;
