//! Processor time that `check` and `adapt` need for a line, as instructions that callgrind counts: the same on every computer, busy or not.
#![cfg(target_os = "linux")]

use arcfeed_tests::valgrind::{instructions, valgrind_or_skip};
use arcfeed_tests::{Scratch, arcfeed};

use crate::program_memory::{job, program};

/// Lines of the shorter and of the longer program: the difference is that of the lines alone.
const LINES: [usize; 2] = [500, 1_500];

/// Most instructions for a line in the tests' profile, a fifth more than they take. The shipped program needs a fourth to a sixth (docs/build.md).
const CHECK_MAX: u64 = 14_500;
const ADAPT_MAX: u64 = 155_000;

/// Instructions that a command takes for each line of `program.nc`.
fn of_a_line(scratch: &Scratch, arguments: &[&str]) -> u64 {
    let [short, long] = LINES.map(|lines| {
        scratch.write("program.nc", program(lines));
        instructions(arcfeed(), arguments)
    });
    (long - short) / (LINES[1] - LINES[0]) as u64
}

#[test]
fn a_line_takes_no_more_of_them_than_before() {
    if valgrind_or_skip("a_line_takes_no_more_of_them_than_before").is_none() {
        return;
    }
    let scratch = Scratch::new("instructions");
    let checks = of_a_line(&scratch, &["check", &scratch.path("program.nc")]);
    let output = scratch.path("adapted.nc");
    let adapts = of_a_line(&scratch, &["adapt", &job(&scratch, "program.nc"), "-o", &output]);
    println!("instructions for a line: check {checks}, adapt {adapts}");
    assert!(checks <= CHECK_MAX && adapts <= ADAPT_MAX, "check {checks}, adapt {adapts}");
}
