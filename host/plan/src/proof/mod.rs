//! Proof of the tool's path through a slot: collisions, clearances, and remaining material.
//!
//! Distances hold for every point of the path and of the obstacles, not for samples: bounds, not estimates. The path
//! begins above everything that turns (`geometry::turning_height`) and has no gaps, so a tool that stays away from a surface is never
//! behind it. Body and holder are checked against the blank before its first cut: removed material could only help.
//!
//! Not covered: deflection, runout and misalignment; the machine's own parts; the rounding of the NC program's numbers
//! (half of the last digit); fixtures that are no boxes. A blade is the volume between its two faces and straight edges
//! between them.

pub mod spheres;

pub mod motion;

pub mod section;

pub mod bound;

pub mod search;

pub mod bodies;

pub mod clearance;

pub mod remaining;

pub mod floor;

pub mod earlier;

pub mod removal;

pub mod verdict;
