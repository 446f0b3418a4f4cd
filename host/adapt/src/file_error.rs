//! Faults in job and part files.

use std::path::PathBuf;

use crate::key_values::KeyValue;

/// Fault in a file that a person wrote: `file:line:column: fault and remedy`.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// The content makes no sense.
    #[error("{path}:{line}:{column}: {message}")]
    Content {
        /// Path of the file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// Column, counted from 1.
        column: usize,
        /// Fault and remedy.
        message: String,
    },
    /// The content makes no sense, and the file has no lines.
    #[error("{path}: {message}")]
    Whole {
        /// Path of the file.
        path: PathBuf,
        /// Fault and remedy.
        message: String,
    },
}

impl FileError {
    /// The error of a file that was read with values in place of its own.
    #[must_use]
    pub fn with_values(mut self, values: &[KeyValue]) -> Self {
        if let FileError::Content { message, .. } | FileError::Whole { message, .. } = &mut self {
            let values: Vec<String> = values.iter().map(KeyValue::to_string).collect();
            *message = format!("{message} (with --set {})", values.join(" --set "));
        }
        self
    }
}
