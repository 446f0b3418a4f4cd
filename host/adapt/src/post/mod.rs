//! From CL data to a machine's program and back: APT `GOTO/x,y,z,i,j,k` <-> NC.
//!
//! [`cl`] reads and writes CL data, [`plan`] chooses the axes and reports faults ([`finding`]), [`nc`] writes the
//! program in one of three modes, [`cl_from_nc`] reads such a program. [`walk`] follows any program move by move, and
//! [`check`] checks it. [`chart`] draws the first rotary axis over the tool's directions.

pub mod cl;

pub mod finding;

pub mod plan;

pub mod nc;

pub mod cl_from_nc;

pub mod walk;

pub mod check;

pub mod chart;
