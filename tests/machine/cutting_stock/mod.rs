//! `simulate` with a workpiece, as a whole: programs through control, axes and stock, held to closed forms that nothing of
//! this project made, and what it tells of them.
#![cfg(unix)]

mod story;

mod volumes;

mod left_out;

mod files;

mod complaints;
