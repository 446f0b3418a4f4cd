//! Processor time that `check` and `adapt` need for a line, as instructions that callgrind counts: the same on every computer, busy or not.
#![cfg(target_os = "linux")]

use std::process::Command;

use arcfeed_tests::{Scratch, arcfeed, root, skip_loudly};

use crate::program_memory::{job, program};

/// Lines of the shorter and of the longer program: the difference is that of the lines alone.
const LINES: [usize; 2] = [500, 1_500];

/// Most instructions for a line in the tests' profile, a fifth more than they take. The shipped program needs a fourth to a sixth (docs/build.md).
const CHECK_MAX: u64 = 14_500;
const ADAPT_MAX: u64 = 155_000;

/// Instructions of a run that ends well.
fn instructions(arguments: &[&str]) -> u64 {
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(arcfeed()).args(arguments);
    let output = valgrind.current_dir(root()).output().expect("it runs");
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let (_, count) = text.rsplit_once("Collected :").expect("callgrind counts");
    count.split_whitespace().next().and_then(|count| count.parse().ok()).expect("a number")
}

/// Instructions that a command takes for each line of `program.nc`.
fn of_a_line(scratch: &Scratch, arguments: &[&str]) -> u64 {
    let [short, long] = LINES.map(|lines| {
        scratch.write("program.nc", program(lines));
        instructions(arguments)
    });
    (long - short) / (LINES[1] - LINES[0]) as u64
}

#[test]
fn a_line_takes_no_more_of_them_than_before() {
    if Command::new("valgrind").arg("--version").output().is_err() {
        skip_loudly("a_line_takes_no_more_of_them_than_before", "there is no valgrind (Debian's package)");
        return;
    }
    let scratch = Scratch::new("instructions");
    let checks = of_a_line(&scratch, &["check", &scratch.path("program.nc")]);
    let output = scratch.path("adapted.nc");
    let adapts = of_a_line(&scratch, &["adapt", &job(&scratch, "program.nc"), "-o", &output]);
    println!("instructions for a line: check {checks}, adapt {adapts}");
    assert!(checks <= CHECK_MAX && adapts <= ADAPT_MAX, "check {checks}, adapt {adapts}");
}
