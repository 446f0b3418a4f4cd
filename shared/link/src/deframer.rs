//! Deframer: turns received bytes into frames. It removes the stuffing byte by byte, so it needs only one buffer of
//! [`BODY_MAX`] bytes.
//!
//! After lost or corrupted bytes, it resynchronises at the next delimiter. Empty frames are ignored: a sender may add
//! delimiters anywhere.

use cobs::{DecodeResult, DecoderState};

use super::frame::{BODY_MAX, Frame, parse};

/// Reason why the bytes between two delimiters are not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FramingError {
    /// Longer than any frame.
    TooLong,
    /// Shorter than any frame.
    TooShort,
    /// A delimiter stands within a group of bytes whose length the byte stuffing (COBS) has announced.
    Cut,
}

/// Assembles received bytes into frames; holds the frame that is being received.
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
    /// A deframer before the first byte.
    pub const fn new() -> Self {
        Deframer { stuffing: DecoderState::Idle, body: [0; BODY_MAX], len: 0 }
    }

    /// Processes a byte. Returns a frame if the byte completes one. The caller checks the checksum: the frame's salt is
    /// the difference between the received and the computed one, and must be that of the session.
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
