//! Messages on a line without a link: each in a frame of its own, outside of any session. Lost is lost; corrupted is counted.

use super::deframer::Deframer;
use super::frame::{Class, Header, NO_SALT, PAYLOAD_MAX, VERSION, encode};
use super::message::Message;
use crate::units::Micros;

/// One end of such a line.
#[derive(Debug, Default)]
pub struct PlainLine {
    deframer: Deframer,
    sent: u16,
    invalid: u32,
}

impl PlainLine {
    /// Before the first byte.
    pub const fn new() -> Self {
        PlainLine { deframer: Deframer::new(), sent: 0, invalid: 0 }
    }

    /// Takes a byte off the line; the message that it ends.
    pub fn on_byte(&mut self, byte: u8) -> Option<Message> {
        let Ok(frame) = self.deframer.push(byte)? else {
            self.invalid = self.invalid.wrapping_add(1);
            return None;
        };
        let is_plain = frame.version == VERSION && frame.salt == NO_SALT && frame.header.class == Class::Plain;
        let message = is_plain.then(|| Message::decode(frame.header.kind, frame.payload).ok()).flatten();
        self.invalid = self.invalid.wrapping_add(u32::from(message.is_none()));
        message
    }

    /// Puts a message into a frame; its length in `out`, which should hold [`super::frame::ENCODED_MAX`] bytes. 0 if it has no
    /// room.
    pub fn encode(&mut self, now: Micros, message: &Message, out: &mut [u8]) -> usize {
        let mut payload = [0; PAYLOAD_MAX];
        let Some(payload) = message.encode(&mut payload).ok().and_then(|length| payload.get(..length)) else {
            return 0;
        };
        let header = Header::plain(message.kind(), self.sent, now.0 as u32);
        let length = encode(&header, [payload, &[]], NO_SALT, out).unwrap_or(0);
        self.sent = self.sent.wrapping_add(u16::from(length > 0));
        length
    }

    /// Frames that were none, so far; wraps.
    pub fn invalid(&self) -> u32 {
        self.invalid
    }
}
