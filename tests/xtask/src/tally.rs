//! The workspace's tests, with their results added up.
//!
//! Two runs go side by side, the longest begun first: where the tests of one wait for a line's time or an emulator, those of the other
//! compute. LinuxCNC, which hardly computes, runs beside them where the computer lets it come before all other programs, and alone
//! before them where not: its servo thread needs a core at each millisecond. What a run prints is shown when it ends.
//!
//! No test is skipped in silence: an ignored one fails the run. A test that lacks something outside the repository
//! appends one line to the file named by the variable `ARCFEED_SKIP_LOG` and passes; it is counted as skipped here, and
//! its line printed at the end.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, Write};
use std::num::NonZero;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::{Mutex, PoisonError};
use std::thread;

use crate::command::{Failure, announce, announce_cost, build_dir, cargo, failed, program, run, run_timed};
use crate::python::Checked;
use crate::selection::Selection;

/// Names the file to which a test appends a line for what it could not check.
const SKIP_LOG: &str = "ARCFEED_SKIP_LOG";
/// Test program that runs in real time.
const REAL_TIME: &str = "linuxcnc";
/// Runs side by side.
const SIDE_BY_SIDE: usize = 2;
/// Number of tests of a run in parallel: as many as there are cores, unless the variable is set.
const THREADS: &str = "RUST_TEST_THREADS";

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

    /// Adds the tests of the Python package.
    pub fn add_python(&mut self, checked: Checked) {
        match checked {
            Checked::Passed(tests) => self.passed += tests,
            // A test that skips itself counts as passed, and is taken off in the sum.
            Checked::Skipped(message) => {
                self.passed += 1;
                self.skipped.push(message);
            }
        }
    }

    /// Failures that cargo's exit code 0 does not show.
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

/// Builds the tests.
///
/// # Errors
/// Something does not compile.
pub fn build() -> Result<(), Failure> {
    announce("build of the tests");
    run(&mut cargo(&["test", "--workspace", "--tests", "--no-run", "--quiet"]))
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
    let threads = std::env::var(THREADS).unwrap_or_else(|_| cores.to_string());
    let (mut real_time, others): (Vec<_>, Vec<_>) =
        selection.runs()?.into_iter().partition(|arguments| arguments.iter().any(|argument| argument == REAL_TIME));
    let waiting = Mutex::new(others.into_iter());
    let (tally_of_all, results) = (Mutex::new(&mut *tally), Mutex::new(Vec::new()));
    let run_one = |arguments: Vec<String>| {
        let program = arguments.iter().take_while(|argument| *argument != "--").last();
        let printed = log.with_file_name(format!("xtask-{}.log", program.map_or("tests", String::as_str)));
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let mut tests = cargo(&arguments);
        let ended = run_into(tests.env(SKIP_LOG, &log).env(THREADS, &threads), &printed);
        let mut tally = tally_of_all.lock().unwrap_or_else(PoisonError::into_inner);
        let result = ended.and_then(|(status, cost)| {
            show(&printed, &mut tally)?;
            announce_cost(cost);
            if status.success() { Ok(()) } else { Err(failed(&tests, status.code())) }
        });
        results.lock().unwrap_or_else(PoisonError::into_inner).push(result);
    };
    if !has_priorities() {
        real_time.drain(..).for_each(run_one);
    }
    thread::scope(|scope| {
        scope.spawn(|| real_time.into_iter().for_each(run_one));
        for _ in 0..SIDE_BY_SIDE {
            scope.spawn(|| {
                while let Some(arguments) = next(&waiting) {
                    run_one(arguments);
                }
            });
        }
    });
    tally.skipped = read_log(&log)?;
    results.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().collect()
}

/// Whether programs that must keep pace with the clock can come before all others, as `tests/linuxcnc/machine.rs` starts them.
fn has_priorities() -> bool {
    program("chrt", &["--rr", "1", "true"]).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}

/// The next run in the queue.
fn next<T>(waiting: &Mutex<impl Iterator<Item = T>>) -> Option<T> {
    waiting.lock().unwrap_or_else(PoisonError::into_inner).next()
}

/// Runs to the end, with all that is printed in one file, which can be read meanwhile.
fn run_into(command: &mut Command, printed: &Path) -> Result<(ExitStatus, Option<String>), Failure> {
    let file = File::create(printed).and_then(|file| Ok((file.try_clone()?, file)));
    let (out, err) = file.map_err(|error| not_written(printed, &error))?;
    run_timed(command.stdout(out).stderr(err))
}

/// Shows what a run printed, and adds it up. Tests may print bytes that are no text.
fn show(printed: &Path, tally: &mut Tally) -> Result<(), Failure> {
    let bytes = fs::read(printed).map_err(|error| not_written(printed, &error))?;
    let shown = io::stdout().write_all(&bytes);
    shown.map_err(|error| Failure::new(format!("output of cargo test: {error}")))?;
    String::from_utf8_lossy(&bytes).lines().for_each(|line| tally.add(line));
    Ok(())
}

fn not_written(path: &Path, error: &io::Error) -> Failure {
    Failure::new(format!("{}: {error}", path.display()))
}

/// Starts the log empty: lines of an earlier run say nothing about this one.
fn write_log(log: &Path) -> Result<(), Failure> {
    fs::write(log, "").map_err(|error| not_written(log, &error))
}

fn read_log(log: &Path) -> Result<Vec<String>, Failure> {
    let text = fs::read(log).map_err(|error| not_written(log, &error))?;
    Ok(String::from_utf8_lossy(&text).lines().filter(|line| !line.trim().is_empty()).map(str::to_owned).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally_of(output: &str) -> Tally {
        let mut tally = Tally::default();
        output.lines().for_each(|line| tally.add(line));
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
