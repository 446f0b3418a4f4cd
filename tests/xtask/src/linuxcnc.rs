//! Figures of the published slot on LinuxCNC: as programmed, with F words, and with the component.

use std::fs;

use crate::command::{Failure, announce, build_dir, cargo, run};
use crate::packages;

/// Test that prints them.
const TEST: &str = "slot::";
/// Sets of all levels, as for `soak`.
const FULL_SET: (&str, &str) = ("ARCFEED_SOAK_SECONDS", "0");

/// Installs LinuxCNC if it is missing, builds the component, and runs the slot on every level.
///
/// # Errors
/// LinuxCNC cannot be installed or run here, or a figure is out of its bounds.
pub fn figures() -> Result<(), Failure> {
    packages::install_linuxcnc()?;
    announce("the slot on LinuxCNC, three times in real time: about four minutes after the build");
    let log = build_dir()?.join("linuxcnc-skipped.txt");
    let _was_not_there = fs::remove_file(&log);
    let arguments = ["test", "--workspace", "--test", "linuxcnc", "--", "--nocapture", TEST];
    run(cargo(&arguments).env(FULL_SET.0, FULL_SET.1).env("ARCFEED_SKIP_LOG", &log))?;
    match fs::read_to_string(&log) {
        Ok(skipped) => Err(Failure::new(skipped.trim_end().to_owned())),
        Err(_) => Ok(()),
    }
}
