//! Built without a screen.

use std::io;

use super::view::{Command, View};
use crate::features::not_built_in;

/// There is none.
#[derive(Debug)]
pub enum Screen {}

impl Screen {
    /// Refuses.
    ///
    /// # Errors
    /// Always.
    pub fn open(_first: View) -> io::Result<Self> {
        Err(io::Error::other(not_built_in("its screen", "tui")))
    }

    /// Shows nothing.
    pub fn show(&self, _view: &View) {}

    /// Hears nothing.
    pub fn command(&self) -> Option<Command> {
        None
    }
}
