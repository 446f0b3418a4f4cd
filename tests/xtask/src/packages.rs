//! Programs of the operating system that the tests run: present, or installed from Debian's packages.

use std::process::{Command, Stdio};

use crate::command::{Failure, announce, program, run};

/// The emulator of the chip, and the package it comes in.
const EMULATOR: &str = "qemu-system-arm";

/// Installs the emulator where it is missing.
///
/// # Errors
/// Not there and not to be had; says what was tried and what to do.
pub fn install() -> Result<(), Failure> {
    announce("emulator of the chip");
    if is_there(EMULATOR) {
        return Ok(());
    }
    announce(&format!("installing {EMULATOR}"));
    run(&mut apt_get(&["update"])).map_err(explain)?;
    run(&mut apt_get(&["install", "-y", "--no-install-recommends", EMULATOR])).map_err(explain)?;
    if is_there(EMULATOR) { Ok(()) } else { Err(explain(Failure::new("installed, but does not run"))) }
}

fn is_there(name: &str) -> bool {
    let status = Command::new(name).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

fn apt_get(arguments: &[&str]) -> Command {
    let mut command = program("apt-get", arguments);
    command.env("DEBIAN_FRONTEND", "noninteractive");
    command
}

fn explain(failure: Failure) -> Failure {
    let what = format!(
        "the chip's figures cannot be taken: {EMULATOR} is missing ({}). On Debian or Ubuntu run `apt-get update && \
         apt-get install {EMULATOR}` as root; elsewhere install QEMU with its Arm target.",
        failure.what
    );
    Failure { what, ..failure }
}
