//! `simulate` with edges in the workpiece, as a whole: chips, forces, torque and power of programs held to closed forms and root
//! finding that nothing of the measured chips went into, and what is wrong with a `[cutting]`.
#![cfg(unix)]

mod slot_job;

mod slots;

mod ends;

mod tilted;

mod indexed;

mod arcs;

mod complaints;

mod vibration;

mod marks;

mod flexible;

mod sheet;

mod wall;
