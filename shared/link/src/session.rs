//! Sessions: the hello, and the salt that binds every other frame to one pair of sessions.
//!
//! ```text
//! salt(from a to b) = CRC-32C(role of a, session of a, session of b, schema)     little endian     (1)
//! ```
//!
//! A CRC maps four consecutive bytes one to one if all others are unchanged. If one end begins a new session, the salt
//! therefore always changes, and no old frame is accepted. If both ends do, an old frame is accepted with a
//! probability of 2^-32.

use super::frame::checksum;
use super::settings::{LinkSettings, Role};
use super::state::Refusal;
use arcfeed_units::{Span, US_PER_MS};

/// Length of a hello's payload, bytes.
pub const HELLO_LEN: usize = 23;
/// Length of an encoded [`Echo`], bytes.
pub const ECHO_LEN: usize = 8;

/// Echo in a frame: the time stamp of the peer's last frame, and how long ago that one arrived. The peer computes the
/// round-trip time from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Echo {
    /// Time stamp of the peer's last frame, by the peer's clock, microseconds modulo 2^32.
    pub t_us: u32,
    /// Time from the arrival of that frame to the sending of this one, microseconds.
    pub held_us: u32,
}

/// Payload of a hello, the frame by which one end of a link identifies itself to the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Hello {
    /// Role of the sender: 1 host, 2 board.
    pub role: u8,
    /// Hash of the sender's table of messages.
    pub schema: u32,
    /// Session number of the sender.
    pub session: u32,
    /// Session number of the peer, if the sender knows it; otherwise 0.
    pub peer_session: u32,
    /// Longest time between two heartbeats of the sender, milliseconds.
    pub heartbeat_ms: u16,
    /// Echo of the peer's last frame; all zero if there was none.
    pub echo: Echo,
}

/// The peer's session number, and the salts (values combined with the checksums) of both directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Peer {
    /// Session number of the peer.
    pub session: u32,
    /// Salt of frames from the peer.
    pub salt_in: u32,
    /// Salt of frames to the peer.
    pub salt_out: u32,
}

impl Echo {
    /// Encodes the echo as bytes.
    pub fn encode(&self) -> [u8; ECHO_LEN] {
        let [t0, t1, t2, t3] = self.t_us.to_le_bytes();
        let [h0, h1, h2, h3] = self.held_us.to_le_bytes();
        [t0, t1, t2, t3, h0, h1, h2, h3]
    }

    /// Decodes an echo from bytes.
    pub fn decode(bytes: &[u8; ECHO_LEN]) -> Self {
        let [t0, t1, t2, t3, h0, h1, h2, h3] = *bytes;
        Echo { t_us: u32::from_le_bytes([t0, t1, t2, t3]), held_us: u32::from_le_bytes([h0, h1, h2, h3]) }
    }
}

impl Hello {
    /// Hello of an end with these settings, this session, and the peer's session (0 if unknown).
    pub fn new(settings: &LinkSettings, session: u32, peer_session: u32, echo: Echo) -> Self {
        let heartbeat_ms = u64::from(settings.heartbeat.0).div_ceil(US_PER_MS);
        let heartbeat_ms = u16::try_from(heartbeat_ms).unwrap_or(u16::MAX);
        let (role, schema) = (settings.role as u8, settings.schema);
        Hello { role, schema, session, peer_session, heartbeat_ms, echo }
    }

    /// Encodes the hello as bytes.
    pub fn encode(&self) -> [u8; HELLO_LEN] {
        let [s0, s1, s2, s3] = self.schema.to_le_bytes();
        let [m0, m1, m2, m3] = self.session.to_le_bytes();
        let [p0, p1, p2, p3] = self.peer_session.to_le_bytes();
        let [b0, b1] = self.heartbeat_ms.to_le_bytes();
        let [e0, e1, e2, e3, e4, e5, e6, e7] = self.echo.encode();
        let role = self.role;
        [role, s0, s1, s2, s3, m0, m1, m2, m3, p0, p1, p2, p3, b0, b1, e0, e1, e2, e3, e4, e5, e6, e7]
    }

    /// Decodes a hello from bytes; `None` if their number is wrong.
    pub fn decode(payload: &[u8]) -> Option<Self> {
        let bytes: [u8; HELLO_LEN] = payload.try_into().ok()?;
        let [role, s0, s1, s2, s3, m0, m1, m2, m3, p0, p1, p2, p3, b0, b1, echo @ ..] = bytes;
        Some(Hello {
            role,
            schema: u32::from_le_bytes([s0, s1, s2, s3]),
            session: u32::from_le_bytes([m0, m1, m2, m3]),
            peer_session: u32::from_le_bytes([p0, p1, p2, p3]),
            heartbeat_ms: u16::from_le_bytes([b0, b1]),
            echo: Echo::decode(&echo),
        })
    }

    /// Reason why an end with these settings rejects this hello from its peer; `None` if it accepts it.
    pub fn refusal(&self, settings: &LinkSettings) -> Option<Refusal> {
        let heartbeat = Span::from_ms(u32::from(self.heartbeat_ms));
        if self.role != settings.role.other() as u8 {
            Some(Refusal::Role(self.role))
        } else if self.schema != settings.schema {
            Some(Refusal::Schema(self.schema))
        } else if heartbeat.longer_by(heartbeat) > settings.lost_after {
            Some(Refusal::Heartbeat(heartbeat))
        } else {
            None
        }
    }
}

impl Peer {
    /// Peer with session number `session`; `ours` is the session number of this end.
    pub fn new(settings: &LinkSettings, ours: u32, session: u32) -> Self {
        let salt_in = salt(settings.role.other(), [session, ours, settings.schema]);
        let salt_out = salt(settings.role, [ours, session, settings.schema]);
        Peer { session, salt_in, salt_out }
    }
}

/// Salt that binds the frames from one role to a pair of sessions: computed from the session numbers of sender and
/// receiver and the hash of the messages. (1)
pub fn salt(from: Role, [ours, theirs, schema]: [u32; 3]) -> u32 {
    let [a0, a1, a2, a3] = ours.to_le_bytes();
    let [b0, b1, b2, b3] = theirs.to_le_bytes();
    let [s0, s1, s2, s3] = schema.to_le_bytes();
    checksum(&[from as u8, a0, a1, a2, a3, b0, b1, b2, b3, s0, s1, s2, s3]) // (1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_session_of_either_end_is_another_salt() {
        // All 65 536 sessions that differ in two bytes, at three positions, have different salts.
        for shift in [0, 8, 16] {
            let sessions = (0..=0xFFFF_u32).map(|low| 0x1234_5678 ^ (low << shift));
            let salts: std::collections::HashSet<u32> =
                sessions.clone().map(|session| salt(Role::Host, [session, 7, 9])).collect();
            assert_eq!(salts.len(), 0x1_0000);
            let salts: std::collections::HashSet<u32> =
                sessions.map(|session| salt(Role::Host, [7, session, 9])).collect();
            assert_eq!(salts.len(), 0x1_0000);
        }
        assert_ne!(salt(Role::Host, [7, 7, 9]), salt(Role::Board, [7, 7, 9]));
    }

    #[test]
    fn a_hello_reads_as_it_was_written_and_no_other_length_does() {
        let echo = Echo { t_us: 0x0102_0304, held_us: 0xFFFF_FFFF };
        let hello = Hello::new(&LinkSettings::new(Role::Board, 0xAABB_CCDD), 5, 6, echo);
        assert_eq!(Hello::decode(&hello.encode()), Some(hello));
        assert_eq!((Hello::decode(&[0; HELLO_LEN - 1]), Hello::decode(&[0; HELLO_LEN + 1])), (None, None));
    }
}
