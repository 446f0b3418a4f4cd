//! `simulate` with a workpiece, as a whole: programs through control, axes and stock, held to closed forms that nothing of
//! this project made, and the output for them.
#![cfg(unix)]

mod scratch_job;

mod spindle_limits;

mod volumes;

mod left_out;

mod files;

mod indexed;

mod complaints;
