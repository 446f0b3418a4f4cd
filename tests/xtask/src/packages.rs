//! Programs of the operating system that the tests run: present, or installed from Debian's packages.

use std::process::{Command, Stdio};

use crate::command::{Failure, announce, program, run};

/// What the tests need, and the package it comes in.
struct Need {
    what: &'static str,
    package: &'static str,
    /// Any of these that ends well shows that it is there.
    shown_by: &'static [&'static [&'static str]],
    elsewhere: &'static str,
}

const NEEDS: [Need; 2] = [
    Need {
        what: "emulator of the chip",
        package: "qemu-system-arm",
        shown_by: &[&["qemu-system-arm", "--version"]],
        elsewhere: "install QEMU with its Arm target",
    },
    Need {
        what: "pyserial, to talk to",
        package: "python3-serial",
        // Debian's packages are seen by Debian's Python alone, which need not be the first in the path.
        shown_by: &[&["python3", "-c", "import serial.rfc2217"], &["/usr/bin/python3", "-c", "import serial.rfc2217"]],
        elsewhere: "run `python3 -m pip install pyserial`",
    },
];

/// Installs what is missing.
///
/// # Errors
/// Not there and not to be had; says what was tried and what to do.
pub fn install() -> Result<(), Failure> {
    NEEDS.iter().map(install_one).fold(Ok(()), Result::and)
}

fn install_one(need: &Need) -> Result<(), Failure> {
    announce(need.what);
    if is_there(need) {
        return Ok(());
    }
    announce(&format!("installing {}", need.package));
    let explained = |failure| explain(need, failure);
    run(&mut apt_get(&["update"])).map_err(explained)?;
    run(&mut apt_get(&["install", "-y", "--no-install-recommends", need.package])).map_err(explained)?;
    if is_there(need) { Ok(()) } else { Err(explained(Failure::new("installed, but does not run"))) }
}

fn is_there(need: &Need) -> bool {
    let ends_well = |words: &&[&str]| {
        let [name, arguments @ ..] = *words else { return false };
        let status = Command::new(name).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
        status.is_ok_and(|status| status.success())
    };
    need.shown_by.iter().any(ends_well)
}

fn apt_get(arguments: &[&str]) -> Command {
    let mut command = program("apt-get", arguments);
    command.env("DEBIAN_FRONTEND", "noninteractive");
    command
}

fn explain(need: &Need, failure: Failure) -> Failure {
    let Need { what, package, elsewhere, .. } = need;
    let what = format!(
        "{what}: {package} is missing ({}). On Debian or Ubuntu run `apt-get update && apt-get install {package}` as \
         root; elsewhere {elsewhere}.",
        failure.what
    );
    Failure { what, ..failure }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_noticed() {
        let need = |shown_by| Need { what: "x", package: "x", shown_by, elsewhere: "x" };
        assert!(is_there(&need(&[&["no-such-program"], &["true"]])));
        assert!(!is_there(&need(&[&["no-such-program"], &["false"]])));
    }
}
