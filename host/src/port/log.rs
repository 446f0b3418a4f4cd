//! What `?logging=LEVEL` asks for: messages on stderr in the form of Python's `logging`.

use crate::console::note;

/// How much a message matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Every step.
    Debug,
    /// What was agreed on.
    Info,
    /// What is odd.
    Warning,
    /// What failed.
    Error,
}

/// Says what is at least as important as asked for.
#[derive(Clone, Copy, Debug)]
pub struct Log {
    name: &'static str,
    from: Option<Level>,
}

impl Level {
    /// By pyserial's names.
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
    /// Messages of `name`; none without a level.
    pub fn new(name: &'static str, from: Option<Level>) -> Self {
        Log { name, from }
    }

    /// Says it, if it was asked for.
    pub fn say(&self, level: Level, message: std::fmt::Arguments<'_>) {
        if self.from.is_some_and(|from| level >= from) {
            note(format_args!("{}:arcfeed.{}:{message}", format!("{level:?}").to_uppercase(), self.name));
        }
    }
}
