//! Files on the disk.

use std::fs::{self, File};
use std::io::{Read, Result};
use std::path::Path;

pub use std::fs::{canonicalize, read, read_to_string, remove_file, write};

/// File to be read from its beginning, and its size, which a pipe reports as 0.
///
/// # Errors
/// It cannot be read.
pub fn open(path: &Path) -> Result<(impl Read + use<>, u64)> {
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    Ok((file, size))
}

/// Whether this is a file.
///
/// # Errors
/// Nothing is there, or it cannot be looked at.
pub fn is_file(path: &Path) -> Result<bool> {
    fs::metadata(path).map(|found| found.is_file())
}

/// Makes a folder empty, which need not be there yet.
///
/// # Errors
/// A file in it cannot be removed, or the folder cannot be made.
pub fn clear_folder(path: &Path) -> Result<()> {
    if path.is_dir() {
        fs::remove_dir_all(path)?;
    }
    fs::create_dir(path)
}
