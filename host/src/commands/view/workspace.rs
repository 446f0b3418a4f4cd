//! Temporary folder of the page: the program, its job, and what arcfeed makes of them.
//!
//! A browser gets the words that a terminal gets, because a runner runs the same commands.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::Serialize;
use serde_json::Value;

use super::super::outcome::{Failure, file_failure};
use super::input::{FormProblem, FormValues, OpenQuestion, foreign_file, is_no_program, open_questions, plain_name};
use super::{CommandOutput, Runner};
use crate::files;

/// Folder and state of the page, shared by all browsers that show it.
pub struct Workspace {
    folder: PathBuf,
    files: Mutex<Files>,
    /// A command of a browser is under way.
    is_taken: AtomicBool,
    runner: Runner,
}

/// Program and job.
#[derive(Clone, Debug, Default)]
struct Files {
    program: Option<PathBuf>,
    job: Option<PathBuf>,
    /// The job is a file of the command line, which the page does not change.
    is_fixed: bool,
    messages: String,
    /// JSON of `arcfeed init` for the program (docs/json.md).
    found: Option<Value>,
    problems: Vec<FormProblem>,
}

/// State that the page shows.
#[derive(Debug, Serialize)]
pub struct PageState {
    program: Option<String>,
    /// Text of the job.
    job: Option<String>,
    is_fixed: bool,
    questions: Vec<OpenQuestion>,
    /// Messages of the last command.
    messages: String,
    has_report: bool,
    found: Option<Value>,
    /// Values of the form that cannot be used, in place of a new job.
    problems: Vec<FormProblem>,
}

/// File that a browser may fetch.
#[derive(Clone, Copy, Debug)]
pub enum PageFile {
    /// Page with the run before and after.
    Report,
    /// Adapted program.
    Adapted,
    /// Job file.
    Job,
}

impl Workspace {
    /// Workspace in a folder, by its absolute path.
    ///
    /// # Errors
    /// Folders cannot be made in it.
    pub fn new(folder: &Path) -> io::Result<Self> {
        for part in ["in", "out"] {
            files::clear_folder(&folder.join(part))?;
        }
        let runner = Runner::new(folder);
        Ok(Workspace { folder: folder.to_owned(), files: Mutex::default(), is_taken: AtomicBool::new(false), runner })
    }

    /// Loads a job or a program given on the command line.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn open(&self, path: &Path) -> Result<(), Failure> {
        if path.extension().is_some_and(|extension| extension == "toml") {
            let absolute = files::canonicalize(path).map_err(|error| file_failure(path, &error))?;
            *self.files() = Files { job: Some(absolute), is_fixed: true, ..Files::default() };
            self.adapt();
            return Ok(());
        }
        let bytes = files::read(path).map_err(|error| file_failure(path, &error))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.take(&name, &bytes).map_err(|error| file_failure(path, &error))
    }

    /// Stores a dropped program in place of the one before, and proposes a job for it.
    ///
    /// # Errors
    /// The disk is full.
    pub fn take(&self, name: &str, program: &[u8]) -> io::Result<()> {
        for part in ["in", "out"] {
            files::clear_folder(&self.folder.join(part))?;
        }
        let path = self.folder.join("in").join(plain_name(name));
        files::write(&path, program)?;
        *self.files() = Files { job: Some(path.with_extension("toml")), program: Some(path), ..Files::default() };
        let found = self.propose(&FormValues::default());
        if let Some(words) = is_no_program(program, found.as_ref()) {
            let messages = format!("{}: {words}: choose another file", plain_name(name));
            *self.files() = Files { messages, ..Files::default() };
            return Ok(());
        }
        self.files().found = found;
        Ok(())
    }

    /// Proposes a job by `arcfeed init` with these values, unless one of them cannot be used; returns what it has found.
    pub fn propose(&self, values: &FormValues) -> Option<Value> {
        let Files { program: Some(program), job: Some(job), .. } = self.files().clone() else { return None };
        let problems = values.problems();
        let is_refused = !problems.is_empty();
        self.files().problems = problems;
        if is_refused {
            return None;
        }
        let mut arguments: Vec<String> = ["init", "--json", "--force", "--output"].map(String::from).into();
        arguments.extend([name(&job), name(&program)]);
        arguments.extend(values.options());
        self.clear_output();
        serde_json::from_str(&self.command(&arguments)).ok()
    }

    /// Adapts and simulates with this text as the job.
    ///
    /// # Errors
    /// The text cannot be written.
    pub fn adapt_with(&self, text: &str) -> io::Result<()> {
        self.files().problems.clear();
        let files = self.files().clone();
        if let Some(job) = files.job.filter(|_| !files.is_fixed) {
            if let Some(path) = foreign_file(text, &self.folder.join("in")) {
                let message =
                    format!("`{path}` is a file outside of this page: run the job with `arcfeed view JOB.toml`");
                self.files().messages = message;
                self.clear_output();
                return Ok(());
            }
            files::write(job, text)?;
        }
        self.adapt();
        Ok(())
    }

    /// Adapts and simulates the job.
    fn adapt(&self) {
        let Some(job) = self.files().job.clone() else { return };
        self.clear_output();
        let [report, adapted] = [PageFile::Report, PageFile::Adapted].map(|output| self.path(output));
        let text = |path: PathBuf| path.to_string_lossy().into_owned();
        let is_fixed = self.files().is_fixed;
        let job = if is_fixed { text(job) } else { name(&job) };
        self.command(&["adapt".into(), job, "--output".into(), text(adapted), "--report".into(), text(report)]);
    }

    /// Runs arcfeed in the folder of the program; its messages are kept, its text for stdout is returned.
    fn command(&self, arguments: &[String]) -> String {
        let output = self.runner.run(arguments);
        let failed =
            |error| CommandOutput { messages: format!("arcfeed does not start: {error}"), printed: String::new() };
        let CommandOutput { messages, printed } = output.unwrap_or_else(failed);
        self.files().messages = messages;
        printed
    }

    /// Reserves the workspace for a command; `false` if a command of another browser is using it.
    pub fn begin(&self) -> bool {
        !self.is_taken.swap(true, Ordering::Acquire)
    }

    /// Ends the reservation.
    pub fn end(&self) {
        self.is_taken.store(false, Ordering::Release);
    }

    /// Stops the running command.
    pub fn stop(&self) {
        self.runner.stop();
    }

    /// Stops the running command for good: no other can start.
    pub fn close(&self) {
        self.runner.close();
    }

    /// State that the page shows.
    pub fn state(&self) -> PageState {
        let files = self.files().clone();
        let job = files.job.as_ref().and_then(|path| files::read_to_string(path).ok());
        let questions = job.as_deref().map(open_questions).unwrap_or_default();
        PageState {
            program: files.program.or_else(|| files.job.clone()).map(|path| name(&path)),
            job,
            is_fixed: files.is_fixed,
            questions,
            messages: files.messages,
            found: files.found,
            problems: files.problems,
            has_report: files::is_file(&self.path(PageFile::Report)).is_ok_and(|is_file| is_file),
        }
    }

    /// Content of a file, and its name for a download.
    ///
    /// # Errors
    /// The file has not been made yet.
    pub fn read(&self, output: PageFile) -> io::Result<(Vec<u8>, String)> {
        let now = self.files().clone();
        let stem = now.job.as_ref().and_then(|job| job.file_stem()).unwrap_or_default().to_string_lossy().into_owned();
        let stem = plain_name(&stem);
        let extension = now.program.as_ref().and_then(|program| program.extension()).unwrap_or("nc".as_ref());
        match output {
            PageFile::Report => Ok((files::read(self.path(output))?, format!("{stem}.html"))),
            PageFile::Adapted => {
                Ok((files::read(self.path(output))?, format!("{stem}-adapted.{}", extension.to_string_lossy())))
            }
            PageFile::Job => Ok((files::read(now.job.unwrap_or_default())?, format!("{stem}.toml"))),
        }
    }

    fn path(&self, output: PageFile) -> PathBuf {
        let name = match output {
            PageFile::Report => "report.html",
            PageFile::Adapted => "adapted.nc",
            PageFile::Job => "job.toml",
        };
        self.folder.join("out").join(name)
    }

    /// An old result does not stay beside a new job.
    fn clear_output(&self) {
        for output in [PageFile::Report, PageFile::Adapted] {
            let _was_not_there = files::remove_file(self.path(output));
        }
    }

    fn files(&self) -> MutexGuard<'_, Files> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Last part of a path, as text.
fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
