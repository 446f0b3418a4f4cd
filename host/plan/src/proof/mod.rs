//! What the tool does on its way through a slot: what it touches, by how much it misses everything else, and what it leaves.
//!
//! Distances hold for every point of the way and of the obstacles, not for samples: bounds, not estimates. The way begins above everything that turns
//! (`turning`) and has no gaps, so a tool that comes nowhere near a surface is nowhere behind it. Body and holder are held against
//! the blank before its first cut: what the ring has removed could only help.
//!
//! Not looked at: what bends, runs out or is out of place; the machine's own parts; the rounding of the NC program's numbers (half a digit of
//! theirs); fixtures but for boxes. A blade is what its two faces and straight edges between them enclose.

pub mod spheres;

pub mod motion;

pub mod section;

pub mod bound;

pub mod search;

pub mod bodies;

pub mod clearance;

pub mod left;

pub mod floor;

pub mod removed;

pub mod turning;

pub mod verdict;
