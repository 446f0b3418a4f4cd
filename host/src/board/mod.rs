//! Feed board seen from the host: link, data of a run, and the board's reports.
//!
//! ```text
//! program as sent + job -> plan -> Board -- parameters, segments ahead of the control --> link -> port -> board
//!                                    ^------------------- reports, answers -------------------------------+
//! ```

pub mod words;

pub mod line;

pub mod plan;

pub mod standstill;

mod rise;

pub mod run;
