//! Output files in [memory](crate::files).

use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};

use crate::files;

/// File that appears under its name only when it is finished.
#[derive(Debug)]
pub struct PendingFile(PathBuf, Vec<u8>);

/// Rejects output files that are also input files, or that are the same file twice.
///
/// # Errors
/// Describes the first such output.
pub fn refuse_inputs(outputs: &[&Path], inputs: &[PathBuf]) -> std::result::Result<(), String> {
    for (index, output) in outputs.iter().enumerate() {
        if inputs.iter().any(|input| input == output) || outputs[..index].contains(output) {
            return Err(format!("{}: this is another file of the command; give another name", output.display()));
        }
    }
    Ok(())
}

/// Writes a file completely.
///
/// # Errors
/// None.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    files::write(path, bytes)
}

/// Writes a file, which must not exist yet.
///
/// # Errors
/// The file exists ([`ErrorKind::AlreadyExists`]).
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<()> {
    if files::is_file(path).is_ok() {
        return Err(ErrorKind::AlreadyExists.into());
    }
    files::write(path, bytes)
}

/// Files that grow while a command runs are those of lines and machines, which a page does not have.
///
/// # Errors
/// Always.
pub fn create(_: &Path) -> Result<std::fs::File> {
    Err(ErrorKind::Unsupported.into())
}

/// Whether the path leads to a file.
pub fn is_plain_file(path: &Path) -> bool {
    files::is_file(path).is_ok()
}

/// The error as it is.
pub fn explained(error: Error, _: &Path) -> Error {
    error
}

impl PendingFile {
    /// Empty file for this path.
    ///
    /// # Errors
    /// None.
    pub fn begin(path: &Path) -> Result<Self> {
        Ok(PendingFile(path.to_owned(), Vec::new()))
    }

    /// Gives the finished file its name.
    ///
    /// # Errors
    /// None.
    pub fn finish(self) -> Result<()> {
        files::write(self.0, self.1)
    }
}

impl Write for PendingFile {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.1.write(bytes)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}
