//! What a run takes from a workpiece: the way that the axes have gone, cut from a stock block by block.
//!
//! The way is the one executed, sampled once a millisecond, not the one programmed: [`trail`] makes chords of it, [`periods`] has its periods one by one,
//! [`placing`] says where tool and part are to each other then, [`cutter`] takes the material, [`rate`] has the removal
//! rates; [`loads`] asks the edges for their chips and forces, [`tally`] counts them, [`marks`] has what they leave on the walls;
//! [`flexible_workpiece`] is a workpiece that gives way to them; [`engagement`] looks where the tool stands in material. What is left out, and how
//! exact it is: docs/simulate.md.

pub mod trail;

pub mod periods;

pub mod placing;

pub mod rate;

pub mod cutter;

pub mod tally;

pub mod steadiness;

pub mod way;

pub mod envelope;

pub mod marks;

pub mod flexible_workpiece;

pub mod loads;

pub mod engagement;
