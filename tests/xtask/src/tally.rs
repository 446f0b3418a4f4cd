//! The workspace's tests, with their results added up.
//!
//! No test is skipped in silence: an ignored one fails the run. A test that lacks something outside the repository
//! appends one line to the file named by the variable `ARCFEED_SKIP_LOG` and passes; it is counted as skipped here, and
//! its line printed at the end.

use std::fmt;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::num::NonZero;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::command::{Failure, announce, build_dir, cargo, failed, not_started};
use crate::selection::Selection;

/// Names the file to which a test appends a line for what it could not check.
const SKIP_LOG: &str = "ARCFEED_SKIP_LOG";
/// How many tests of a program run side by side.
const THREADS: &str = "RUST_TEST_THREADS";
/// For each core, where nobody has said how many: half of the tests wait, for a line's time or an emulator.
const THREADS_PER_CORE: usize = 2;

/// Results over all test programs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    passed: u64,
    failed: u64,
    ignored: u64,
    /// One line for each test that passed without having had what it checks.
    pub skipped: Vec<String>,
}

impl Tally {
    /// Adds a line of cargo test's output, if it is a result.
    fn add(&mut self, line: &str) {
        let Some(counts) = line.trim().strip_prefix("test result: ") else { return };
        for count in counts.split(';') {
            let mut words = count.split_whitespace().rev();
            let (name, number) = (words.next(), words.next().and_then(|word| word.parse::<u64>().ok()));
            match (name, number) {
                (Some("passed"), Some(number)) => self.passed += number,
                (Some("failed"), Some(number)) => self.failed += number,
                (Some("ignored"), Some(number)) => self.ignored += number,
                _ => {}
            }
        }
    }

    /// What cargo's exit code 0 does not tell.
    fn complaint(&self) -> Option<String> {
        match self {
            Tally { failed: 1.., .. } => Some("cargo test reported a failure, but ended well".to_owned()),
            Tally { ignored: 1.., .. } => Some(format!("{} ignored: run it or remove it", self.ignored)),
            Tally { passed: 0, .. } => Some("cargo test reported no results".to_owned()),
            _ => None,
        }
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let skipped = self.skipped.len() as u64;
        let passed = self.passed.saturating_sub(skipped);
        write!(f, "tests: {passed} passed, {} failed, {} skipped", self.failed, self.ignored + skipped)
    }
}

/// Runs the tests selected, shows their output and adds it up.
pub fn test_workspace(selection: &Selection) -> (Tally, Result<(), Failure>) {
    announce("workspace tests");
    let mut tally = Tally::default();
    let result = run_tests(selection, &mut tally)
        .and_then(|()| tally.complaint().map_or(Ok(()), |what| Err(Failure::new(what))));
    (tally, result)
}

fn run_tests(selection: &Selection, tally: &mut Tally) -> Result<(), Failure> {
    let log = build_dir()?.join("xtask-skipped.log");
    write_log(&log)?;
    let cores = std::thread::available_parallelism().map_or(1, NonZero::get);
    let threads = std::env::var(THREADS).unwrap_or_else(|_| (THREADS_PER_CORE * cores).to_string());
    let mut results = Vec::new();
    for arguments in selection.runs()? {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let mut tests = cargo(&arguments);
        results.push(run_one(tests.env(SKIP_LOG, &log).env(THREADS, &threads).stdout(Stdio::piped()), tally));
    }
    tally.skipped = read_log(&log)?;
    results.into_iter().collect()
}

fn run_one(command: &mut Command, tally: &mut Tally) -> Result<(), Failure> {
    let mut child = command.spawn().map_err(|error| not_started(command, &error))?;
    if let Some(stdout) = child.stdout.take() {
        show(BufReader::new(stdout), &mut std::io::stdout(), tally)
            .map_err(|error| Failure::new(format!("output of cargo test: {error}")))?;
    }
    let status = child.wait().map_err(|error| Failure::new(format!("cargo test: {error}")))?;
    if status.success() { Ok(()) } else { Err(failed(command, status.code())) }
}

/// Passes lines on as they come, and adds them up. Tests may print bytes that are no text.
fn show(mut lines: impl BufRead, screen: &mut impl Write, tally: &mut Tally) -> std::io::Result<()> {
    let mut line = Vec::new();
    while lines.read_until(b'\n', &mut line)? > 0 {
        screen.write_all(&line)?;
        tally.add(&String::from_utf8_lossy(&line));
        line.clear();
    }
    Ok(())
}

/// Starts the log empty: lines of an earlier run say nothing about this one.
fn write_log(log: &Path) -> Result<(), Failure> {
    fs::write(log, "").map_err(|error| Failure::new(format!("{}: {error}", log.display())))
}

fn read_log(log: &Path) -> Result<Vec<String>, Failure> {
    let text = fs::read(log).map_err(|error| Failure::new(format!("{}: {error}", log.display())))?;
    Ok(String::from_utf8_lossy(&text).lines().filter(|line| !line.trim().is_empty()).map(str::to_owned).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally_of(output: &str) -> Tally {
        let mut tally = Tally::default();
        show(output.as_bytes(), &mut std::io::sink(), &mut tally).unwrap();
        tally
    }

    const TWO_PROGRAMS: &str = "\
running 9 tests
test result: ok. 9 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s
   Doc-tests arcfeed
test result: FAILED. 3 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out; finished in 12.40s
";

    #[test]
    fn results_of_all_programs_are_added_up() {
        let tally = tally_of(TWO_PROGRAMS);
        assert_eq!(tally.to_string(), "tests: 12 passed, 2 failed, 0 skipped");
    }

    #[test]
    fn an_ignored_test_is_a_complaint() {
        let tally = tally_of("test result: ok. 4 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out");
        assert_eq!(tally.to_string(), "tests: 4 passed, 0 failed, 1 skipped");
        assert!(tally.complaint().is_some());
    }

    #[test]
    fn a_test_that_skips_itself_has_not_passed() {
        let passed = "test result: ok. 4 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out";
        let tally = Tally { skipped: vec!["SKIPPED (loudly): no corpus".to_owned()], ..tally_of(passed) };
        assert_eq!(tally.to_string(), "tests: 3 passed, 0 failed, 1 skipped");
        assert_eq!(tally.complaint(), None);
    }

    #[test]
    fn no_results_at_all_are_a_complaint() {
        assert!(tally_of("error: could not compile\n").complaint().is_some());
    }
}
