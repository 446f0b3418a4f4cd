//! Outcome of a command: the exit code, and one sentence if it failed.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use arcfeed_model::job::{Job, LawKind};
use arcfeed_nc::machining::ToolInSpindle;
use serde::Serialize;
use serde_json::Value;

use crate::adapt::rewrite::may_leak;
use crate::adapt::unused_rules::{RuleUse, unused_rules};
use crate::console::{self, note, print};
use crate::dnc::outbox::LineError;
use crate::file_error::FileError;
use crate::job::JobFile;
use crate::output;
use crate::plural::counted;
use crate::port::PortError;
use crate::program::{Program, ProgramLine, RunBounds, Severity, Source, fitting_convention};

/// Most errors of a program in the list; the others are counted.
const ERRORS_MAX: usize = 1_000;

/// Reason why a command failed; the variant decides the process's exit code.
#[derive(Debug)]
pub enum Failure {
    /// The program or the job is at fault: exit code 1.
    Input(String),
    /// Options that make no sense here: exit code 2.
    Usage(String),
    /// The line or the machine is at fault: exit code 3.
    Machine(String),
    /// A person must decide first: exit code 4.
    Undecided(String),
    /// The operator stopped it: exit code 130, as for any program ended by Ctrl-C.
    Stopped(String),
    /// Stdout accepts nothing more: exit code 141, as for any program ended by SIGPIPE, if the reader is gone (`|
    /// head`); otherwise 1.
    Unprinted(std::io::Error),
}

impl Failure {
    /// Prints the message on stderr; returns the exit code.
    pub fn report(self) -> u8 {
        if matches!(&self, Failure::Unprinted(error) if error.kind() == ErrorKind::BrokenPipe) {
            return 141;
        }
        let (message, code) = self.into_message();
        note(format_args!("{message}"));
        code
    }

    /// Message and exit code.
    pub fn into_message(self) -> (String, u8) {
        match self {
            Failure::Unprinted(error) => (format!("stdout: {error}"), 1),
            Failure::Input(message) => (message, 1),
            Failure::Usage(message) => (message, 2),
            Failure::Machine(message) => (message, 3),
            Failure::Undecided(message) => (message, 4),
            Failure::Stopped(message) => (message, 130),
        }
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

/// Prints a line on stdout, for a command without other work: if stdout accepts nothing more, the command ends.
pub fn say(line: std::fmt::Arguments<'_>) {
    if let Err(error) = print(line) {
        std::process::exit(Failure::Unprinted(error).report().into());
    }
}

/// JSON text of an object. A negative zero is written as 0.
pub fn json_text(object: &impl Serialize) -> String {
    let mut value = serde_json::json!(object);
    clear_signs(&mut value);
    value.to_string()
}

fn clear_signs(value: &mut Value) {
    match value {
        Value::Number(number) if number.as_f64() == Some(0.0) && number.is_f64() => *value = Value::from(0.0),
        Value::Array(values) => values.iter_mut().for_each(clear_signs),
        Value::Object(fields) => fields.values_mut().for_each(clear_signs),
        _ => {}
    }
}

/// Failure to read or write a file.
pub fn file_failure(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Input(format!("{}: {error}", path.display()))
}

/// Writes a file completely, or leaves everything unchanged.
///
/// # Errors
/// It cannot be written, or the caller of the command has stopped it.
pub fn write_whole(path: &Path, text: &[u8]) -> Result<(), Failure> {
    if console::capture().is_some_and(|capture| capture.is_stopped()) {
        return Err(Failure::Stopped(format!("stopped by the caller: {} is not written", path.display())));
    }
    output::write_whole(path, text).map_err(|error| file_failure(path, &error))
}

/// Rejects output files that are the same file as an input, or as another output, also through links or a different path.
///
/// # Errors
/// Describes the first such output.
pub fn refuse_inputs(outputs: &[Option<&Path>], inputs: &[PathBuf]) -> Result<(), Failure> {
    let outputs: Vec<&Path> = outputs.iter().flatten().copied().collect();
    output::refuse_inputs(&outputs, inputs).map_err(Failure::Input)
}

/// Loads a job and its program, but not the engagement map that the job may name; fails if the program has errors.
///
/// # Errors
/// Every error of the program, one per line; a program too long to be kept as a whole.
pub fn load_unmapped(job: &Path) -> Result<(JobFile, Program), Failure> {
    let (file, source, _) = load_source(job)?;
    let program = source.whole().map_err(Failure::Input)?;
    Ok((file, program))
}

/// Loads a job and the text of its program; also says whether a feed set by a law could stay in force for a line that
/// needs another one.
///
/// # Errors
/// Every error of the program, one per line.
pub fn load_source(job: &Path) -> Result<(JobFile, Source, bool), Failure> {
    read_source(job, JobFile::load(job)?)
}

/// Reads the text of the program of a job that has been read from the file `job`; the result is that of
/// [`load_source`].
///
/// # Errors
/// See [`load_source`].
pub fn read_source(job: &Path, mut file: JobFile) -> Result<(JobFile, Source, bool), Failure> {
    let names_it = |words: String| match crate::files::is_file(&file.program) {
        Ok(true) => words,
        _ => {
            format!("{words}; {} names it as its program: keep both in one folder, or correct `program`", job.display())
        }
    };
    let source = Source::read(&file.program, file.nc, file.tables).map_err(names_it).map_err(Failure::Input)?;
    let source = expanded(source, &file)?;
    let (mut errors, mut more) = (Vec::new(), 0);
    let (mut used, mut leaks) = (RuleUse::new(&file.job, source.places.clone()), false);
    let each_line = |line: &ProgramLine| {
        used.add(line, &file, tool_at(line, &file.job));
        leaks |= may_leak(line);
    };
    let summary = source.survey(false, each_line, |diagnostic, _| match diagnostic.severity {
        Severity::Error if errors.len() < ERRORS_MAX => {
            errors.push(format!("{}:{}", source.path.display(), source.in_file(diagnostic)));
        }
        Severity::Error => more += 1,
        Severity::Warning => {}
    });
    let advice = if errors.is_empty() { None } else { fitting_convention(&source) };
    errors.extend((more > 0).then(|| format!("{}: and {} more", source.path.display(), counted(more, "error"))));
    errors.extend(advice);
    let tools: Vec<_> = summary.tools.iter().map(|(number, line)| (*number, source.line_in_file(*line))).collect();
    errors.extend(name_tool(&mut file.job, &source.path, &tools));
    if !errors.is_empty() {
        return Err(Failure::Input(errors.join("\n")));
    }
    warn_of_rules(job, &file, Some((&source.path, &used)));
    Ok((file, source, leaks))
}

/// Warns on stderr of cut rules of a job that can never apply; `program` is the path and the use of the rules by the program's moves, if
/// known.
pub fn warn_of_rules(job: &Path, file: &JobFile, program: Option<(&Path, &RuleUse)>) {
    unused_rules(job, file, program).iter().for_each(|warning| note(format_args!("{warning}")));
}

/// Gives a job's tool without a number the number of the only tool that its program loads; if it loads several, a
/// person must decide. `loaded` are their numbers, each with its first line.
pub fn name_tool(job: &mut Job, path: &Path, loaded: &[(i64, usize)]) -> Option<String> {
    if !is_unnamed(job) {
        return None;
    }
    if let [_, (second, line), ..] = loaded {
        let named: Vec<String> = loaded.iter().map(|(number, _)| format!("T{number}")).collect();
        return Some(format!(
            "{}:{line}:1: error: the program loads {}, and the job does not say which of them is its own: add `number = {second}` \
             or another to [tool], or give each of them as a [[tool]] (found T{second})",
            path.display(),
            named.join(", ")
        ));
    }
    job.tools.first_mut().number = loaded.first().map(|(number, _)| *number);
    None
}

/// Index, among the job's tools, of the tool that is in the spindle at this line of the program, before [`name_tool`] has been called for
/// the job.
pub fn tool_at(line: &ProgramLine, job: &Job) -> Option<usize> {
    // The only tool that the program loads will be the one without a number.
    let is_named_so = is_unnamed(job) && matches!(line.machining.tool, ToolInSpindle::Number(1..));
    if is_named_so { Some(0) } else { job.tool_in(line.machining.tool) }
}

/// The job leaves the number of its tool to the program.
fn is_unnamed(job: &Job) -> bool {
    let own = job.tools.first();
    own.number.is_none() && own.law != LawKind::Programmed
}

/// The blocks of a job's program as executed: a feed belongs to a block each time it is executed.
fn expanded(source: Source, file: &JobFile) -> Result<Source, Failure> {
    source.expanded(file.library.as_deref(), RunBounds::default()).map_err(|found| {
        let path = file.program.display();
        let lines: Vec<String> = found.iter().map(|found| format!("{path}:{found}")).collect();
        Failure::Input(lines.join("\n"))
    })
}

/// Flag that is set when this process gets Ctrl-C or a request to terminate; in a page nothing sets it. The first call installs the
/// handler. If arcfeed runs as a function, signals are left to the caller's process: nothing sets the flag then.
pub fn on_interrupt() -> &'static AtomicBool {
    static RAISED: AtomicBool = AtomicBool::new(false);
    #[cfg(not(target_family = "wasm"))]
    if console::capture().is_none() {
        static WATCH: std::sync::Once = std::sync::Once::new();
        // Fails only if another handler is set, which never happens here.
        WATCH.call_once(|| drop(ctrlc::set_handler(|| RAISED.store(true, std::sync::atomic::Ordering::Relaxed))));
    }
    &RAISED
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_zero_is_written_as_zero() {
        let written = json_text(&serde_json::json!({ "a": [-0.0, 0.0, -1.5], "b": { "c": -0.0 }, "d": 0 }));
        assert_eq!(written, r#"{"a":[0.0,0.0,-1.5],"b":{"c":0.0},"d":0}"#);
    }
}
