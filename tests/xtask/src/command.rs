//! Running other programs in the workspace, and what to say when one fails.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use wait4::Wait4;

/// A command that takes less is not worth a line.
const WORTH_A_LINE: Duration = Duration::from_secs(10);
/// Words of a command that a line shows: a part of the tests is hundreds of names.
const SHOWN_MAX: usize = 14;

/// A step that failed.
#[derive(Debug)]
pub struct Failure {
    /// Cause and remedy.
    pub what: String,
    /// The exit code to leave with.
    pub code: u8,
}

impl Failure {
    /// A failure found by xtask itself.
    pub fn new(what: impl Into<String>) -> Self {
        Failure { what: what.into(), code: 1 }
    }
}

/// Says which step begins.
pub fn announce(step: &str) {
    println!("xtask: {step}");
}

/// The cargo that runs xtask, in the workspace's root.
pub fn cargo(arguments: &[&str]) -> Command {
    program(env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo")), arguments)
}

/// A program in the workspace's root, where the toolchain is pinned.
pub fn program(name: impl Into<OsString>, arguments: &[&str]) -> Command {
    let mut command = Command::new(name.into());
    command.args(arguments).current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).stdin(Stdio::null());
    command
}

/// Runs to the end.
///
/// # Errors
/// Not started, or another exit code than 0, which is passed on.
pub fn run(command: &mut Command) -> Result<(), Failure> {
    let (status, cost) = run_timed(command)?;
    announce_cost(cost);
    if status.success() { Ok(()) } else { Err(failed(command, status.code())) }
}

/// Runs to the end; returns the line about its cost too, if it is worth one: time by the clock, and processor time of the command and
/// of what it started.
///
/// # Errors
/// Not started.
pub fn run_timed(command: &mut Command) -> Result<(ExitStatus, Option<String>), Failure> {
    let began = Instant::now();
    let used = command.spawn().and_then(|mut child| child.wait4()).map_err(|error| not_started(command, &error))?;
    let [clock, processor] = [began.elapsed(), used.rusage.utime + used.rusage.stime];
    let line = (clock.max(processor) >= WORTH_A_LINE).then(|| {
        let [clock, processor] = [clock, processor].map(|time| time.as_secs());
        format!("{clock} s by the clock, {processor} s of processor time: {}", shown(command))
    });
    Ok((used.status, line))
}

/// Says what a command cost.
pub fn announce_cost(cost: Option<String>) {
    if let Some(cost) = cost {
        announce(&cost);
    }
}

/// Runs to the end and answers what it printed; what a failed command printed goes to stdout.
///
/// # Errors
/// As [`run`].
pub fn output(command: &mut Command) -> Result<String, Failure> {
    let output = command.stderr(Stdio::inherit()).output().map_err(|error| not_started(command, &error))?;
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        Ok(printed)
    } else {
        print!("{printed}");
        Err(failed(command, output.status.code()))
    }
}

/// The failure of a program that ended with `code`, or by a signal.
pub fn failed(command: &Command, code: Option<i32>) -> Failure {
    let code = code.and_then(|code| u8::try_from(code).ok()).unwrap_or(1);
    Failure { what: format!("exit code {code} of {}", shown(command)), code }
}

/// The failure of a program that is not there.
pub fn not_started(command: &Command, error: &std::io::Error) -> Failure {
    Failure::new(format!("cannot start {}: {error}", shown(command)))
}

/// The build directory, whatever it is called: cargo puts xtask two levels below it.
///
/// # Errors
/// The operating system does not know where xtask is.
pub fn build_dir() -> Result<PathBuf, Failure> {
    let executable = env::current_exe().map_err(|error| Failure::new(format!("where is xtask? {error}")))?;
    executable
        .ancestors()
        .nth(2)
        .map(PathBuf::from)
        .ok_or_else(|| Failure::new(format!("{} is not in a build directory", executable.display())))
}

/// A command as one would type it: without the path to the program.
fn shown(command: &Command) -> String {
    let name = Path::new(command.get_program()).file_stem().unwrap_or(command.get_program());
    let words: Vec<_> = std::iter::once(name).chain(command.get_args()).map(|word| word.to_string_lossy()).collect();
    match words.split_at_checked(SHOWN_MAX) {
        Some((first, rest)) if !rest.is_empty() => format!("{} and {} words more", first.join(" "), rest.len()),
        _ => words.join(" "),
    }
}
