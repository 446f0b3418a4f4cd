//! The DNC sender against the simulated control, in simulated time and as processes: what arrives, what is noticed, and
//! what a restart does. `cargo xtask soak` runs the full sets, `cargo xtask test` a seeded part of each.

mod line;

mod schedule;

mod program;

mod campaign;

mod echo;

mod utilization;

mod resume;

mod peers;

#[cfg(unix)]
mod kill;

#[cfg(unix)]
mod command;

#[cfg(unix)]
mod lost;

#[cfg(unix)]
mod unread;

#[cfg(unix)]
mod verify;

#[cfg(target_os = "linux")]
mod port;
