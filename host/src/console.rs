//! All writes to stdout and stderr. A message that cannot be written never ends the program.

use std::cell::RefCell;
use std::fmt::Arguments;
use std::io::{Write, stderr, stdout};
use std::sync::atomic::{AtomicBool, Ordering};

/// Lines on stderr are left out.
static IS_QUIET: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// Lines of this thread on stdout and stderr while they are captured.
    static CAPTURED: RefCell<Option<[String; 2]>> = const { RefCell::new(None) };
}

/// Does a part of a command on this thread, and returns its lines on stdout and on stderr in place of printing them.
pub fn captured<T>(part: impl FnOnce() -> T) -> (T, [String; 2]) {
    CAPTURED.set(Some(Default::default()));
    let result = part();
    (result, CAPTURED.take().unwrap_or_default())
}

/// Whether the lines of this thread are captured: then there is no progress to show.
pub fn is_captured() -> bool {
    CAPTURED.with_borrow(Option::is_some)
}

/// Keeps a line if this thread's lines are captured.
fn capture(stream: usize, line: Arguments<'_>) -> bool {
    CAPTURED.with_borrow_mut(|captured| {
        let text = captured.as_mut().and_then(|streams| streams.get_mut(stream));
        text.map(|text| *text += &format!("{line}\n")).is_some()
    })
}

/// Prints a line on stdout.
///
/// # Errors
/// The reader of stdout is gone, or the disk is full.
pub fn print(line: Arguments<'_>) -> std::io::Result<()> {
    if capture(0, line) {
        return Ok(());
    }
    let mut stdout = stdout().lock();
    writeln!(stdout, "{line}")?;
    stdout.flush()
}

/// Prints a line on stderr; errors of stderr are ignored, because nothing is left to report them to.
pub fn note(line: Arguments<'_>) {
    if !capture(1, line) && !IS_QUIET.load(Ordering::Relaxed) {
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
