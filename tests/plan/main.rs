//! The planner: what it makes of a rotor, held to what the planner did not make.

mod job;
mod limits;
mod listing;
mod rise;
