//! The image's log in plain words, by the protocol's own decoder: defmt sends the index of a message and its arguments,
//! the message itself stays in the ELF.

use std::fs;

use defmt_decoder::{DecodeError, Table};

use super::images::image;
use super::qemu::Emulator;

impl Emulator {
    /// Complete log messages of the image since its start.
    ///
    /// # Panics
    /// It is no log.
    pub fn log(&self) -> Vec<String> {
        let console = self.console();
        let whole = console.iter().rposition(|byte| *byte == 0).map_or(0, |end| end + 1);
        if whole == 0 {
            return Vec::new();
        }
        messages(&fs::read(image(self.name())).expect("the image"), &console[..whole])
    }
}

/// Every message of a log, `LEVEL text`; each of its frames must be sound and whole.
pub fn messages(image: &[u8], log: &[u8]) -> Vec<String> {
    let table = Table::parse(image).expect("an image of a version of defmt that the decoder knows");
    let table = table.expect("the image has messages");
    let mut decoder = table.new_stream_decoder();
    decoder.received(log);
    let mut messages = Vec::new();
    loop {
        match decoder.decode() {
            Ok(frame) => {
                let level = frame.level().map_or("-", |level| level.as_str()).to_uppercase();
                messages.push(format!("{level} {}", frame.display_message()));
            }
            // Nothing is left, but for a frame that was cut off.
            Err(DecodeError::UnexpectedEof) => break,
            Err(DecodeError::Malformed) => panic!("a malformed frame after {messages:#?}"),
        }
    }
    assert_eq!(log.last(), Some(&0), "the last frame is cut off");
    messages
}
