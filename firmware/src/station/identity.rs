//! What a board says of itself.

use arcfeed_shared::wire::message::codes::ResetCode;

/// What the board is; config.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Its name.
    pub name: &'static str,
    /// Version of its firmware.
    pub version: [u8; 3],
    /// Why it started.
    pub reset: ResetCode,
    /// How often it started, as far as it knows.
    pub starts: u32,
}
