//! Messages on a line without a link: each in a frame of its own, outside of any session. Lost messages are not
//! repeated; corrupt ones are counted.

use super::deframer::Deframer;
use super::frame::{FrameClass, Header, NO_SALT, PAYLOAD_MAX, VERSION, encode};
use super::message::Message;
use arcfeed_units::Micros;

/// One end of a line that carries each message in a frame of its own, without sessions and acknowledgements.
#[derive(Debug, Default)]
pub struct PlainLine {
    deframer: Deframer,
    sent: u16,
    invalid: u32,
}

impl PlainLine {
    /// End of a line before its first byte.
    pub const fn new() -> Self {
        PlainLine { deframer: Deframer::new(), sent: 0, invalid: 0 }
    }

    /// Processes a received byte. Returns the message that it completes; `None` if it completes none, or an invalid
    /// frame.
    pub fn on_byte(&mut self, byte: u8) -> Option<Message> {
        let Ok(frame) = self.deframer.push(byte)? else {
            self.invalid = self.invalid.wrapping_add(1);
            return None;
        };
        let is_plain = frame.version == VERSION && frame.salt == NO_SALT && frame.header.class == FrameClass::Plain;
        let message = is_plain.then(|| Message::decode(frame.header.kind, frame.payload).ok()).flatten();
        self.invalid = self.invalid.wrapping_add(u32::from(message.is_none()));
        message
    }

    /// Writes a message as a frame into `out`, which should hold [`super::frame::ENCODED_MAX`] bytes. Returns its
    /// length; 0 if it does not fit.
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

    /// Number of invalid frames received so far; wraps around.
    pub fn invalid(&self) -> u32 {
        self.invalid
    }
}
