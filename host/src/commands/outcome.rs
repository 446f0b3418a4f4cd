//! How a command ends: the exit code, and one sentence where it failed.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

use arcfeed_shared::cut;
use arcfeed_shared::segment::Path as Way;

use crate::dnc::outbox::LineError;
use crate::file_error::FileError;
use crate::job::JobFile;
use crate::port::PortError;
use crate::program::{Program, Severity};

/// Why a command failed.
#[derive(Debug)]
pub enum Failure {
    /// The program or the job is at fault: exit code 1.
    Input(String),
    /// Options that make no sense here: exit code 2.
    Usage(String),
    /// The line or the machine is: exit code 3.
    Machine(String),
    /// A person must decide first: exit code 4.
    Undecided(String),
    /// The operator stopped it: exit code 130, as for any program ended by Ctrl-C.
    Stopped(String),
}

impl Failure {
    /// Says it on stderr.
    pub fn report(self) -> ExitCode {
        let (message, code) = match self {
            Failure::Input(message) => (message, 1),
            Failure::Usage(message) => (message, 2),
            Failure::Machine(message) => (message, 3),
            Failure::Undecided(message) => (message, 4),
            Failure::Stopped(message) => (message, 130),
        };
        eprintln!("{message}");
        ExitCode::from(code)
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Failure::Input(format!("{error}"))
    }
}

impl From<LineError> for Failure {
    fn from(error: LineError) -> Self {
        Failure::Machine(format!("{error}"))
    }
}

impl From<PortError> for Failure {
    fn from(error: PortError) -> Self {
        Failure::Machine(format!("{error}"))
    }
}

/// Prints a line on stdout; where nobody reads it any more (`| head`), the command ends quietly, with the exit code of a
/// program ended by SIGPIPE.
pub fn say(line: std::fmt::Arguments<'_>) {
    if writeln!(std::io::stdout(), "{line}").is_err() {
        std::process::exit(141);
    }
}

/// A file could not be read or written.
pub fn file_failure(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Input(format!("{}: {error}", path.display()))
}

/// Writes a file so that either all of it is there or nothing has changed.
///
/// # Errors
/// It cannot be written.
pub fn write_whole(path: &Path, text: &[u8]) -> Result<(), Failure> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    let write = || -> std::io::Result<()> {
        let mut file = std::fs::File::create(&part)?;
        file.write_all(text)?;
        file.sync_all()?;
        std::fs::rename(&part, path)
    };
    write().map_err(|error| file_failure(path, &error))
}

/// A job and its program, both without errors; the engagement map that the job may name is not asked for.
///
/// # Errors
/// Every error of the program, one a line.
pub fn load_unmapped(job: &Path) -> Result<(JobFile, Program), Failure> {
    let file = JobFile::load(job)?;
    let bytes = std::fs::read(&file.program).map_err(|error| file_failure(&file.program, &error))?;
    let program = Program::parse_with(&file.program, &bytes, file.nc, file.tables);
    if let Some(refusal) = macro_refusal(&program) {
        return Err(Failure::Input(refusal));
    }
    let mut errors: Vec<String> = program
        .diagnostics
        .iter()
        .filter(|diagnostic| diagnostic.severity == Severity::Error)
        .map(|diagnostic| format!("{}:{diagnostic}", program.path.display()))
        .collect();
    errors.extend(spindle_contradictions(&file, &program));
    if errors.is_empty() { Ok((file, program)) } else { Err(Failure::Input(errors.join("\n"))) }
}

/// An F written into a macro's body or a subprogram would be that of every call, so such programs keep their feeds.
fn macro_refusal(program: &Program) -> Option<String> {
    let line = program.macro_line?;
    let found = program.lines.get(line - 1).map(|line| line.text.escape_ascii().to_string()).unwrap_or_default();
    let path = program.path.display();
    Some(format!(
        "{path}:{line}:1: error: macro statements and calls cannot be adapted: a feed written into a body would serve every \
         call; write the program out without them (found `{found}`)"
    ))
}

/// The chip is as thick as feed over speed: where a law governs a move at another spindle speed than the job says, it
/// would be adapted wrongly. Each such S word is told once; other tools have their own.
pub fn spindle_contradictions(file: &JobFile, program: &Program) -> Vec<String> {
    let wanted = f64::from(file.job.spindle.0);
    let (mut in_force, mut told) = (None, Vec::new());
    for (index, line) in program.lines.iter().enumerate() {
        let Some(meaning) = &line.meaning else { continue };
        let given = meaning.step.spindle.filter(|(speed, _)| *speed != 0);
        in_force = given.map(|(speed, column)| (index + 1, speed, column)).or(in_force);
        let is_governed = meaning.step.is_plain()
            && line.segment().is_some_and(|segment| {
                segment.path != Way::Rapid && cut::find(&file.job.rules, &segment, &file.job.tool).is_some()
            });
        if let Some((_, speed, _)) = in_force
            && is_governed
            && speed as f64 != wanted
        {
            told.extend(in_force.take());
        }
    }
    let path = program.path.display();
    let say = |(line, speed, column): (usize, i64, u16)| {
        format!("{path}:{line}:{column}: error: S{speed} contradicts [spindle] rev_per_min = {wanted} of the job")
    };
    told.into_iter().map(say).collect()
}

/// The flag that Ctrl-C (or a request to terminate) raises: one for the process, whoever asks.
pub fn on_interrupt() -> &'static AtomicBool {
    static RAISED: AtomicBool = AtomicBool::new(false);
    static WATCH: Once = Once::new();
    // Fails where somebody else has set a handler, as nobody does.
    WATCH.call_once(|| drop(ctrlc::set_handler(|| RAISED.store(true, Ordering::Relaxed))));
    &RAISED
}
