//! What the tool does on its way through a slot: what it touches, by how much it misses everything else, and what it leaves.

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
