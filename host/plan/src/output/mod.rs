//! Output of the planner, as text and bytes.

pub mod words;

pub mod nc;

pub mod limits;

pub mod job;

pub mod stl;

pub mod baseline;

pub mod plunge_nc;

pub mod end_mill_job;
