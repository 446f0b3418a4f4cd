//! Commands of the program as functions.
//!
//! A command runs on a thread of its own; the calling thread, which holds the interpreter, reports its progress and looks
//! for Ctrl-C. After a Ctrl-C a simulation ends at once, a plan at its end, without a file written: the caller does not wait
//! for that.

use std::ffi::OsString;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::Builder;
use std::time::Duration;

use arcfeed::commands::call::call;
use arcfeed::commands::outcome::Failure;
use arcfeed::console::{Capture, Progress, captured};
use arcfeed::trace::MemoryTable;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use super::table::Table;

/// Time between two looks at the progress and at Ctrl-C.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Longest wait for a command that was asked to stop.
const STOP_WAIT: Duration = Duration::from_millis(500);
/// Stack of a command, as large as that of a program's first thread.
const STACK_BYTES: usize = 8 << 20;

/// Text on stdout, lines on stderr, the kind and message of the failure, if it failed, and the tables of a run by their names.
type Output = (String, Vec<String>, Option<(&'static str, String)>, Vec<(String, Table)>);

/// Runs a command and returns what it would print on stdout, its lines on stderr, its failure as kind and message, and with
/// `tables` those of a simulated run.
///
/// `progress(blocks, time_s)` is called now and then during a simulation, `progress(done, runs)` during a campaign; an
/// exception in it stops the command.
#[pyfunction]
#[pyo3(signature = (words, progress=None, tables=false))]
pub fn run(py: Python<'_>, words: Vec<OsString>, progress: Option<Py<PyAny>>, tables: bool) -> PyResult<Output> {
    let capture = Arc::new(if tables { Capture::with_tables() } else { Capture::default() });
    let (sender, mut receiver) = channel();
    let of_command = Arc::clone(&capture);
    let command = move || {
        let result = captured(Some(of_command), || call(words));
        // After a Ctrl-C no receiver is left.
        let _received = sender.send(result);
    };
    Builder::new().stack_size(STACK_BYTES).spawn(command)?;
    let mut shown = capture.progress();
    let result = loop {
        match wait(py, &mut receiver, LOOK_EVERY) {
            Ok(result) => break result,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a defect of arcfeed: it panicked"));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        let now = capture.progress();
        let reported = match &progress {
            Some(progress) if now != shown => match now {
                Progress::None => Ok(()),
                Progress::Run { blocks, time_s } => progress.call1(py, (blocks, time_s)).map(drop),
                Progress::Campaign { done, runs } => progress.call1(py, (done, runs)).map(drop),
            },
            _ => Ok(()),
        };
        if let Err(error) = reported.and_then(|()| py.check_signals()) {
            capture.stop();
            let _ended = wait(py, &mut receiver, STOP_WAIT);
            return Err(error);
        }
        shown = now;
    };
    let name_and_table = |table: MemoryTable| Ok((table.name.clone(), Table::new(table)?));
    let tables = capture.take_tables().into_iter().map(name_and_table).collect::<PyResult<_>>()?;
    Ok((capture.take_printed(), capture.take_notes(), result.err().map(kind_and_message), tables))
}

/// Waits for a command's end without the interpreter.
fn wait(
    py: Python<'_>,
    receiver: &mut Receiver<Result<(), Failure>>,
    longest: Duration,
) -> Result<Result<(), Failure>, RecvTimeoutError> {
    py.detach(move || receiver.recv_timeout(longest))
}

/// Python exception of the package that corresponds to a failure of a command.
pub fn exception(py: Python<'_>, failure: Failure) -> PyErr {
    let made = || py.import("arcfeed._errors")?.call_method1("exception", kind_and_message(failure));
    made().map_or_else(|error| error, PyErr::from_value)
}

fn kind_and_message(failure: Failure) -> (&'static str, String) {
    match failure {
        Failure::Input(message) => ("input", message),
        Failure::Usage(message) => ("usage", message),
        Failure::Machine(message) => ("machine", message),
        Failure::Undecided(message) => ("undecided", message),
        Failure::Stopped(message) => ("stopped", message),
        Failure::Unprinted(error) => ("input", error.to_string()),
    }
}
