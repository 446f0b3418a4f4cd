//! The first thread of a program has 1 MiB of stack on Windows: no command depends on more.
#![cfg(unix)]

use std::process::Command;

use arcfeed_tests::{arcfeed, root};

#[test]
fn commands_run_where_the_first_thread_has_little_stack() {
    let job = "examples/ibr-slot/job.toml";
    for arguments in [&["check", job][..], &["adapt", job], &["simulate", job], &["stream", job, "--port", "sim:"]] {
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -s 256 && exec \"$@\"", "sh"]).arg(arcfeed()).args(arguments);
        let output = shell.current_dir(root()).output().expect("a shell");
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
}
