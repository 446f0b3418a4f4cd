//! The image's log in plain words, by the protocol's own decoder: defmt sends the index of a message and its arguments,
//! the message itself stays in the ELF.

use std::fs;
use std::panic::catch_unwind;

use defmt_decoder::{DecodeError, Table};

use crate::emulator::run;
use crate::images::image;

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

#[test]
fn a_log_that_is_cut_off_or_spoilt_is_not_taken_for_a_whole_one() {
    let (image, log) = (fs::read(image("feedboard")).expect("the image is there"), run("feedboard").console);
    let spoilt = [&log[..], &[1, 0]].concat();
    let is_taken = |log: &[u8]| catch_unwind(|| messages(&image, log)).is_ok();
    assert!(is_taken(&log) && !is_taken(&log[..log.len() - 1]) && !is_taken(&spoilt));
}
