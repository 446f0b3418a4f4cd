//! Commands of the page as functions, where arcfeed runs inside it. The page stops one by ending the worker that runs it.

use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::sync::Arc;

use super::super::call::call;
use super::CommandOutput;
use crate::console::{Capture, captured};

/// Runs one command at a time in the folder in which relative paths begin.
pub struct Runner;

impl Runner {
    /// Runner; the folder is [`HOME`](crate::files::HOME).
    pub fn new(_: &Path) -> Self {
        Runner
    }

    /// Runs arcfeed to its end; returns its output.
    ///
    /// # Errors
    /// None.
    pub fn run(&self, arguments: &[String]) -> io::Result<CommandOutput> {
        let capture = Arc::new(Capture::default());
        let result = captured(Some(Arc::clone(&capture)), || call(arguments.iter().map(OsString::from)));
        let mut lines = capture.take_notes();
        lines.extend(result.err().map(|failure| failure.into_message().0));
        let messages = lines.into_iter().map(|line| line + "\n").collect();
        Ok(CommandOutput { messages, printed: capture.take_printed() })
    }

    /// Does nothing: no request reaches a worker that is busy.
    pub fn stop(&self) {}

    /// Does nothing, as [`Runner::stop`].
    pub fn close(&self) {}
}
