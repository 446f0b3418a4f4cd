//! State of a link, and the messages that it delivers.

use arcfeed_units::{Micros, Span};

/// State of a link.
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
    /// Sends hellos; no answer yet.
    Greeting,
    /// Sends hellos; the answer came from an incompatible peer.
    Refused(Refusal),
    /// Both ends know each other's session.
    Up,
    /// Ended; only a restart leaves this state.
    Lost(Loss),
}

/// Reason why a peer is rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The peer has this other version of the protocol.
    Version(u8),
    /// The peer has this unexpected role: an echo, or two ends with the same role.
    Role(u8),
    /// The peer has other messages, with this hash.
    Schema(u32),
    /// The peer's heartbeat is too slow for `lost_after`.
    Heartbeat(Span),
}

/// Reason why a link is no longer up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Loss {
    /// No valid new frame for `lost_after`.
    Silence,
    /// A hello with another session: the peer has restarted or was replaced.
    PeerRestarted,
    /// The peer sends frames but does not acknowledge messages.
    Unacknowledged,
    /// Too many consecutive invalid frames.
    Garbled,
    /// The peer has closed the link.
    PeerClosed,
    /// This end has closed the link.
    Closed,
}

/// Reason why a message was not accepted for sending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SendError {
    /// The link is not up.
    Down,
    /// The window of reliable messages, or the number of latest-wins kinds, is exhausted.
    Full,
    /// Longer than [`super::frame::PAYLOAD_MAX`].
    TooLong(usize),
}

/// A message from the peer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Received<'a> {
    /// Kind or payload as sent.
    pub kind: u8,
    /// Kind or payload as sent.
    pub payload: &'a [u8],
    /// Class of delivery.
    pub delivery: Delivery,
}

/// Class of delivery of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Delivery {
    /// Once and in order.
    Reliable,
    /// Newest value, valid until `expires` by the receiver's clock.
    Latest {
        /// Time from which the value must not be used.
        expires: Micros,
    },
}
