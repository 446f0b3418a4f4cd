//! Frames: a header, a payload and a checksum, stuffed so that a zero byte is always a delimiter (docs/protocol.md,
//! Frame).
//!
//! ```text
//! on the line   COBS(body) 0x00
//! body          version and flags and class u8, kind u8, seq u16, ack u16, t u32, payload, check u32     little endian
//! check         CRC-32C(all before it) ^ salt                                                            (1)
//! ```
//!
//! COBS: Cheshire and Baker, Consistent overhead byte stuffing, IEEE/ACM Trans. Networking 7(2), 1999, by the crate
//! `cobs`. CRC-32C: Castagnoli, Bräuer and Herrmann, IEEE Trans. Communications 41(6), 1993, by the crate `crc`; at
//! these lengths it detects up to five flipped bits of a body, and every burst of up to 32 bits. The salt represents
//! the data that both ends know already ([`super::session`]). It is added to the checksum, so the receiver can compute
//! the salt of a frame.

use crc::{CRC_32_ISCSI, Crc};

/// Version of the link protocol that this code speaks; every frame carries it.
pub const VERSION: u8 = 1;

/// Longest payload of a message, bytes.
pub const PAYLOAD_MAX: usize = 224;

/// Length of the header, which stands before the payload, bytes.
pub const HEADER_LEN: usize = 10;
/// Length of the checksum, which stands after the payload, bytes.
pub const CHECK_LEN: usize = 4;
/// Largest number of bytes that a message class puts before the message, such as its sequence number.
pub const PREFIX_MAX: usize = 2;
/// Longest body (header, payload and checksum), bytes. Below 254, so that the byte stuffing adds only one byte.
pub const BODY_MAX: usize = HEADER_LEN + PREFIX_MAX + PAYLOAD_MAX + CHECK_LEN;
/// Longest frame on the line, bytes: a leading delimiter, the stuffed body, and the closing delimiter.
pub const ENCODED_MAX: usize = BODY_MAX + 3;
/// Number of bytes that a frame adds to its payload on the line: header, checksum, stuffing and closing delimiter.
pub const OVERHEAD: usize = HEADER_LEN + CHECK_LEN + 2;

/// Salt (value combined with the checksum) of frames that belong to no session.
pub const NO_SALT: u32 = 0;

const BUSY: u8 = 0x08;
const CLASS: u8 = 0x07;
const VERSION_SHIFT: u32 = 4;

pub(crate) static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

/// Class of a frame: what it is for, and whether it is repeated if lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameClass {
    /// Identification of the sender, by which a session begins; belongs to no session.
    Hello = 0,
    /// Sign of life at fixed intervals, with an echo of the peer's last time stamp.
    Heartbeat = 1,
    /// Acknowledgement of received reliable messages.
    Ack = 2,
    /// Acknowledgement, and request to send the following messages again: they were discarded because one before them
    /// is missing.
    Nak = 3,
    /// End of the session by the sender.
    Bye = 4,
    /// A message that is delivered once and in order.
    Reliable = 5,
    /// A message of which only the newest value is used.
    Latest = 6,
    /// A message on a line without sessions; it is not repeated if lost.
    Plain = 7,
}

/// Header of a frame: all fields before the payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Header {
    /// Whether the sender of the frame accepts no reliable messages at present.
    pub class: FrameClass,
    /// Kind of the message: its number in the table of messages; 0 if the frame carries none.
    pub is_busy: bool,
    /// Sequence number of the message within its class; 0 if the frame carries none.
    pub kind: u8,
    /// Sequence number of the reliable message that the sender of the frame expects next: all before it are
    /// acknowledged.
    pub seq: u16,
    /// Sequence number of the reliable message that the sender expects next.
    pub ack: u16,
    /// Instant at which the frame was sent, by the sender's clock, microseconds modulo 2^32.
    pub t_us: u32,
}

/// A received frame, taken apart; its checksum is not yet checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Version of the sender's protocol. If it differs from [`VERSION`], only the frame class `Hello` can be
    /// interpreted.
    pub version: u8,
    /// Fields before the payload.
    pub header: Header,
    /// Bytes between header and checksum.
    pub payload: &'a [u8],
    /// Value that the sender has combined with the checksum, computed back from it. The frame is valid if this is the
    /// expected salt of the session; for corrupt frames it is an arbitrary number.
    pub salt: u32,
}

impl Header {
    /// Header of a message on a line without sessions.
    pub const fn plain(kind: u8, seq: u16, t_us: u32) -> Self {
        Header { class: FrameClass::Plain, is_busy: false, kind, seq, ack: 0, t_us }
    }
}

impl FrameClass {
    const fn of_bits(bits: u8) -> Self {
        match bits & CLASS {
            0 => FrameClass::Hello,
            1 => FrameClass::Heartbeat,
            2 => FrameClass::Ack,
            3 => FrameClass::Nak,
            4 => FrameClass::Bye,
            5 => FrameClass::Reliable,
            6 => FrameClass::Latest,
            _ => FrameClass::Plain,
        }
    }
}

/// CRC-32C checksum of these bytes.
pub fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// Writes a frame into `out`, byte-stuffed and with its closing delimiter, and returns its length in bytes. The
/// payload is both parts of `payload`, one after the other.
///
/// Returns `None` if `out` or the body is too short. This never happens with `out` of [`ENCODED_MAX`] bytes and a
/// payload of at most [`PREFIX_MAX`] + [`PAYLOAD_MAX`].
pub fn encode(header: &Header, payload: [&[u8]; 2], salt: u32, out: &mut [u8]) -> Option<usize> {
    let mut body = heapless::Vec::<u8, BODY_MAX>::new();
    let flags = if header.is_busy { BUSY } else { 0 };
    body.push((VERSION << VERSION_SHIFT) | flags | header.class as u8).ok()?;
    body.push(header.kind).ok()?;
    body.extend_from_slice(&header.seq.to_le_bytes()).ok()?;
    body.extend_from_slice(&header.ack.to_le_bytes()).ok()?;
    body.extend_from_slice(&header.t_us.to_le_bytes()).ok()?;
    for part in payload {
        body.extend_from_slice(part).ok()?;
    }
    let check = checksum(&body) ^ salt; // (1)
    body.extend_from_slice(&check.to_le_bytes()).ok()?;
    let len = cobs::try_encode(&body, out).ok()?;
    *out.get_mut(len)? = 0;
    Some(len.saturating_add(1))
}

/// Takes a received body apart, after the stuffing was removed; `None` if it is shorter than header and checksum.
pub fn parse(body: &[u8]) -> Option<Frame<'_>> {
    let (message, check) = body.split_last_chunk::<CHECK_LEN>()?;
    let (header, payload) = message.split_first_chunk::<HEADER_LEN>()?;
    let [first, kind, s0, s1, a0, a1, t0, t1, t2, t3] = *header;
    let header = Header {
        class: FrameClass::of_bits(first),
        is_busy: first & BUSY != 0,
        kind,
        seq: u16::from_le_bytes([s0, s1]),
        ack: u16::from_le_bytes([a0, a1]),
        t_us: u32::from_le_bytes([t0, t1, t2, t3]),
    };
    let salt = checksum(message) ^ u32::from_le_bytes(*check); // (1)
    Some(Frame { version: first >> VERSION_SHIFT, header, payload, salt })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: Header = Header::plain(1, 2, 3);

    #[test]
    fn the_longest_frame_fits_whatever_its_bytes_and_one_byte_more_does_not() {
        for byte in [0, 1, 0xFF] {
            let mut out = [0; ENCODED_MAX];
            let payload = [byte; PAYLOAD_MAX];
            let len = encode(&HEADER, [&[byte; PREFIX_MAX], &payload], NO_SALT, &mut out).unwrap();
            // One byte remains for a leading delimiter.
            assert_eq!((len, out[len - 1]), (ENCODED_MAX - 1, 0));
            assert_eq!(encode(&HEADER, [&[byte; PREFIX_MAX + 1], &payload], NO_SALT, &mut out), None);
            assert_eq!(encode(&HEADER, [&[byte; PREFIX_MAX], &payload], NO_SALT, &mut out[..len - 1]), None);
        }
    }

    #[test]
    fn a_frame_without_payload_takes_its_overhead_and_anything_shorter_is_none() {
        let mut out = [0; ENCODED_MAX];
        assert_eq!(encode(&HEADER, [&[], &[]], NO_SALT, &mut out), Some(OVERHEAD));
        let body = cobs::decode_vec(&out[..OVERHEAD - 1]).unwrap();
        assert_eq!(parse(&body).map(|frame| (frame.header, frame.payload.len())), Some((HEADER, 0)));
        (0..body.len()).for_each(|len| assert_eq!(parse(&body[..len]), None));
    }
}
