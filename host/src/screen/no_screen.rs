//! Stand-in for the screen in a build without the feature `tui`.

use std::io;

use super::view::{Command, View};

/// There is none.
#[derive(Debug)]
pub enum Screen {}

impl Screen {
    /// Refuses; `stream --tui` says why before it comes here.
    ///
    /// # Errors
    /// Always.
    pub fn open(_first: View) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Shows nothing.
    pub fn show(&self, _view: &View) {}

    /// Hears nothing.
    pub fn command(&self) -> Option<Command> {
        None
    }
}
