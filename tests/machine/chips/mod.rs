//! Chips measured in the material by the edges of a cutter, against closed forms, root finding and the geometric meter.

mod bench;

mod trochoids;

mod teeth;

mod volumes;

mod ends;

mod slot;
