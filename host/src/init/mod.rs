//! First job file for an existing program: survey of the program, proposal, and open questions.

pub mod answers;

pub mod survey;

pub mod groups;

pub mod proposal;

pub mod wording;

pub mod findings;

mod tool_tables;

pub mod job_writer;
