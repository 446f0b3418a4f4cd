//! Identity of a board, sent to its host on request.

use arcfeed_link::message::codes::ResetCode;

/// Identity of a board, which its host can ask for: name, version and last start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Name of the board.
    pub name: &'static str,
    /// Version of the firmware: major, minor, patch.
    pub version: [u8; 3],
    /// Cause of the last start.
    pub reset: ResetCode,
    /// Number of starts so far, as far as the board has counted them.
    pub starts: u32,
}
