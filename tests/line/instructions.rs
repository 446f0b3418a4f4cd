//! Processor time that `check`, `adapt` and `simulate` need for a line, as instructions that callgrind counts: the same on every computer, busy or not.
#![cfg(target_os = "linux")]

use arcfeed_tests::valgrind::{instructions, valgrind_or_skip};
use arcfeed_tests::{Scratch, arcfeed};

use crate::program_memory::{job, program};
use crate::report_page::scale::{JOB as ROWS_JOB, rows};

/// Lines of the shorter and of the longer program: the difference is that of the lines alone.
const LINES: [usize; 2] = [500, 1_500];
/// Lines of the two programs that are simulated: fewer, because each takes longer.
const SIMULATED_LINES: [usize; 2] = [200, 600];

/// Most instructions for a line in the tests' profile, a fifth more than they take. The shipped program needs a fourth to a sixth (docs/build.md).
const CHECK_MAX: u64 = 14_500;
const ADAPT_MAX: u64 = 155_000;
/// Most for a short line in `simulate`, a tenth more than it takes: without a report no path is recorded.
const SIMULATE_MAX: u64 = 252_000;

/// Instructions that a command takes for each line of `program.nc`, from programs of two lengths.
fn of_a_line(scratch: &Scratch, (program, lines): (fn(usize) -> String, [usize; 2]), arguments: &[&str]) -> u64 {
    let [short, long] = lines.map(|lines| {
        scratch.write("program.nc", program(lines));
        instructions(arcfeed(), arguments)
    });
    (long - short) / (lines[1] - lines[0]) as u64
}

#[test]
fn a_line_takes_no_more_of_them_than_before() {
    if valgrind_or_skip("a_line_takes_no_more_of_them_than_before").is_none() {
        return;
    }
    let scratch = Scratch::new("instructions");
    let checks = of_a_line(&scratch, (program, LINES), &["check", &scratch.path("program.nc")]);
    let output = scratch.path("adapted.nc");
    let job = job(&scratch, "program.nc");
    let adapts = of_a_line(&scratch, (program, LINES), &["adapt", &job, "-o", &output]);
    let job_of_rows = scratch.write("rows.toml", format!("program = \"program.nc\"\n{ROWS_JOB}"));
    let simulates = of_a_line(&scratch, (rows, SIMULATED_LINES), &["simulate", &job_of_rows, "--json"]);
    let found = format!("instructions for a line: check {checks}, adapt {adapts}, simulate {simulates}");
    println!("{found}");
    assert!(checks <= CHECK_MAX && adapts <= ADAPT_MAX && simulates <= SIMULATE_MAX, "{found}");
}
