//! Programs of the operating system that the tests run: present, or installed from Debian's packages; and what
//! `tests/wire/decode.py` decodes with, from the Python Package Index, into the build directory.

use std::process::{Command, Stdio};

use crate::command::{Failure, announce, build_dir, program, run};

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

/// What the script decodes with.
const PYTHON_PACKAGES: [&str; 2] = ["cobs==1.2.2", "crc==8.0.0"];

/// Installs what is missing.
///
/// # Errors
/// Not there and not to be had; says what was tried and what to do.
pub fn install() -> Result<(), Failure> {
    NEEDS.iter().map(install_one).fold(Ok(()), Result::and).and(install_python_packages())
}

/// Into `tools/python` of the build directory, where `tests/wire/python.rs` looks: no Python of the system is touched.
fn install_python_packages() -> Result<(), Failure> {
    announce("stuffing and checksums in Python, to decode with");
    let folder = build_dir()?.join("tools/python");
    let mut import = Command::new("python3");
    import.args(["-c", "import cobs.cobs, crc"]).env("PYTHONPATH", &folder);
    if import.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success()) {
        return Ok(());
    }
    let mut pip = program("python3", &["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--target"]);
    run(pip.arg(&folder).args(PYTHON_PACKAGES)).map_err(|failure| {
        let what = format!(
            "{} of the Python Package Index are missing ({}). With pip and the network, run `python3 -m pip install --target \
             {} {}`.",
            PYTHON_PACKAGES.join(" and "),
            failure.what,
            folder.display(),
            PYTHON_PACKAGES.join(" ")
        );
        Failure { what, ..failure }
    })
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
