//! Stand-in for the live page in a build without the feature `web`.

use std::io;
use std::net::SocketAddr;

use super::snapshot::Snapshot;
use crate::screen::view::Command;

/// Stand-in for the live page; has no values.
#[derive(Debug)]
pub enum LivePage {}

impl LivePage {
    /// Always fails; `stream --web` reports the reason before it calls this function.
    ///
    /// # Errors
    /// Always.
    pub fn open(_address: SocketAddr, _page: String, _first: Snapshot) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Never called, because there is no value.
    pub fn url(&self) -> String {
        String::new()
    }

    /// Shows nothing.
    pub fn show(&self, _snapshot: Snapshot) {}

    /// Shows nothing.
    pub fn end(&mut self, _last: Snapshot) {}

    /// Always `None`: no page is there to send a command.
    pub fn command(&self) -> Option<Command> {
        None
    }
}
