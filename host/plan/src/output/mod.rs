//! Output of the planner, as text and bytes.

pub mod words;

pub mod nc;

pub mod limits;

mod toml_text;

pub mod workpiece;

pub mod job;

pub mod stl;

pub mod baseline;

pub mod plunge_nc;

pub mod end_mill_job;
