//! Identity of a board, sent to its host on request.

use arcfeed_link::message::codes::ResetCode;

/// Identity of a board: name, version and last start; configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Name.
    pub name: &'static str,
    /// Firmware version.
    pub version: [u8; 3],
    /// Cause of the last start.
    pub reset: ResetCode,
    /// Number of starts, as far as the board knows.
    pub starts: u32,
}
