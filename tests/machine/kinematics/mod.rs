//! Five-axis kinematics against a published post-processor, closed forms, homogeneous matrices and brute force.
//! `cargo xtask soak` runs the full sets, `cargo xtask test` a seeded part of each.

mod bench;

mod oracle;

mod conventions;

mod published;

mod strategies;

mod leading_edge;

mod following;

mod governing;

mod round_trip;

mod course;

mod changes;

mod repairs;

mod between;

mod posting;

mod programs;
