//! All writes to stdout and stderr. A message that cannot be written never ends the program.

use std::fmt::Arguments;
use std::io::{Write, stderr, stdout};
use std::sync::atomic::{AtomicBool, Ordering};

/// Lines on stderr are left out.
static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Prints a line on stdout.
///
/// # Errors
/// The reader of stdout is gone, or the disk is full.
pub fn print(line: Arguments<'_>) -> std::io::Result<()> {
    let mut stdout = stdout().lock();
    writeln!(stdout, "{line}")?;
    stdout.flush()
}

/// Prints a line on stderr; errors of stderr are ignored, because nothing is left to report them to.
pub fn note(line: Arguments<'_>) {
    if !IS_QUIET.load(Ordering::Relaxed) {
        let _lost = writeln!(stderr().lock(), "{line}");
    }
}

/// Runs a part of a command without its lines on stderr, because another part has printed the same lines.
pub fn without_notes<T>(part: impl FnOnce() -> T) -> T {
    IS_QUIET.store(true, Ordering::Relaxed);
    let result = part();
    IS_QUIET.store(false, Ordering::Relaxed);
    result
}
