//! Telemetry: each override with its reason, for a logger and for the analysis of faults.
//!
//! The tick only pushes a [`record::TelemetryRecord`] into a [`log::RecordLog`]; the main loop sends them
//! ([`sender`]). A log that is not read is a black box with the last records before a fault.

pub mod reason;

pub mod record;

pub mod log;

pub mod sender;
