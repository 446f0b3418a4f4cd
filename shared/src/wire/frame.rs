//! Frames: a header, a payload and a checksum, stuffed so that a zero byte can only be an end (docs/protocol.md, Frame).
//!
//! ```text
//! on the line   COBS(body) 0x00
//! body          version and flags and class u8, kind u8, seq u16, ack u16, t u32, payload, check u32     little endian
//! check         CRC-32C(all before it) ^ salt                                                            (1)
//! ```
//!
//! COBS: Cheshire and Baker, Consistent overhead byte stuffing, IEEE/ACM Trans. Networking 7(2), 1999, by the crate `cobs`. CRC-32C:
//! Castagnoli, Bräuer and Herrmann, IEEE Trans. Communications 41(6), 1993, by the crate `crc`; at these lengths any five flipped
//! bits of a body are seen, and every burst of up to 32. The salt stands for what both ends know and need not say again
//! ([`super::session`]): since it is added to the checksum, a frame says which salt it was made with.

use crc::{CRC_32_ISCSI, Crc};

/// This version of the protocol.
pub const VERSION: u8 = 1;

/// Longest payload of a message, bytes.
pub const PAYLOAD_MAX: usize = 224;

/// Before the payload.
pub const HEADER_LEN: usize = 10;
/// Behind the payload.
pub const CHECK_LEN: usize = 4;
/// What a class may put before a message.
pub const PREFIX_MAX: usize = 2;
/// Longest body. Below 254, so that stuffing costs one byte, no more.
pub const BODY_MAX: usize = HEADER_LEN + PREFIX_MAX + PAYLOAD_MAX + CHECK_LEN;
/// Longest frame on the line: a delimiter before it, the stuffed body, the delimiter that ends it.
pub const ENCODED_MAX: usize = BODY_MAX + 3;
/// What a frame takes on the line besides its payload, but for a delimiter before it.
pub const OVERHEAD: usize = HEADER_LEN + CHECK_LEN + 2;

/// The salt of frames that belong to no session.
pub const NO_SALT: u32 = 0;

const BUSY: u8 = 0x08;
const CLASS: u8 = 0x07;
const VERSION_SHIFT: u32 = 4;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

/// What a frame is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Class {
    /// Who I am. Outside of any session.
    Hello = 0,
    /// I am here, and what your clock said.
    Heartbeat = 1,
    /// What I have received.
    Ack = 2,
    /// What I have received; what came behind it was thrown away.
    Nak = 3,
    /// I go.
    Bye = 4,
    /// A message, each once and in order.
    Reliable = 5,
    /// A message of which only the newest counts.
    Latest = 6,
    /// A message without a link: lost is lost. Outside of any session.
    Plain = 7,
}

/// What stands before the payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Header {
    /// What it is for.
    pub class: Class,
    /// The sender takes no reliable messages at present.
    pub is_busy: bool,
    /// Of the message; 0 where there is none.
    pub kind: u8,
    /// Of the message within its class; 0 where there is none.
    pub seq: u16,
    /// The reliable message the sender expects next.
    pub ack: u16,
    /// The sender's clock when it put the frame on the line, microseconds, modulo 2^32.
    pub t_us: u32,
}

/// A frame as it came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// The sender's version of the protocol. Of another one than [`VERSION`] only what a hello says can be believed.
    pub version: u8,
    /// What stands before the payload.
    pub header: Header,
    /// What stands between header and checksum.
    pub payload: &'a [u8],
    /// The salt it was made with, if it is what was sent. Meaningless for corrupted frames.
    pub salt: u32,
}

impl Header {
    /// Of a message without a link.
    pub const fn plain(kind: u8, seq: u16, t_us: u32) -> Self {
        Header { class: Class::Plain, is_busy: false, kind, seq, ack: 0, t_us }
    }
}

impl Class {
    const fn of_bits(bits: u8) -> Self {
        match bits & CLASS {
            0 => Class::Hello,
            1 => Class::Heartbeat,
            2 => Class::Ack,
            3 => Class::Nak,
            4 => Class::Bye,
            5 => Class::Reliable,
            6 => Class::Latest,
            _ => Class::Plain,
        }
    }
}

/// CRC-32C.
pub fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// Writes a frame with the delimiter that ends it; its length. `payload` may come in two parts.
///
/// `None` if `out` or the body is too short: with `out` of [`ENCODED_MAX`] bytes and at most [`PREFIX_MAX`] +
/// [`PAYLOAD_MAX`] of payload, never.
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

/// Reads a body; `None` if it is too short for one.
pub fn parse(body: &[u8]) -> Option<Frame<'_>> {
    let (message, check) = body.split_last_chunk::<CHECK_LEN>()?;
    let (header, payload) = message.split_first_chunk::<HEADER_LEN>()?;
    let [first, kind, s0, s1, a0, a1, t0, t1, t2, t3] = *header;
    let header = Header {
        class: Class::of_bits(first),
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
            // One place is left for a delimiter before it.
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
