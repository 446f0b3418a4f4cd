//! Where a link stands, and what it hands over.

use crate::units::{Micros, Span};

/// Where a link stands.
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
    /// Greets, and has not been answered.
    Greeting,
    /// Greets, and was answered by one it cannot talk to.
    Refused(Refusal),
    /// Both ends know each other's session.
    Up,
    /// Over; only a restart leads out.
    Lost(Loss),
}

/// Why the other end is not talked to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// Another version of the protocol: theirs.
    Version(u8),
    /// Not the other end's role, which is theirs: an echo, or two of a kind.
    Role(u8),
    /// Other messages: the hash of theirs.
    Schema(u32),
    /// Its heartbeat is too slow for `lost_after`: theirs.
    Heartbeat(Span),
}

/// Why the link is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Loss {
    /// Nothing valid and new was heard for `lost_after`.
    Silence,
    /// Somebody greets with another session: the peer has restarted, or another one is there.
    PeerRestarted,
    /// The peer is heard, but does not acknowledge.
    Unacknowledged,
    /// Too many invalid frames in a row.
    Garbled,
    /// The peer said goodbye.
    PeerClosed,
    /// This end did.
    Closed,
}

/// Why nothing was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SendError {
    /// The link is not up.
    Down,
    /// As much is on its way as may be (reliable), or as many kinds (latest).
    Full,
    /// Longer than [`super::frame::PAYLOAD_MAX`].
    TooLong(usize),
}

/// A message of the peer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Received<'a> {
    /// As the sender gave it.
    pub kind: u8,
    /// As the sender gave it.
    pub payload: &'a [u8],
    /// How it came.
    pub delivery: Delivery,
}

/// What a message's class promises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Delivery {
    /// Each once, in order.
    Reliable,
    /// The newest one, valid until `expires` by the receiver's clock.
    Latest {
        /// From then on it must not be used.
        expires: Micros,
    },
}
