//! The long campaigns: the same code as in `cargo xtask test`, for longer and from other seeds.

use crate::command::{Failure, announce, cargo, run};

/// Minutes for each target, unless given.
const MINUTES: u64 = 10;
const SECONDS_PER_MIN: u64 = 60;
/// Tests with a full set, and what their names begin with.
const CAMPAIGNS: [(&str, &str); 14] = [
    ("feed", ""),
    ("line", "dnc::"),
    ("line", "campaigns::"),
    ("line", "wire::"),
    ("line", "application::"),
    ("line", "serving_clients::"),
    ("board", ""),
    ("plan", "widths::"),
    ("plan", "repair::large_clouds::"),
    ("plan", "plunge::"),
    ("plan", "symmetry::"),
    ("machine", "drives::"),
    ("machine", "kinematics::"),
    ("program", "fuzz::"),
];

/// Runs the full sets, and feeds every target of `tests/program/fuzz` for some minutes.
///
/// # Errors
/// The minutes are no number, a target panics or hangs, or a fault on the line is passed over.
pub fn soak(minutes: Option<&str>) -> Result<(), Failure> {
    let minutes = match minutes {
        Some(text) => {
            text.parse().map_err(|_| Failure { what: format!("`{text}` is no number of minutes"), code: 2 })?
        }
        None => MINUTES,
    };
    announce(&format!("soak: {minutes} minutes for each target"));
    let seconds = (minutes * SECONDS_PER_MIN).to_string();
    CAMPAIGNS.into_iter().try_for_each(|(test, filter)| {
        let mut tests = cargo(&["test", "--workspace", "--test", test, "--", "--nocapture", filter]);
        run(tests.env("ARCFEED_SOAK_SECONDS", &seconds))
    })
}
