//! Diagnostic messages of ports with the URL option `logging=LEVEL`: on stderr, in the form of Python's `logging`.

use std::fmt::Arguments;
use std::io::{Write, stderr};

/// Severity of a message, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Every single step.
    Debug,
    /// Result of a negotiation with a server.
    Info,
    /// Unexpected event after which the port continues.
    Warning,
    /// Failure of the port.
    Error,
}

/// Log of one kind of port: prints the messages from a chosen level on.
#[derive(Clone, Copy, Debug)]
pub struct Log {
    name: &'static str,
    from: Option<Level>,
}

impl Level {
    /// Level with this name in pyserial's URLs (`debug`, `info`, `warning`, `error`); `None` for any other text.
    pub fn named(name: &str) -> Option<Level> {
        Some(match name {
            "debug" => Level::Debug,
            "info" => Level::Info,
            "warning" => Level::Warning,
            "error" => Level::Error,
            _ => return None,
        })
    }
}

impl Log {
    /// Log whose messages begin with `name`. It prints those of level `from` and above, or nothing if that is `None`.
    pub fn new(name: &'static str, from: Option<Level>) -> Self {
        Log { name, from }
    }

    /// Prints the message if its level is at or above that of the log.
    pub fn say(&self, level: Level, message: Arguments<'_>) {
        if self.from.is_some_and(|from| level >= from) {
            note(format_args!("{}:arcfeed.{}:{message}", format!("{level:?}").to_uppercase(), self.name));
        }
    }
}

/// Prints a line on stderr; errors of stderr are ignored, because nothing is left to report them to.
pub fn note(line: Arguments<'_>) {
    let _lost = writeln!(stderr().lock(), "{line}");
}
