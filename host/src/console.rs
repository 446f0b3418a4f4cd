//! All writes to stdout and stderr. A message that cannot be written never ends the program.
//!
//! A caller that runs a command as a function passes a [`Capture`], which receives the lines in place of both streams, and
//! through which the caller follows the command and stops it. It belongs to the thread that runs the command.

use std::cell::RefCell;
use std::fmt::{Arguments, Write as _};
use std::io::{Write, stderr, stdout};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Lines on stderr are left out.
static IS_QUIET: AtomicBool = AtomicBool::new(false);

thread_local! {
    static CAPTURE: RefCell<Option<Arc<Capture>>> = const { RefCell::new(None) };
}

/// Output of a command that runs as a function, and its control from another thread.
#[derive(Debug, Default)]
pub struct Capture {
    printed: Mutex<String>,
    notes: Mutex<Vec<String>>,
    progress: Mutex<Progress>,
    is_stopped: AtomicBool,
}

/// Progress of a simulated run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Blocks executed.
    pub blocks: usize,
    /// Machine time, s.
    pub time_s: f64,
}

impl Capture {
    /// Lines for stdout so far, which this empties.
    pub fn take_printed(&self) -> String {
        std::mem::take(&mut *self.printed.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Lines for stderr so far, which this empties.
    pub fn take_notes(&self) -> Vec<String> {
        std::mem::take(&mut *self.notes.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Progress of the command's simulated run.
    pub fn progress(&self) -> Progress {
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reports progress.
    pub fn set_progress(&self, progress: Progress) {
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = progress;
    }

    /// Asks the command to stop: a simulated run ends within a millisecond of machine time, and no file is written any
    /// more.
    pub fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }

    /// Whether the command is to stop.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }
}

/// The capture of this thread, for another thread that does a part of its command.
pub fn capture() -> Option<Arc<Capture>> {
    CAPTURE.with_borrow(Clone::clone)
}

/// Does a part of a command on this thread with its output captured; without a capture it is printed.
pub fn captured<T>(capture: Option<Arc<Capture>>, part: impl FnOnce() -> T) -> T {
    /// Puts the earlier capture back, also where the part panics.
    struct Restored(Option<Arc<Capture>>);
    impl Drop for Restored {
        fn drop(&mut self) {
            CAPTURE.set(self.0.take());
        }
    }
    let _restored = Restored(CAPTURE.replace(capture));
    part()
}

/// Does a part of a command on this thread, and returns its lines for stdout. Those for stderr are dropped.
pub fn printed_by<T>(part: impl FnOnce() -> T) -> (T, String) {
    let capture = Arc::new(Capture::default());
    let result = captured(Some(Arc::clone(&capture)), part);
    (result, capture.take_printed())
}

/// Prints a line on stdout.
///
/// # Errors
/// The reader of stdout is gone, or the disk is full.
pub fn print(line: Arguments<'_>) -> std::io::Result<()> {
    if let Some(capture) = capture() {
        let mut printed = capture.printed.lock().unwrap_or_else(PoisonError::into_inner);
        return writeln!(printed, "{line}").map_err(std::io::Error::other);
    }
    let mut stdout = stdout().lock();
    writeln!(stdout, "{line}")?;
    stdout.flush()
}

/// Prints a line on stderr; errors of stderr are ignored, because nothing is left to report them to.
pub fn note(line: Arguments<'_>) {
    if let Some(capture) = capture() {
        capture.notes.lock().unwrap_or_else(PoisonError::into_inner).push(line.to_string());
    } else if !IS_QUIET.load(Ordering::Relaxed) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capture_receives_the_lines_of_its_thread_and_of_no_other() {
        let (one, other) = (Arc::new(Capture::default()), Arc::new(Capture::default()));
        captured(Some(Arc::clone(&one)), || {
            print(format_args!("printed")).unwrap();
            let of_other = Arc::clone(&other);
            let beside = std::thread::spawn(move || captured(Some(of_other), || note(format_args!("beside"))));
            beside.join().unwrap();
            captured(None, || assert!(capture().is_none()));
            note(format_args!("noted"));
        });
        assert!(capture().is_none());
        assert_eq!((one.take_printed().as_str(), one.take_notes()), ("printed\n", vec!["noted".to_owned()]));
        assert_eq!((other.take_printed().as_str(), other.take_notes()), ("", vec!["beside".to_owned()]));
    }

    #[test]
    fn a_part_that_panics_leaves_no_capture_behind() {
        let panics = || captured(Some(Arc::default()), || panic!("on purpose"));
        assert!(std::panic::catch_unwind(panics).is_err() && capture().is_none());
    }
}
