//! The feed board, as the host sees it: its link, what a run gives it, and what it says.
//!
//! ```text
//! program as sent + job -> plan -> Board -- parameters, segments ahead of the control --> link -> port -> board
//!                                    ^------------------- reports, answers -------------------------------+
//! ```

pub mod words;

pub mod line;

pub mod plan;

pub mod standstill;

pub mod run;
