//! Programs run by valgrind.

use std::path::Path;
use std::process::Command;

use crate::{root, skip_loudly};

/// Valgrind, to be given its tool and a program. A test without it says so loudly.
pub fn valgrind_or_skip(test: &str) -> Option<Command> {
    if Command::new("valgrind").arg("--version").output().is_ok() {
        return Some(Command::new("valgrind"));
    }
    skip_loudly(test, "there is no valgrind (Debian's package)");
    None
}

/// Instructions of a run in the root of the workspace, as callgrind counts them.
///
/// # Panics
/// The run does not end well, or there is no valgrind.
pub fn instructions(program: &Path, arguments: &[&str]) -> u64 {
    let mut callgrind = Command::new("valgrind");
    callgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(program).args(arguments);
    let output = callgrind.current_dir(root()).output().expect("valgrind is installed");
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    let total = text.lines().find_map(|line| line.split_once("Collected :"));
    total.and_then(|(_, count)| count.trim().parse().ok()).expect("callgrind counts")
}
