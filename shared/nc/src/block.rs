//! Parser of a line of NC text into a block: its words and their columns.
//!
//! Lenient reading accepts common deviations that a control may reject: a CAM title after `O`, characters outside the
//! control's code in a comment, small letters, and `;` after the code. It reports them as [`Notice`]s. Strict reading
//! raises the alarm instead.

use heapless::Vec;

pub use super::settings::Reading;

use super::alarm::{Alarm, Fault, NotModelled};
use super::number::{POWERS_OF_TEN, is_ignored};
use super::settings::Settings;
use super::word::{
    CHAMFER, LINE_MAX, Piece, ROUNDING, Token, Tolerated, Word, Words, column, is_control_character, is_mark,
    plain_word,
};

/// Maximum number of words in a block.
pub const WORDS_MAX: usize = 32;
/// Maximum number of notices kept for a line.
pub const NOTICES_MAX: usize = 4;

/// Kind of a line of NC text: block, title, or `%` mark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineKind {
    /// A line with `%`, which begins or ends a program's transmission.
    ProgramMark,
    /// A CAM title (`O` without a number), which the control does not execute. Lenient reading only.
    Title,
    /// Any other line, including an empty line and a line with only a comment.
    #[default]
    Block,
}

/// The words of one block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    /// Sequence number (N word); `None` without one.
    pub sequence: Option<i64>,
    /// Program number (O word), if it is the first word; otherwise `None`.
    pub program: Option<i64>,
    /// Number of the block-delete switch that a `/` names (1 to 9); `None` without a `/`.
    pub delete: Option<u8>,
    /// Number of words before the `/`. If the switch is on, only these are executed.
    pub delete_from: usize,
    /// All words but `N` and `O`, in the order written.
    pub words: Vec<Word, WORDS_MAX>,
    /// Whether the block sets a macro variable.
    pub assigns: bool,
    /// Byte offset of the end of the last word, where another word may be added.
    pub code_len: usize,
    /// Letters that may be present: bit n for the n-th letter.
    letters: u32,
}

/// Deviation in the text of a line that lenient reading accepts and a control might reject.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Kind of the deviation.
    pub kind: NoticeKind,
    /// Column of its first character, counted from 1.
    pub column: u16,
}

/// Kind of a deviation that lenient reading accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeKind {
    /// A title in place of a program number: the control raises PS0005.
    Title,
    /// A character in a comment that the control's code does not have (the first one): the control raises PS0001.
    CommentCharacter(u8),
    /// Small letters in code, read as capitals: some controls skip them and read another block, others raise PS0001.
    SmallLetter,
    /// A blank among the digits of a number, which the control ignores.
    Blank,
    /// A `;` after the code, as the control's screen shows the end of a block: the control raises PS0001.
    EndSign,
    /// A comment without `)`; the control ends it with the block, without an alarm.
    UnclosedComment,
    /// N or O with more digits than the control allows: it raises PS0003.
    LongNumber,
    /// N0 or O0: the control may take either for a program number and raise PS0074.
    Zero,
}

/// A parsed line with its notices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parsed {
    /// Kind of the line: block, title or mark.
    pub line: LineKind,
    /// Block of the line; it has no words if the line is a title or a mark.
    pub block: Block,
    /// Whether the block has a comment.
    pub has_comment: bool,
    /// The first [`NOTICES_MAX`] notices.
    pub notices: Vec<Notice, NOTICES_MAX>,
}

impl Block {
    /// The last word with this letter, which is the one that counts; `None` without one.
    pub fn word(&self, letter: u8) -> Option<&Word> {
        if !self.may_have(letters(&[letter])) {
            return None;
        }
        self.words.iter().rev().find(|word| word.letter == letter)
    }

    /// Whether any of these [`letters`] may stand among the words.
    pub(super) const fn may_have(&self, letters: u32) -> bool {
        self.letters & letters != 0
    }

    /// Checks the sequence number N and the program number O against the control's limits; `text` is the line. A
    /// violation is a notice in lenient reading, an alarm in strict reading.
    ///
    /// # Errors
    /// PS0003 (too many digits) or PS0074 (zero), in strict reading.
    #[inline]
    pub fn check_numbers(&self, text: &[u8], settings: &Settings) -> Result<Option<Notice>, Fault> {
        let is_usual = |number: Option<i64>, digits: u8| {
            let limit = POWERS_OF_TEN.get(usize::from(digits)).copied().unwrap_or(i32::MAX);
            number.is_none_or(|number| (1..i64::from(limit)).contains(&number))
        };
        if is_usual(self.sequence, settings.sequence_digits) && is_usual(self.program, settings.program_digits) {
            return Ok(None);
        }
        self.check_unusual_numbers(text, settings)
    }

    #[cold]
    fn check_unusual_numbers(&self, text: &[u8], settings: &Settings) -> Result<Option<Notice>, Fault> {
        let numbers = [(self.sequence, settings.sequence_digits, "N"), (self.program, settings.program_digits, "O:")];
        for (number, digits, letters) in numbers {
            let Some(value) = number else { continue };
            let (kind, alarm) = match value {
                0 => (NoticeKind::Zero, Alarm::ProgramNumber),
                _ if value >= 10_i64.pow(u32::from(digits)) => (NoticeKind::LongNumber, Alarm::TooManyDigits),
                _ => continue,
            };
            let column = column(text.iter().position(|byte| letters.as_bytes().contains(byte)).unwrap_or(0));
            return match settings.reading {
                Reading::Strict => Err(Fault::alarm(alarm, column)),
                Reading::Lenient => Ok(Some(Notice { kind, column })),
            };
        }
        Ok(None)
    }

    /// Whether the block has no words except N and O and sets no variable, so that the control does nothing.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty() && !self.assigns
    }
}

/// Parses one line, which must not contain its line end.
///
/// # Errors
/// The first fault of the line, at which a control would stop.
pub fn parse_line(text: &[u8], reading: Reading) -> Result<Parsed, Fault> {
    let mut parsed = Parsed::default();
    parsed.read(text, reading)?;
    Ok(parsed)
}

impl Parsed {
    /// Parses a line into this existing one, as [`parse_line`] does, but without clearing the capacity of a block.
    /// After a fault the contents are meaningless.
    ///
    /// # Errors
    /// As [`parse_line`].
    pub fn read(&mut self, text: &[u8], reading: Reading) -> Result<(), Fault> {
        if text.len() > LINE_MAX {
            return Err(Fault::not_modelled(NotModelled::LongBlock, u16::MAX));
        }
        let mut words = Words::new(text);
        let result = self.read_words(text, reading, &mut words);
        match result {
            Err(fault) => self.read_again(text, reading, fault),
            Ok(()) => Ok(()),
        }
    }

    /// Reads a line again that has a fault: as one with blanks inside words, and in lenient reading with small letters.
    /// Of both faults the one farther on is the line's.
    #[cold]
    fn read_again(&mut self, text: &[u8], reading: Reading, fault: Fault) -> Result<(), Fault> {
        let mut words = Words::tolerant(text, reading == Reading::Lenient);
        let again = self.read_words(text, reading, &mut words);
        again.map_err(|again| if again.column > fault.column { again } else { fault })?;
        let Tolerated { small_letter, blank, end_sign } = words.tolerated();
        let found =
            [(small_letter, NoticeKind::SmallLetter), (blank, NoticeKind::Blank), (end_sign, NoticeKind::EndSign)];
        for (column, kind) in found.into_iter().filter(|(column, _)| *column > 0) {
            push(&mut self.notices, kind, column);
        }
        Ok(())
    }

    fn read_words(&mut self, text: &[u8], reading: Reading, words: &mut Words<'_>) -> Result<(), Fault> {
        let Parsed { line, block, has_comment, notices } = self;
        *has_comment = false;
        notices.clear();
        block.clear();
        if reading == Reading::Lenient && is_title(text) {
            push(notices, NoticeKind::Title, 1);
            *line = LineKind::Title;
            return Ok(());
        }
        *line = LineKind::Block;
        loop {
            if !words.is_tolerant() {
                let mut at = words.offset();
                while let Some((word, end)) = plain_word(text, at) {
                    if !block.push(word) && !block.begin(word) {
                        break;
                    }
                    (at, block.code_len) = (end, end);
                }
                if at == text.len() {
                    return Ok(());
                }
                words.skip_to(at);
            }
            let Some(piece) = words.next() else { return Ok(()) };
            let Piece { token, start, end } = piece?;
            match token {
                Token::ProgramMark if is_mark(text) && block.is_empty() => {
                    *line = LineKind::ProgramMark;
                    return Ok(());
                }
                Token::ProgramMark => return Err(Fault::alarm(Alarm::IllegalAddress, column(start))),
                Token::Comment { text: body, closed } => {
                    *has_comment = true;
                    check_comment(body, start + 1, reading, notices)?;
                    if !closed {
                        push(notices, NoticeKind::UnclosedComment, column(start));
                    }
                    continue;
                }
                Token::BlockDelete(switch) => {
                    block.delete = Some(switch);
                    block.delete_from = block.words.len();
                }
                Token::Assignment { .. } => block.assigns = true,
                Token::Word(word) => block.add(word)?,
            }
            block.code_len = end;
        }
    }
}

impl Block {
    /// Clears field by field: an assignment would write the whole capacity of `words`.
    fn clear(&mut self) {
        let Block { sequence, program, delete, delete_from, words, assigns, code_len, letters } = self;
        (*sequence, *program, *delete, *assigns) = (None, None, None, false);
        (*delete_from, *code_len, *letters) = (0, 0, 0);
        words.clear();
    }

    /// Adds a word. Returns whether it was accepted: the block has room, and its letter is an address other than N and
    /// O.
    #[inline]
    fn push(&mut self, word: Word) -> bool {
        let letter = letters(&[word.letter]) & ADDRESSES;
        self.letters |= letter;
        letter != 0 && self.words.push(word).is_ok()
    }

    /// Sets the block's number if the word is a plain N word at its beginning. Returns whether it is.
    #[inline]
    fn begin(&mut self, word: Word) -> bool {
        let is_number = word.letter == b'N' && self.words.is_empty() && !word.number.has_point();
        match word.number.as_whole() {
            Some(value @ 0..) if is_number => self.sequence = Some(value),
            _ => return false,
        }
        true
    }

    fn add(&mut self, word: Word) -> Result<(), Fault> {
        let whole = || match word.number.as_whole() {
            Some(value) if value < 0 => Err(Fault::alarm(Alarm::MinusSign, word.column + 1)),
            Some(value) if !word.number.has_point() => Ok(value),
            Some(_) | None => Err(Fault::alarm(Alarm::DecimalPoint, word.column)),
        };
        let is_first = || self.words.is_empty() && self.sequence.is_none() && self.program.is_none();
        match word.letter {
            b'N' if self.words.is_empty() => self.sequence = Some(whole()?),
            b'O' if is_first() => self.program = Some(whole()?),
            letter if letters(&[letter]) & ADDRESSES == 0 => {
                return Err(Fault::alarm(Alarm::IllegalAddress, word.column));
            }
            _ if self.push(word) => {}
            _ => return Err(Fault::not_modelled(NotModelled::LongBlock, word.column)),
        }
        Ok(())
    }
}

/// All letters except E, N, O, U, V and W.
const ADDRESSES: u32 = letters(b"ABCDFGHIJKLMPQRSTXYZ") | CORNERS;
/// Letters of chamfers and rounded corners.
pub(super) const CORNERS: u32 = letters(&[CHAMFER, ROUNDING]);

/// Bit set of these letters of words.
pub(super) const fn letters(of: &[u8]) -> u32 {
    match of {
        [letter, others @ ..] => 1 << (*letter & 0x1f) | letters(others),
        [] => 0,
    }
}

/// Whether the line is a CAM title that lenient reading accepts: `O` (or `:`) not followed by a digit, or a name in
/// `<` and `>`.
pub fn is_title(text: &[u8]) -> bool {
    match text {
        [b'O' | b'o' | b':', rest @ ..] => {
            rest.iter().find(|byte| !is_ignored(**byte)).is_some_and(|next| !next.is_ascii_digit())
        }
        [b'<', ..] => true,
        _ => false,
    }
}

/// Checks a comment for characters outside the control's code; its text starts at byte `start` of the line.
fn check_comment(
    body: &[u8],
    start: usize,
    reading: Reading,
    notices: &mut Vec<Notice, NOTICES_MAX>,
) -> Result<(), Fault> {
    for (offset, &byte) in body.iter().enumerate() {
        if is_control_character(byte) {
            continue;
        }
        let column = column(start + offset);
        match reading {
            Reading::Strict => return Err(Fault::alarm(Alarm::Character, column)),
            Reading::Lenient => {
                push(notices, NoticeKind::CommentCharacter(byte), column);
                return Ok(());
            }
        }
    }
    Ok(())
}

/// Adds a notice; notices beyond [`NOTICES_MAX`] are dropped.
fn push(notices: &mut Vec<Notice, NOTICES_MAX>, kind: NoticeKind, column: u16) {
    let _full = notices.push(Notice { kind, column });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(text: &str) -> Block {
        let parsed = parse_line(text.as_bytes(), Reading::Lenient).unwrap();
        assert_eq!(parsed.line, LineKind::Block, "{text}");
        parsed.block
    }

    fn notices(text: &[u8]) -> Vec<Notice, NOTICES_MAX> {
        parse_line(text, Reading::Lenient).unwrap().notices
    }

    #[test]
    fn a_published_block_keeps_every_word_and_its_place() {
        let block = block("N128G94G2X-2.7807Y11.5782I3.8539J-2.1989F25.");
        assert_eq!(block.sequence, Some(128));
        let letters: String = block.words.iter().map(|word| char::from(word.letter)).collect();
        assert_eq!(letters, "GGXYIJF");
        let feed = block.word(b'F').unwrap();
        assert_eq!((feed.column, feed.len), (41, 4));
        assert_eq!(block.code_len, 44);
    }

    #[test]
    fn a_comment_is_no_code() {
        let commented = block("N10G1X1. (ROUGH) (AND MORE");
        assert_eq!(commented.code_len, 8);
        assert!(block("(=====)").is_empty());
        let has_comment = |text: &str| parse_line(text.as_bytes(), Reading::Lenient).unwrap().has_comment;
        assert!(has_comment("G1(A)X1.") && has_comment("(") && has_comment("g1x1.(a)") && !has_comment("N10G1X1."));
        assert!(block("").is_empty());
        assert!(!block("#5204=0").is_empty());
    }

    #[test]
    fn what_lenient_reading_passes_is_an_alarm_in_strict_reading() {
        let title = b"OTH1546 (CATH1546)";
        assert_eq!(notices(title)[0].kind, NoticeKind::Title);
        let fault = parse_line(title, Reading::Strict).unwrap_err();
        assert_eq!(fault, Fault::alarm(Alarm::NoDataAfterAddress, 2));

        let comment = b"N1570 (METTRE L'OUTIL)";
        let notice = Notice { kind: NoticeKind::CommentCharacter(b'\''), column: 16 };
        assert_eq!(notices(comment).as_slice(), [notice]);
        let fault = parse_line(comment, Reading::Strict).unwrap_err();
        assert_eq!(fault, Fault::alarm(Alarm::Character, 16));
    }

    #[test]
    fn small_letters_are_read_as_capitals_and_noticed_once() {
        let text = b"n10 g01x-1.5y2f100. (note)";
        let small = block("n10 g01x-1.5y2f100. (note)");
        let capital = block("N10 G01X-1.5Y2F100. (NOTE)");
        assert_eq!(small, capital);
        let kinds: Vec<_, 4> = notices(text).iter().map(|notice| (notice.kind, notice.column)).collect();
        assert_eq!(kinds.as_slice(), [(NoticeKind::CommentCharacter(b'n'), 22), (NoticeKind::SmallLetter, 1)]);
        assert_eq!(parse_line(b"g1", Reading::Strict), Err(Fault::alarm(Alarm::Character, 1)));
        assert_eq!(block("g0 X1. (Y").words, block("G0 X1. (Y").words);
    }

    #[test]
    fn blanks_inside_words_change_nothing() {
        for (spaced, packed) in [
            ("N 10 G 0 1 X 1 0.5 Y - 3 .", "N10G01X10.5Y-3."),
            ("O 1000", "O1000"),
            ("G1X- 3.Y .5", "G1X-3.Y.5"),
            ("/ 2 M 8", "/2M8"),
        ] {
            for reading in [Reading::Lenient, Reading::Strict] {
                let words = |text: &str| -> Option<Vec<(u8, super::super::number::Number), 9>> {
                    let block = parse_line(text.as_bytes(), reading).ok()?.block;
                    Some(block.words.iter().map(|word| (word.letter, word.number)).collect())
                };
                assert!(words(spaced).is_some(), "{spaced}");
                assert_eq!(words(spaced), words(packed), "{spaced}");
            }
        }
        assert_eq!(notices(b"G1X1 0.").as_slice(), [Notice { kind: NoticeKind::Blank, column: 3 }]);
        assert!(notices(b"G 1 X 10.").is_empty());
        let word = block("X1 0.5F 3").words[0];
        assert_eq!((word.column, word.len), (1, 6));
    }

    #[test]
    fn marks_of_editors_and_screens_are_no_code() {
        assert_eq!(parse_line(b"\xef\xbb\xbf%", Reading::Strict).unwrap().line, LineKind::ProgramMark);
        assert_eq!(parse_line(b" %", Reading::Strict).unwrap().line, LineKind::ProgramMark);
        assert_eq!(parse_line(b"\x1a", Reading::Strict).unwrap().block, Block::default());
        assert_eq!(notices(b"G0X1. ; (A)")[0], Notice { kind: NoticeKind::EndSign, column: 7 });
        assert_eq!(parse_line(b"G0X1.;", Reading::Strict), Err(Fault::alarm(Alarm::Character, 6)));
        assert_eq!(parse_line(b"G0X1.;Y2.", Reading::Lenient), Err(Fault::alarm(Alarm::Character, 6)));
    }

    #[test]
    fn an_unclosed_comment_is_noticed_and_no_alarm() {
        let notice = Notice { kind: NoticeKind::UnclosedComment, column: 1 };
        assert_eq!(notices(b"(").as_slice(), [notice]);
        assert!(parse_line(b"(", Reading::Strict).is_ok());
    }

    #[test]
    fn a_program_number_is_a_first_word_only() {
        assert_eq!(block("O1234 (IBR)").program, Some(1234));
        let fault = parse_line(b"N5X-3.6O44", Reading::Lenient).unwrap_err();
        assert_eq!(fault, Fault::alarm(Alarm::IllegalAddress, 8));
    }

    #[test]
    fn a_block_holds_a_bounded_number_of_words() {
        let line = "M1".repeat(WORDS_MAX + 1);
        let fault = parse_line(line.as_bytes(), Reading::Lenient).unwrap_err();
        assert_eq!(fault, Fault::not_modelled(NotModelled::LongBlock, 65));
        let line = " ".repeat(LINE_MAX + 1);
        let fault = parse_line(line.as_bytes(), Reading::Lenient).unwrap_err();
        assert_eq!(fault, Fault::not_modelled(NotModelled::LongBlock, u16::MAX));
    }
}
