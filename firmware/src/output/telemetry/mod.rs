//! What was put out and why, for a logger or for the time after a fault.
//!
//! The tick only pushes a [`record::TelemetryRecord`] into a [`log::RecordLog`]; who has time for a line sends from
//! there ([`sender`]). A log that nobody empties is the black box: the last records before a fault.

pub mod reason;

pub mod record;

pub mod log;

pub mod sender;
