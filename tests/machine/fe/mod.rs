//! Finite elements against closed forms, published tables and each other: what vibrates how fast, in which shape, and what a
//! force at a point does.

mod random;

pub mod at_nodes;

mod beams;

mod plates;

mod solver;

mod points;

mod disks;

mod twisted_beam;

pub mod surfaces;

mod sheets;
