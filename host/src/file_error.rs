//! What is wrong with job and part files.

use std::path::PathBuf;

/// What is wrong with a file that a person wrote: `file:line:column: what and what to do`.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It says something that makes no sense.
    #[error("{path}:{line}:{column}: {message}")]
    Content {
        /// Which.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// Column, counted from 1.
        column: usize,
        /// What was found and what to do.
        message: String,
    },
}
