//! Chips measured in the material by the edges of a cutter, against closed forms, root finding and the geometric meter.

#[path = "../cutting_forces/rows.rs"]
mod rows;

#[path = "../cutting_forces/trochoid.rs"]
mod trochoid;

mod bench;

mod trochoids;

mod teeth;

mod volumes;

mod ends;

mod slot;
