//! What a simulated run takes from the job's workpiece: set up, watched while it runs, told and drawn at its end.

pub mod setup;

pub mod watch;

pub mod told;

pub mod drawn;
