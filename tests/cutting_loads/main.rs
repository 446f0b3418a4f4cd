//! `simulate` with edges in the workpiece, as a whole: chips, forces, torque and power of programs held to closed forms and root
//! finding that nothing of the measured chips went into, and what is wrong with a `[cutting]`.
#![cfg(unix)]

#[path = "../cutting_forces/trochoid.rs"]
mod trochoid;

#[path = "../fe/at_nodes.rs"]
mod at_nodes;

#[path = "../fe/surfaces.rs"]
mod surfaces;

mod story;

mod slots;

mod ends;

mod arcs;

mod complaints;

mod vibration;

mod marks;

mod flexible;

mod sheet;

mod wall;
