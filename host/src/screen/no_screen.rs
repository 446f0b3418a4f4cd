//! Stand-in for the screen in a build without the feature `tui`.

use std::io;

use super::view::{Command, View};

/// Stand-in for the screen in a build without it; has no values.
#[derive(Debug)]
pub enum Screen {}

impl Screen {
    /// Always fails; `stream --tui` reports the reason before it calls this function.
    ///
    /// # Errors
    /// Always.
    pub fn open(_first: View) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Shows nothing.
    pub fn show(&self, _view: &View) {}

    /// Never returns a command.
    pub fn command(&self) -> Option<Command> {
        None
    }
}
