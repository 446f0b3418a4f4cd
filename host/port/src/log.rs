//! Messages of `?logging=LEVEL`, on stderr in the form of Python's `logging`.

use std::fmt::Arguments;
use std::io::{Write, stderr};

/// Level of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Every step.
    Debug,
    /// Result of a negotiation.
    Info,
    /// Unexpected event.
    Warning,
    /// Failure.
    Error,
}

/// Log that prints messages from a level on.
#[derive(Clone, Copy, Debug)]
pub struct Log {
    name: &'static str,
    from: Option<Level>,
}

impl Level {
    /// Level by pyserial's name.
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
    /// Log with the messages of `name`; none without a level.
    pub fn new(name: &'static str, from: Option<Level>) -> Self {
        Log { name, from }
    }

    /// Prints a message if its level is high enough.
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
