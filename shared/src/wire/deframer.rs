//! From bytes as they come to frames: stuffing undone on the way in, so one buffer of [`BODY_MAX`] bytes is all it takes.
//!
//! Whatever was lost or corrupted, the next delimiter begins anew. Empty frames are no frames: a sender may put delimiters
//! where it likes.

use cobs::{DecodeResult, DecoderState};

use super::frame::{BODY_MAX, Frame, parse};

/// Why bytes between two delimiters are no frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FramingError {
    /// Longer than any frame.
    TooLong,
    /// Shorter than any frame.
    TooShort,
    /// The delimiter came where the stuffing says that bytes follow.
    Cut,
}

/// What is known of the frame that is coming in.
#[derive(Debug)]
pub struct Deframer {
    stuffing: DecoderState,
    body: [u8; BODY_MAX],
    len: usize,
}

impl Default for Deframer {
    fn default() -> Self {
        Self::new()
    }
}

impl Deframer {
    /// Before the first byte.
    pub const fn new() -> Self {
        Deframer { stuffing: DecoderState::Idle, body: [0; BODY_MAX], len: 0 }
    }

    /// Takes a byte; answers the frame it ends, whose checksum is the caller's to judge by its salt.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame<'_>, FramingError>> {
        match self.stuffing.feed(byte) {
            Ok(DecodeResult::NoData) => None,
            Ok(DecodeResult::DataStart) => {
                self.len = 0;
                None
            }
            Ok(DecodeResult::DataContinue(byte)) => {
                if let Some(place) = self.body.get_mut(self.len) {
                    *place = byte;
                }
                self.len = self.len.saturating_add(1);
                None
            }
            Ok(DecodeResult::DataComplete) => Some(self.ended()),
            Err(_) => Some(Err(FramingError::Cut)),
        }
    }

    fn ended(&self) -> Result<Frame<'_>, FramingError> {
        let body = self.body.get(..self.len).ok_or(FramingError::TooLong)?;
        parse(body).ok_or(FramingError::TooShort)
    }
}
