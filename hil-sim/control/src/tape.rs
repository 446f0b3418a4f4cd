//! Decoding of tape characters (frames) into blocks: label skip, code by the first end of block, TH (parity) and TV (count) check.
//!
//! After power-on and reset everything up to the first end of block is skipped: `%` and the leader are there, and a
//! first block without a `%` before it is skipped too. The first end of block also distinguishes ISO from EIA.
//!
//! Sources: TV check, B-63684EN p. 129 (characters after an end of block up to and with the next; comments count, the
//! skipped label does not); label skip as the Mitsubishi M700 describes it (p. 7), Fanuc's manuals only name it.

use arcfeed_nc::alarm::{Alarm, Fault};
use arcfeed_nc::block::is_title;
use arcfeed_nc::word::{column, is_control_character, is_mark, small_letter};

use super::code::{Symbol, TapeCode};

/// Settings for decoding and checking the received tape characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TapeSettings {
    /// Character code; `None` if the first end of block decides between ISO and EIA.
    pub code: Option<TapeCode>,
    /// Whether everything before the first end of block is skipped.
    pub label_skip: bool,
    /// Whether a block with an odd number of characters is alarm PS0002 (parameter 0000, TVC).
    pub tv_check: bool,
    /// Whether characters that ISO 840 does not have (lower case, `! " $ ?` ...) are alarm PS0001, as on some controls;
    /// others ignore them.
    pub strict_characters: bool,
}

impl Default for TapeSettings {
    fn default() -> Self {
        TapeSettings { code: None, label_skip: true, tv_check: false, strict_characters: false }
    }
}

/// One block of tape characters, after decoding and checks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReceivedBlock {
    /// Label: characters before the first end of block, which are skipped.
    Label {
        /// Whether the label contains a `%`, which begins the program.
        has_mark: bool,
    },
    /// Text of a valid block, without its end of block.
    Block(Vec<u8>),
    /// A block that failed a check.
    Refused {
        /// Readable characters of the block.
        text: Vec<u8>,
        /// Fault that the check found.
        fault: Fault,
    },
}

/// Reader of tape code: detects the code, and the label and the end of a program. Keeps its state between calls.
#[derive(Debug)]
pub struct Tape {
    settings: TapeSettings,
    code: Option<TapeCode>,
    skips: bool,
    /// Whether a character other than `%` has followed the label.
    has_begun: bool,
    has_ended: bool,
}

impl Tape {
    /// Reader for the frames of a line.
    pub fn new(settings: TapeSettings) -> Self {
        Tape { settings, code: settings.code, skips: settings.label_skip, has_begun: false, has_ended: false }
    }

    /// Reader for a program in memory, which was checked when it was stored.
    pub fn in_memory() -> Self {
        Tape::new(TapeSettings { code: Some(TapeCode::Ascii), label_skip: false, ..TapeSettings::default() })
    }

    /// Examines a character as it arrives, to find the code and the end of the program; returns whether it ends a block.
    pub fn watch(&mut self, frame: u8) -> bool {
        let Some(code) = self.code else {
            self.code = TapeCode::of_end_of_block(frame);
            return self.code.is_some();
        };
        match code.decode(frame) {
            Ok(Symbol::Character(b'%')) => self.has_ended |= self.has_begun,
            Ok(Symbol::Character(_)) => self.has_begun = true,
            _ => {}
        }
        code.ends_block(frame)
    }

    /// Whether the `%` behind the program has arrived.
    pub fn has_ended(&self) -> bool {
        self.has_ended
    }

    /// Character code; `None` before it is known.
    pub fn code(&self) -> Option<TapeCode> {
        self.code
    }

    /// Decodes and checks the characters of one block, its end of block included.
    pub fn read(&mut self, frames: &[u8]) -> ReceivedBlock {
        let code = self.code.unwrap_or(TapeCode::Ascii);
        let mut text = Vec::with_capacity(frames.len());
        let mut fault = None;
        for frame in frames {
            match code.decode(*frame) {
                Ok(Symbol::Character(byte)) => {
                    if self.settings.strict_characters && !is_control_character(byte) {
                        fault = fault.or(Some(Fault::alarm(Alarm::Character, column(text.len()))));
                    }
                    text.push(byte);
                }
                Ok(Symbol::EndOfBlock | Symbol::Ignored) => {}
                Err(_) => fault = fault.or(Some(Fault::alarm(Alarm::Character, column(text.len())))),
            }
        }
        if std::mem::take(&mut self.skips) {
            return ReceivedBlock::Label { has_mark: text.contains(&b'%') };
        }
        if self.settings.tv_check && frames.len() % 2 == 1 && !text.contains(&b'%') {
            fault = fault.or(Some(Fault::alarm(Alarm::BlockParity, 0)));
        }
        // Some controls skip small letters in code and read another block; this one stops.
        let small = small_letter(&text).filter(|_| !is_title(&text) && !is_mark(&text));
        fault = fault.or(small.map(|offset| Fault::alarm(Alarm::Character, column(offset))));
        match fault {
            None => ReceivedBlock::Block(text),
            Some(fault) => ReceivedBlock::Refused { text, fault },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks that the frames give.
    fn blocks(settings: TapeSettings, frames: &[u8]) -> Vec<ReceivedBlock> {
        let mut tape = Tape::new(settings);
        let mut found = Vec::new();
        let mut block = Vec::new();
        for frame in frames {
            block.push(*frame);
            if tape.watch(*frame) {
                found.push(tape.read(&std::mem::take(&mut block)));
            }
        }
        found
    }

    fn encoded(code: TapeCode, text: &str) -> Vec<u8> {
        text.bytes().map(|byte| code.encode(byte).unwrap()).collect()
    }

    fn block(text: &str) -> ReceivedBlock {
        ReceivedBlock::Block(text.into())
    }

    #[test]
    fn the_first_end_of_block_determines_the_code() {
        for code in [TapeCode::Iso, TapeCode::Eia] {
            let found = blocks(TapeSettings::default(), &encoded(code, "%LEADER\nG1X-1.5\nM30\n"));
            assert_eq!(found, [ReceivedBlock::Label { has_mark: true }, block("G1X-1.5"), block("M30")], "{code:?}");
        }
    }

    #[test]
    fn a_first_block_without_a_mark_before_it_is_skipped() {
        let found = blocks(TapeSettings::default(), &encoded(TapeCode::Iso, "G0Z100.\nG0X0\n"));
        assert_eq!(found, [ReceivedBlock::Label { has_mark: false }, block("G0X0")]);
    }

    #[test]
    fn ascii_without_its_parity_bit_is_a_th_alarm_in_iso() {
        // G, LF and % have even numbers of ones; X (0x58) has three, 1 (0x31) too.
        let found = blocks(TapeSettings::default(), b"%\nGG\nGX1\n");
        assert_eq!(found[1], block("GG"));
        assert_eq!(found[2], ReceivedBlock::Refused { text: b"G".into(), fault: Fault::alarm(Alarm::Character, 2) });
    }

    #[test]
    fn blocks_with_an_odd_number_of_characters_fail_the_tv_check() {
        let settings = TapeSettings { tv_check: true, ..TapeSettings::default() };
        // With its end: the label 3 (not checked), 4, 5, 6 with a comment.
        let found = blocks(settings, &encoded(TapeCode::Iso, "%A\nG00\nG000\n(ABC)\n"));
        let refused = ReceivedBlock::Refused { text: b"G000".into(), fault: Fault::alarm(Alarm::BlockParity, 0) };
        assert_eq!(found, [ReceivedBlock::Label { has_mark: true }, block("G00"), refused, block("(ABC)")]);
    }

    #[test]
    fn characters_that_iso_does_not_have_are_an_alarm_where_the_control_is_strict() {
        let settings = TapeSettings { strict_characters: true, ..TapeSettings::default() };
        for (text, column) in [("(tool 2)", 2), ("(1/2\")", 5), ("G1X1.?", 6)] {
            let frames = encoded(TapeCode::Iso, &format!("%\n{text}\n"));
            let fault = Fault::alarm(Alarm::Character, column);
            assert_eq!(blocks(settings, &frames)[1], ReceivedBlock::Refused { text: text.into(), fault });
            assert_eq!(blocks(TapeSettings::default(), &frames)[1], block(text));
        }
    }

    #[test]
    fn small_letters_in_code_are_an_alarm_and_in_titles_and_comments_none() {
        let read =
            |text: &str| blocks(TapeSettings::default(), &encoded(TapeCode::Iso, &format!("%\n{text}\n")))[1].clone();
        let fault = Fault::alarm(Alarm::Character, 5);
        assert_eq!(read("G1X1f5"), ReceivedBlock::Refused { text: b"G1X1f5".into(), fault });
        for text in ["G1X1(note)", "OPart 1", "%end"] {
            assert_eq!(read(text), block(text));
        }
    }

    #[test]
    fn the_program_ends_with_the_mark_behind_it() {
        let mut tape = Tape::new(TapeSettings::default());
        for frame in encoded(TapeCode::Iso, "\n%\nM30\n") {
            tape.watch(frame);
        }
        assert!(!tape.has_ended());
        tape.watch(TapeCode::Iso.encode(b'%').unwrap());
        assert!(tape.has_ended());
    }
}
