//! Prepared program: the parameters of a job and the moves of one NC file, each with the line that it stands on, for a
//! control that reads the NC file itself and reports the line in execution.
//!
//! ```text
//! byte    what
//! 0..4    "AFPR"
//! 4..8    hash of the schema that the messages are written in
//! 8..12   CRC-32 (ISO-HDLC, that of zlib) of the NC file
//! 12..16  length of the NC file, bytes
//! 16..20  number of moves
//! 20..24  length of all entries, n
//! 24..    entries: line u32, kind u8, bytes of the payload u8, payload
//! 24 + n  CRC-32C over all before, four bytes
//! ```
//! Numbers are little endian. The entries are the messages of a set of parameters, `Begin` to `Commit`, at line 0, then
//! those of the moves, `SegmentArcs` or `SegmentFeed` and `Segment`, at the line of their block, the first of the file being 1. Each line
//! has one move at most, and lines grow. A line that the control executes more than once has none. Source: our own; the
//! messages are those of `docs/protocol.md`.

use heapless::Vec;

use super::field::PAYLOAD_MAX;
use super::table::Message;
use super::{SCHEMA_HASH, codes::RefusalCode};
use crate::frame::{CHECK_LEN, CRC, checksum};

/// Length of the header, bytes.
pub const PREPARED_HEADER_LEN: usize = 24;

const MAGIC: [u8; 4] = *b"AFPR";
const ENTRY_HEADER_LEN: usize = 6;
/// Longest piece that is read at once: header, entry or checksum.
const PIECE_MAX: usize = ENTRY_HEADER_LEN + PAYLOAD_MAX;

/// Header of a prepared program: length and checksum of the NC file that it belongs to, and the size of its contents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PreparedHeader {
    /// CRC-32 (ISO-HDLC) of the NC file.
    pub program_check: u32,
    /// Length of the NC file, bytes.
    pub program_len: u32,
    /// Number of moves.
    pub moves: u32,
    /// Length of all entries, bytes.
    pub entries_len: u32,
}

/// Reason why a prepared program (a job and the moves of one NC file) is rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PreparedError {
    /// It has no valid header, or its lengths contradict each other.
    Form,
    /// It was written for another version of the messages.
    Schema,
    /// Wrong checksum.
    Checksum,
    /// An entry is not a valid message, or must not stand at this place.
    Entry(RefusalCode),
}

impl PreparedHeader {
    /// The header as bytes.
    pub fn encode(&self) -> [u8; PREPARED_HEADER_LEN] {
        let mut bytes = [0; PREPARED_HEADER_LEN];
        let numbers = [SCHEMA_HASH, self.program_check, self.program_len, self.moves, self.entries_len];
        let words = core::iter::once(MAGIC).chain(numbers.map(u32::to_le_bytes));
        bytes.iter_mut().zip(words.flatten()).for_each(|(byte, value)| *byte = value);
        bytes
    }

    fn decode(bytes: &[u8]) -> Result<Self, PreparedError> {
        let word = |at: usize| {
            bytes
                .get(at..)
                .and_then(|rest| rest.first_chunk())
                .map(|word| u32::from_le_bytes(*word))
                .unwrap_or_default()
        };
        if bytes.first_chunk() != Some(&MAGIC) {
            return Err(PreparedError::Form);
        }
        if word(4) != SCHEMA_HASH {
            return Err(PreparedError::Schema);
        }
        Ok(PreparedHeader { program_check: word(8), program_len: word(12), moves: word(16), entries_len: word(20) })
    }
}

/// Passes the bytes of one entry of a prepared program to `emit`: the message, and the line of the NC file (from 1) to
/// which it belongs, 0 for messages of the job.
pub fn write_entry(line: u32, message: &Message, emit: &mut dyn FnMut(&[u8])) {
    let mut payload = [0; PAYLOAD_MAX];
    let length = message.encode(&mut payload).unwrap_or_default();
    emit(&line.to_le_bytes());
    emit(&[message.kind(), length as u8]);
    emit(payload.get(..length).unwrap_or_default());
}

/// Checksum over header and entries, with which a prepared program ends, as bytes.
pub fn seal(header_and_entries: &[u8]) -> [u8; CHECK_LEN] {
    checksum(header_and_entries).to_le_bytes()
}

/// Callback for each entry of a prepared program: line of the NC file, kind of the message, payload of the message. An
/// error rejects the program.
pub type OnEntry<'f> = &'f mut dyn FnMut(u32, u8, &[u8]) -> Result<(), RefusalCode>;

/// Reader of a prepared program that arrives in parts of any length. Keeps its state between calls.
#[derive(Clone)]
pub struct PreparedReader {
    piece: Vec<u8, PIECE_MAX>,
    header: Option<PreparedHeader>,
    /// Bytes of entries that are missing.
    entries_left: u32,
    digest: crc::Digest<'static, u32>,
    result: Result<bool, PreparedError>,
}

impl core::fmt::Debug for PreparedReader {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("PreparedReader").field("header", &self.header).field("result", &self.result).finish()
    }
}

impl Default for PreparedReader {
    fn default() -> Self {
        PreparedReader::new()
    }
}

impl PreparedReader {
    /// A reader before the first byte.
    pub const fn new() -> Self {
        PreparedReader { piece: Vec::new(), header: None, entries_left: 0, digest: CRC.digest(), result: Ok(false) }
    }

    /// The header, once it has been read; `None` before.
    pub fn header(&self) -> Option<&PreparedHeader> {
        self.header.as_ref()
    }

    /// Whether the whole program has arrived and its checksum is right. Until then, entries must not be used.
    ///
    /// # Errors
    /// The first error; everything after it is ignored.
    pub fn result(&self) -> Result<bool, PreparedError> {
        self.result
    }

    /// Reads the next bytes and passes each complete entry to `on_entry`. Returns whether the program is complete.
    /// Bytes after its end are an error.
    ///
    /// # Errors
    /// The first error, as from [`PreparedReader::result`].
    pub fn on_bytes(&mut self, bytes: &[u8], on_entry: OnEntry<'_>) -> Result<bool, PreparedError> {
        for byte in bytes {
            match self.result {
                Ok(false) => self.result = self.on_byte(*byte, on_entry),
                Ok(true) => self.result = Err(PreparedError::Form),
                Err(_) => break,
            }
        }
        self.result
    }

    fn on_byte(&mut self, byte: u8, on_entry: OnEntry<'_>) -> Result<bool, PreparedError> {
        self.piece.push(byte).map_err(|_| PreparedError::Form)?;
        if self.header.is_some() && self.entries_left == 0 {
            return self.seal_byte();
        }
        self.digest.update(&[byte]);
        if self.header.is_none() {
            if self.piece.len() == PREPARED_HEADER_LEN {
                let header = PreparedHeader::decode(&self.piece)?;
                self.entries_left = header.entries_len;
                self.header = Some(header);
                self.piece.clear();
            }
            return Ok(false);
        }
        self.entries_left -= 1;
        let Some((&[l0, l1, l2, l3, kind, length], payload)) = self.piece.split_first_chunk::<ENTRY_HEADER_LEN>()
        else {
            return if self.entries_left == 0 { Err(PreparedError::Form) } else { Ok(false) };
        };
        if payload.len() < usize::from(length) {
            return if self.entries_left == 0 { Err(PreparedError::Form) } else { Ok(false) };
        }
        on_entry(u32::from_le_bytes([l0, l1, l2, l3]), kind, payload).map_err(PreparedError::Entry)?;
        self.piece.clear();
        Ok(false)
    }

    fn seal_byte(&mut self) -> Result<bool, PreparedError> {
        let Ok(sum) = <[u8; CHECK_LEN]>::try_from(&self.piece[..]) else { return Ok(false) };
        let is_right = self.digest.clone().finalize() == u32::from_le_bytes(sum);
        if is_right { Ok(true) } else { Err(PreparedError::Checksum) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::table::{Begin, Clear};

    fn program() -> std::vec::Vec<u8> {
        let mut entries = std::vec::Vec::new();
        write_entry(0, &Begin { set: 1 }.into(), &mut |bytes| entries.extend_from_slice(bytes));
        write_entry(77, &Clear {}.into(), &mut |bytes| entries.extend_from_slice(bytes));
        let entries_len = entries.len() as u32;
        let header = PreparedHeader { program_check: 7, program_len: 8, moves: 0, entries_len };
        let mut bytes = header.encode().to_vec();
        bytes.extend(entries);
        bytes.extend(seal(&bytes));
        bytes
    }

    type Entries = std::vec::Vec<(u32, u8, std::vec::Vec<u8>)>;

    fn read(bytes: &[u8], part: usize) -> (Entries, Result<bool, PreparedError>) {
        let (mut entries, mut reader) = (Entries::new(), PreparedReader::new());
        for part in bytes.chunks(part) {
            let _of_all = reader.on_bytes(part, &mut |line, kind, payload| {
                entries.push((line, kind, payload.to_vec()));
                Ok(())
            });
        }
        (entries, reader.result())
    }

    #[test]
    fn a_program_is_read_in_parts_of_any_length() {
        let bytes = program();
        for part in [1, 2, 3, 5, 8, bytes.len()] {
            let (entries, result) = read(&bytes, part);
            assert_eq!(result, Ok(true));
            assert_eq!(entries, [(0, 0x10, std::vec![1, 0, 0, 0]), (77, 0x21, std::vec![])]);
        }
    }

    #[test]
    fn a_program_with_any_bit_altered_cut_off_or_longer_is_never_complete() {
        let bytes = program();
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut altered = bytes.clone();
                altered[at] ^= 1 << bit;
                assert_ne!(read(&altered, 4).1, Ok(true), "byte {at}, bit {bit}");
            }
            assert_eq!(read(&bytes[..at], 4).1, Ok(false), "{at} bytes");
        }
        assert_eq!(read(&[&bytes[..], &[0]].concat(), 4).1, Err(PreparedError::Form));
    }

    #[test]
    fn an_entry_that_is_refused_rejects_the_program() {
        let mut reader = PreparedReader::new();
        let result = reader.on_bytes(&program(), &mut |_, _, _| Err(RefusalCode::Order));
        assert_eq!(result, Err(PreparedError::Entry(RefusalCode::Order)));
    }
}
