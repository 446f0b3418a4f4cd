//! State of a link between host and board, and the messages that it delivers.

use arcfeed_units::{Micros, Span};

/// State of a link between host and board.
///
/// ```text
///             hello that cannot be talked to
///  Greeting ---------------------------------> Refused
///     |   ^                                       |
///     |   +---------------------------------------+  hello that can
///     |
///     |  hello that knows my session, or a heartbeat between our two sessions
///     v
///     Up ------------------------------------> Lost ---- restart ----> Greeting
///          silence, another session, no acknowledgement,
///          garbage, goodbye
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LinkState {
    /// Sends hellos; no acceptable hello of a peer has led to a session yet.
    Greeting,
    /// Sends hellos; the last hello that arrived came from a peer that does not fit.
    Refused(Refusal),
    /// Both ends know each other's session number and exchange messages.
    Up,
    /// The link has ended; only a restart leaves this state.
    Lost(Loss),
}

/// Reason why a peer's hello is rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The peer has this other version of the protocol.
    Version(u8),
    /// The peer has this role instead of the other one: this end hears its own echo, or both ends have the same role.
    Role(u8),
    /// The peer has another table of messages, with this hash.
    Schema(u32),
    /// The peer's heartbeat interval is too long for this end's `lost_after`.
    Heartbeat(Span),
}

/// Reason why a link that was up has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Loss {
    /// No valid frame of the peer, late copies excluded, for the time `lost_after`.
    Silence,
    /// A hello with another session: the peer has restarted or was replaced.
    PeerRestarted,
    /// The peer sends frames but has not acknowledged a message for the time `unacknowledged_after`.
    Unacknowledged,
    /// `bad_frames_max` consecutive frames were invalid.
    Garbled,
    /// The peer has closed the link.
    PeerClosed,
    /// This end has closed the link.
    Closed,
}

/// Reason why the link did not accept a message for sending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SendError {
    /// The link is not up.
    Down,
    /// Too many reliable messages are unacknowledged, or values of too many kinds are waiting.
    Full,
    /// The payload is longer than [`super::frame::PAYLOAD_MAX`]; this is its length in bytes.
    TooLong(usize),
}

/// A message from the peer, as passed to the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Received<'a> {
    /// Kind of the message: its number in the table of messages.
    pub kind: u8,
    /// Payload of the message, still encoded.
    pub payload: &'a [u8],
    /// Whether the message comes once and in order, or is a value that expires.
    pub delivery: Delivery,
}

/// Guarantee with which a message is delivered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Delivery {
    /// Delivered once and in order.
    Reliable,
    /// Only the newest value is delivered; it is valid until `expires`.
    Latest {
        /// Instant, by the receiver's clock, from which the value must not be used.
        expires: Micros,
    },
}
