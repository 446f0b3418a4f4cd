//! `arcfeed` with unread output or a full disk: the sender continues, and never panics.

use std::fs::File;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

use arcfeed_tests::{Scratch, arcfeed, root, run};

use crate::dnc::kill::lines;

const JOB: &str = "examples/ibr-slot/job.toml";

/// A pipe whose reader has gone, and a full disk where the system has one.
fn dead_ends() -> Vec<Stdio> {
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    let full = Path::new("/dev/full");
    let disk = full.exists().then(|| File::create(full).expect("it opens for writing").into());
    [writer.into()].into_iter().chain(disk).collect()
}

/// Runs `arcfeed`; answers how it ended, and what it wrote to the other of stdout and stderr.
fn blind(arguments: &[&str], stderr: Option<Stdio>, stdout: Option<Stdio>) -> (ExitStatus, String) {
    let mut command = Command::new(arcfeed());
    command.args(arguments).current_dir(root());
    command.stdout(stdout.unwrap_or_else(Stdio::piped)).stderr(stderr.unwrap_or_else(Stdio::piped));
    let output = command.spawn().and_then(std::process::Child::wait_with_output).expect("arcfeed runs");
    (output.status, String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned())
}

/// The journal's last record.
fn last_record(scratch: &Scratch) -> String {
    lines(scratch, "journal").pop().unwrap_or_default()
}

#[test]
fn a_program_is_sent_to_its_end_although_stderr_is_not_read() {
    let scratch = Scratch::new("unread-stderr");
    let (journal, executed) = (scratch.path("journal"), scratch.path("executed.nc"));
    let stream = |port| ["stream", JOB, "--port", port, "--journal", &journal, "--executed", &executed, "--json"];
    assert!(run(&stream("sim:")).status.success());
    let wanted = lines(&scratch, "executed.nc");
    for stderr in dead_ends() {
        // The spy writes to stderr with the first characters, and complains there that it cannot.
        let (status, out) = blind(&stream("spy://sim:"), Some(stderr), None);
        assert_eq!(status.code(), Some(0), "{out}");
        assert_eq!(lines(&scratch, "executed.nc"), wanted);
        assert!(last_record(&scratch).ends_with("reason=complete"), "{}", last_record(&scratch));
    }
}

#[test]
fn a_program_is_sent_to_its_end_although_stdout_is_not_read() {
    let scratch = Scratch::new("unread-stdout");
    let journal = scratch.path("journal");
    for (stdout, code) in dead_ends().into_iter().zip([141, 1]) {
        let (status, err) = blind(&["stream", JOB, "--journal", &journal, "--json"], None, Some(stdout));
        assert_eq!(status.code(), Some(code), "{err}");
        assert!(last_record(&scratch).ends_with("reason=complete"), "{}", last_record(&scratch));
        assert_eq!(err.contains("stdout: "), code == 1, "{err}");
    }
}

#[test]
fn commands_that_only_print_end_when_their_output_is_not_read() {
    for arguments in [&["adapt", JOB, "--json"][..], &["check", "examples/ibr-slot/ibr-slot.nc"], &["simulate", JOB]] {
        for (stdout, code) in dead_ends().into_iter().zip([141, 1]) {
            let (status, err) = blind(arguments, None, Some(stdout));
            assert_eq!(status.code(), Some(code), "{arguments:?}: {err}");
            assert!(!err.contains("panicked"), "{err}");
        }
    }
}

#[test]
fn figures_are_printed_though_the_report_cannot_be_written() {
    let scratch = Scratch::new("unwritten-report");
    let output = run(&["simulate", JOB, "--json", "--report", &scratch.path("no-folder/report.html")]);
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains("no-folder/report.html") && out.contains("\"chip_load\":{"), "{err}{out}");
}
