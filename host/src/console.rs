//! All writes to stdout and stderr. A message that cannot be written never ends the program.

use std::fmt::Arguments;
use std::io::{Write, stderr, stdout};

/// Prints a line on stdout.
///
/// # Errors
/// The reader of stdout is gone, or the disk is full.
pub fn print(line: Arguments<'_>) -> std::io::Result<()> {
    let mut stdout = stdout().lock();
    writeln!(stdout, "{line}")?;
    stdout.flush()
}

/// Prints a line on stderr. An error is ignored: there is no place left to report it.
pub fn note(line: Arguments<'_>) {
    let _lost = writeln!(stderr().lock(), "{line}");
}
