//! `arcfeed board URL log`: a board's log as text. The line carries numbers; the texts are in the image's ELF file.

use crate::console::note;
use std::path::Path;
use std::sync::atomic::Ordering;

use arcfeed_link::message::Message;
use defmt_decoder::{DecodeError, StreamDecoder, Table};

use super::super::outcome::{Failure, file_failure, on_interrupt, say};
use super::connection::BoardConnection;

/// Prints messages until Ctrl-C; `elf` is the image that runs on the board.
///
/// # Errors
/// There is no image, or another one than the board's, or the link is lost.
pub fn run(elf: &Path, connection: &mut BoardConnection) -> Result<(), Failure> {
    let image = std::fs::read(elf).map_err(|error| file_failure(elf, &error))?;
    let path = elf.display();
    let table = Table::parse(&image)
        .map_err(|error| Failure::Input(format!("{path}: no image of a version of defmt that is known: {error}")))?
        .ok_or_else(|| Failure::Input(format!("{path}: has no log messages: not the image of a board?")))?;
    let mut decoder = table.new_stream_decoder();
    let interrupted = on_interrupt();
    while !interrupted.load(Ordering::Relaxed) {
        for message in connection.take_messages()? {
            if let Message::Log(log) = message {
                decoder.received(log.bytes.bytes());
                print(&mut *decoder, &table);
            }
        }
    }
    Ok(())
}

/// Prints complete messages. A frame that began before the connection is incomplete, and no reason to stop.
fn print(decoder: &mut dyn StreamDecoder, table: &Table) {
    loop {
        match decoder.decode() {
            Ok(frame) => {
                let level = frame.level().map_or("-", |level| level.as_str());
                say(format_args!("{level:<5} {}", frame.display_message()));
            }
            Err(DecodeError::Malformed) if table.encoding().can_recover() => {
                note(format_args!("incomplete message: begun before the connection, or the board runs another image"));
            }
            Err(DecodeError::UnexpectedEof | DecodeError::Malformed) => return,
        }
    }
}
