//! All output to stdout and stderr. A message that cannot be written never ends the program.
//!
//! A caller that runs a command as a function passes a [`Capture`], which receives the lines in place of both streams, and
//! through which the caller follows the command and stops it. It belongs to the thread that runs the command.

use std::cell::RefCell;
use std::fmt::{Arguments, Write as _};
use std::io::{Write, stderr, stdout};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::trace::MemoryTable;

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
    /// Tables of the run, if the caller wants them.
    tables: Option<Mutex<Vec<MemoryTable>>>,
    is_stopped: Arc<AtomicBool>,
}

/// Progress of a command.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Progress {
    /// Nothing to report yet.
    #[default]
    None,
    /// A simulated run is under way.
    Run {
        /// Number of blocks executed so far.
        blocks: usize,
        /// Machine time, s.
        time_s: f64,
    },
    /// A campaign, or one shard of it, is under way.
    Campaign {
        /// Number of runs that have ended.
        done: u64,
        /// Number of runs in all.
        runs: u64,
    },
}

impl Capture {
    /// Capture that also receives the tables of a simulated run.
    pub fn with_tables() -> Self {
        Capture { tables: Some(Mutex::default()), ..Capture::default() }
    }

    /// Whether the caller wants the tables of a simulated run.
    pub fn wants_tables(&self) -> bool {
        self.tables.is_some()
    }

    /// Receives a complete table of a run; drops it if the caller does not want tables.
    pub fn add_table(&self, table: MemoryTable) {
        if let Some(tables) = &self.tables {
            tables.lock().unwrap_or_else(PoisonError::into_inner).push(table);
        }
    }

    /// Returns the tables received so far and removes them.
    pub fn take_tables(&self) -> Vec<MemoryTable> {
        let take = |tables: &Mutex<Vec<_>>| std::mem::take(&mut *tables.lock().unwrap_or_else(PoisonError::into_inner));
        self.tables.as_ref().map(take).unwrap_or_default()
    }

    /// Returns the text for stdout received so far and removes it.
    pub fn take_printed(&self) -> String {
        std::mem::take(&mut *self.printed.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Returns the lines for stderr received so far and removes them.
    pub fn take_notes(&self) -> Vec<String> {
        std::mem::take(&mut *self.notes.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Latest progress of the command.
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

    /// Whether the caller has asked the command to stop.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }
}

/// Capture of this thread, to be given to another thread that does a part of its command; `None` if output is printed.
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

/// Does a part of a command on this thread, and returns its lines for stdout. Those for stderr are dropped. A caller that
/// stops the command stops the part too.
pub fn printed_by<T>(part: impl FnOnce() -> T) -> (T, String) {
    let is_stopped = capture().map(|outer| Arc::clone(&outer.is_stopped)).unwrap_or_default();
    let capture = Arc::new(Capture { is_stopped, ..Capture::default() });
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

    #[test]
    fn a_caller_that_stops_a_command_stops_its_parts() {
        let outer = Arc::new(Capture::default());
        let is_stopped = || capture().is_some_and(|capture| capture.is_stopped());
        let ((before, after), _) = captured(Some(Arc::clone(&outer)), || {
            printed_by(|| {
                let before = is_stopped();
                outer.stop();
                (before, is_stopped())
            })
        });
        assert_eq!((before, after, printed_by(is_stopped).0), (false, true, false));
    }
}
