//! The only door to stdout and stderr: a message that nobody can read any more never ends a program.

use std::fmt::Arguments;
use std::io::{Write, stderr, stdout};

/// Prints a line on stdout.
///
/// # Errors
/// Its reader is gone, or the disk behind it is full.
pub fn print(line: Arguments<'_>) -> std::io::Result<()> {
    let mut stdout = stdout().lock();
    writeln!(stdout, "{line}")?;
    stdout.flush()
}

/// Prints a line on stderr. It is lost where the reader is gone or the disk is full: there is no place left to say so.
pub fn note(line: Arguments<'_>) {
    let _lost = writeln!(stderr().lock(), "{line}");
}
