//! The image's log in plain words, by the protocol's own decoder: defmt sends the index of a message and its arguments,
//! the message itself stays in the ELF.

use defmt_decoder::{DecodeError, Table};

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
