//! The long campaigns: the same code as in `cargo xtask test`, for longer and from other seeds.

use crate::command::{Failure, announce, cargo, run};

/// Minutes for each target, unless told otherwise.
const MINUTES: u64 = 10;
const SECONDS_PER_MIN: u64 = 60;

/// Feeds every target of `tests/fuzz` for some minutes, and runs the full sets of `tests/dnc`, `tests/wire`, `tests/station`,
/// `tests/board`, `tests/kinematics` and `tests/serving_clients.rs`.
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
    let soaked = |test| {
        let mut tests =
            cargo(&["test", "--release", "--package", "arcfeed-tests", "--test", test, "--", "--nocapture"]);
        run(tests.env("ARCFEED_SOAK_SECONDS", &seconds))
    };
    soaked("dnc")?;
    soaked("wire")?;
    soaked("station")?;
    soaked("board")?;
    soaked("kinematics")?;
    soaked("serving_clients")?;
    soaked("fuzz")
}
