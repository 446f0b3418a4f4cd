//! Lexer of a line of NC text, without allocation.
//!
//! The control ignores blanks between and inside words. The first reading of a line accepts none inside a word; a line
//! that it rejects is read again by [`Words::tolerant`]. An unclosed comment ends with its line: the end-of-block code
//! cannot be part of a comment.

use super::alarm::{Alarm, Fault, NotModelled};
use super::number::{self, Number, is_ignored};

/// Largest length of a line in bytes, because columns are stored in 16 bits.
pub const LINE_MAX: usize = u16::MAX as usize - 1;

/// Byte order mark with which some editors begin a UTF-8 file; not part of the program.
pub const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// One token of a line of NC text, and where it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece<'a> {
    /// The token.
    pub token: Token<'a>,
    /// Offset of its first byte in the line, from 0.
    pub start: usize,
    /// Offset of the byte after its last one.
    pub end: usize,
}

/// Token of a line of NC text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Token<'a> {
    /// An address letter and its number.
    Word(Word),
    /// `#variable=number`.
    Assignment {
        /// The variable's number.
        variable: i64,
        /// Assigned value.
        value: Number,
    },
    /// `/` (block delete), with the number of its switch; 1 if none is written.
    BlockDelete(u8),
    /// `(text)`: the text between the brackets.
    Comment {
        /// Text between the brackets.
        text: &'a [u8],
        /// Whether a `)` ended it.
        closed: bool,
    },
    /// `%`.
    ProgramMark,
}

/// Code that stands for the address `,C` (chamfer) in place of a letter.
pub const CHAMFER: u8 = b'[';
/// Code that stands for the address `,R` (rounded corner) in place of a letter.
pub const ROUNDING: u8 = b']';

/// An address letter and its number, such as `X-3.5`, with its position in the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// The letter, `b'A'..=b'Z'`, or [`CHAMFER`] or [`ROUNDING`].
    pub letter: u8,
    /// The number after it.
    pub number: Number,
    /// Column of the letter, counted from 1.
    pub column: u16,
    /// Number of bytes from the letter to the last digit.
    pub len: u8,
}

/// Deviations that a tolerant reading of a line has accepted: for each kind the column of the first one, 0 if there
/// was none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tolerated {
    /// A small letter in code.
    pub small_letter: u16,
    /// A word with a blank among its digits.
    pub blank: u16,
    /// A `;` after the code, as the screen shows the end of a block.
    pub end_sign: u16,
}

/// Deviations that a reading accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tolerance {
    None,
    Blanks,
    Everything,
}

/// Iterator over the tokens of one line, whose text must not contain its line end.
#[derive(Clone, Debug)]
pub struct Words<'a> {
    line: &'a [u8],
    at: usize,
    tolerance: Tolerance,
    tolerated: Tolerated,
}

impl<'a> Words<'a> {
    /// Tokens of a line, from its first byte; bytes after [`LINE_MAX`] are ignored.
    pub fn new(line: &'a [u8]) -> Self {
        let line = line.get(..LINE_MAX).unwrap_or(line);
        Words { line, at: 0, tolerance: Tolerance::None, tolerated: Tolerated::default() }
    }

    /// Tokens of a line, with blanks inside words accepted and, if `is_lenient`, also small letters and a `;` at the
    /// end of the code.
    pub fn tolerant(line: &'a [u8], is_lenient: bool) -> Self {
        let tolerance = if is_lenient { Tolerance::Everything } else { Tolerance::Blanks };
        Words { tolerance, ..Words::new(line) }
    }

    /// Deviations accepted so far.
    pub fn tolerated(&self) -> Tolerated {
        self.tolerated
    }

    /// Offset of the byte that is read next.
    #[inline]
    pub fn offset(&self) -> usize {
        self.at
    }

    #[inline]
    fn peek(&self) -> Option<u8> {
        self.line.get(self.at).copied()
    }

    /// The next token if it is a word without blanks. Nearly every token is one, and this path needs half the
    /// instructions of [`Words::next`], which reads all tokens. A tolerant reading does not have it: there, a number may
    /// go on behind a blank.
    #[inline]
    pub fn next_word(&mut self) -> Option<Word> {
        if self.is_tolerant() {
            return None;
        }
        let (word, end) = plain_word(self.line, self.at)?;
        self.at = end;
        Some(word)
    }

    /// Whether deviations are accepted.
    #[inline]
    pub(super) fn is_tolerant(&self) -> bool {
        self.tolerance != Tolerance::None
    }

    /// Continues at this offset.
    #[inline]
    pub(super) fn skip_to(&mut self, offset: usize) {
        self.at = offset;
    }

    fn word(&mut self, letter: u8) -> Result<Token<'a>, Fault> {
        let start = self.at - 1;
        if matches!(self.peek(), Some(b'#' | b'[')) {
            return Err(Fault::not_modelled(NotModelled::Macro, column(self.at)));
        }
        let Some(number) = self.number() else {
            let (alarm, offset) = number::number_fault(self.line, self.at);
            return Err(Fault::alarm(alarm, column(offset)));
        };
        let column = (start + 1) as u16;
        let len = u8::try_from(self.at - start).map_err(|_| Fault::not_modelled(NotModelled::LongBlock, column))?;
        Ok(Token::Word(Word { letter, number, column, len }))
    }

    fn number(&mut self) -> Option<Number> {
        if self.is_tolerant() {
            return self.spaced_number();
        }
        let (number, end) = number::read(self.line, self.at)?;
        self.at = end;
        Some(number)
    }

    #[cold]
    fn spaced_number(&mut self) -> Option<Number> {
        let before = self.at;
        let (number, end, has_blank) = number::read_spaced(self.line, self.at)?;
        self.at = end;
        if has_blank {
            note(&mut self.tolerated.blank, before.saturating_sub(1));
        }
        Some(number)
    }

    /// The letter of a word that begins with this byte, if the reading accepts small letters.
    #[cold]
    fn small_letter(&mut self, byte: u8) -> Option<u8> {
        let is_accepted = self.tolerance == Tolerance::Everything && byte.is_ascii_lowercase();
        if is_accepted {
            note(&mut self.tolerated.small_letter, self.at - 1);
        }
        is_accepted.then(|| byte.to_ascii_uppercase())
    }

    /// Whether this byte is a `;` with no code after it, and the reading accepts that.
    #[cold]
    fn is_end_sign(&mut self, byte: u8) -> bool {
        let mut rest = self.line.iter().skip(self.at).filter(|byte| !is_ignored(**byte) && **byte != b';');
        let is_accepted =
            self.tolerance == Tolerance::Everything && byte == b';' && rest.next().is_none_or(|next| *next == b'(');
        if is_accepted {
            note(&mut self.tolerated.end_sign, self.at - 1);
        }
        is_accepted
    }

    /// Reads a comment after its opening bracket.
    fn comment(&mut self) -> Token<'a> {
        let body = self.line.get(self.at..).unwrap_or_default();
        let end = body.iter().position(|&byte| byte == b')');
        let text = body.get(..end.unwrap_or(body.len())).unwrap_or_default();
        self.at += text.len() + usize::from(end.is_some());
        Token::Comment { text, closed: end.is_some() }
    }

    /// Reads an assignment after its `#`.
    fn assignment(&mut self) -> Result<Token<'a>, Fault> {
        let macro_fault = Fault::not_modelled(NotModelled::Macro, column(self.at - 1));
        let variable = self.number().ok_or(macro_fault)?;
        let variable = variable.as_whole().ok_or(macro_fault)?;
        if self.peek() != Some(b'=') {
            return Err(macro_fault);
        }
        self.at += 1;
        let value = self.number().ok_or(macro_fault)?;
        // `#1=2` is complete; `#1=2+3` and `#1=2X` need the macro interpreter.
        match self.peek() {
            None | Some(b'(' | b' ') => Ok(Token::Assignment { variable, value }),
            Some(_) => Err(macro_fault),
        }
    }

    /// Reads a block delete after its slash.
    fn block_delete(&mut self) -> Token<'a> {
        while self.is_tolerant() && self.peek().is_some_and(is_ignored) {
            self.at += 1;
        }
        let Some(digit @ b'1'..=b'9') = self.peek() else { return Token::BlockDelete(1) };
        self.at += 1;
        Token::BlockDelete(digit - b'0')
    }

    /// Reads a chamfer or a rounded corner after its comma, at byte `start`.
    #[cold]
    fn corner(&mut self, start: usize) -> Result<Token<'a>, Fault> {
        let word = match self.next() {
            Some(Ok(Piece { token: Token::Word(word), .. })) => word,
            Some(Err(fault)) => return Err(fault),
            Some(Ok(_)) | None => return Err(Fault::alarm(Alarm::IllegalAddress, column(start))),
        };
        let letter = match word.letter {
            b'C' => CHAMFER,
            b'R' => ROUNDING,
            _ => return Err(Fault::alarm(Alarm::IllegalAddress, column(start))),
        };
        Ok(Token::Word(Word { letter, column: column(start), len: self.at.saturating_sub(start) as u8, ..word }))
    }

    #[cold]
    fn character_alarm(&self, byte: u8, start: usize) -> Alarm {
        let is_at_beginning = || self.line.iter().take(start).all(|byte| is_ignored(*byte));
        match byte {
            b'0'..=b'9' | b'+' | b'-' | b'.' if is_at_beginning() => Alarm::AddressNotFound,
            b'0'..=b'9' | b'+' | b'-' | b'.' | b')' | b'*' | b'=' | b'[' | b']' => Alarm::IllegalAddress,
            _ => Alarm::Character,
        }
    }
}

impl<'a> Iterator for Words<'a> {
    /// A token with its position, or the fault that ends the line.
    type Item = Result<Piece<'a>, Fault>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.at == 0 && self.line.starts_with(BYTE_ORDER_MARK) {
            self.at = BYTE_ORDER_MARK.len();
        }
        while self.peek().is_some_and(is_ignored) {
            self.at += 1;
        }
        let (byte, start) = (self.peek()?, self.at);
        self.at += 1;
        let token = match byte {
            b'A'..=b'Z' => self.word(byte),
            b':' => self.word(b'O'),
            b'(' => Ok(self.comment()),
            b'#' => self.assignment(),
            b'/' => Ok(self.block_delete()),
            b'%' => Ok(Token::ProgramMark),
            b',' => self.corner(start),
            _ => match self.small_letter(byte) {
                Some(letter) => self.word(letter),
                None if self.is_end_sign(byte) => return self.next(),
                None => Err(Fault::alarm(self.character_alarm(byte, start), column(start))),
            },
        };
        if token.is_err() {
            self.at = self.line.len();
        }
        Some(token.map(|token| Piece { token, start, end: self.at }))
    }
}

/// The word at byte `start` of a line of at most [`LINE_MAX`] bytes, and the offset after it; `None` unless a word
/// without blanks is there.
#[inline]
pub(super) fn plain_word(line: &[u8], start: usize) -> Option<(Word, usize)> {
    let letter = line.get(start).copied().filter(u8::is_ascii_uppercase)?;
    let (number, end) = number::read(line, start + 1)?;
    // Both casts fit: the caller limits the column, and the digits of a number limit the length.
    Some((Word { letter, number, column: (start + 1) as u16, len: (end - start) as u8 }, end))
}

/// The column, counted from 1, of the byte at `offset`.
#[inline]
pub fn column(offset: usize) -> u16 {
    u16::try_from(offset + 1).unwrap_or(u16::MAX)
}

/// Whether the line is a `%` mark: nothing but ignored characters stands before the `%`.
pub fn is_mark(line: &[u8]) -> bool {
    let code = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
    code.iter().find(|byte| !is_ignored(**byte)) == Some(&b'%')
}

/// Offset of the first small letter in a line outside of comments; `None` without one.
pub fn small_letter(line: &[u8]) -> Option<usize> {
    let mut in_comment = false;
    line.iter().position(|&byte| {
        in_comment = (in_comment || byte == b'(') && byte != b')';
        !in_comment && byte.is_ascii_lowercase()
    })
}

/// Keeps the column of the first deviation.
fn note(column_of: &mut u16, offset: usize) {
    if *column_of == 0 {
        *column_of = column(offset);
    }
}

/// Whether the control's code (ISO, upper case only) has this character. Comments are checked for nothing else.
///
/// Source: the TH alarm's character list (lower case and `! " $ & ' ; < > ? @ \ ^ _ { | }` are refused).
pub const fn is_control_character(byte: u8) -> bool {
    matches!(byte, b'A'..=b'Z' | b'0'..=b'9' | b' ' | b'\t' | b'#' | b'%' | b'(' | b')' | b'*' | b'+' | b',' | b'-'
        | b'.' | b'/' | b':' | b'=' | b'[' | b']')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn letters(line: &str) -> String {
        Words::new(line.as_bytes())
            .map(|token| match token.unwrap().token {
                Token::Word(word) => char::from(word.letter),
                Token::Assignment { .. } => '#',
                Token::BlockDelete(_) => '/',
                Token::Comment { .. } => '(',
                Token::ProgramMark => '%',
            })
            .collect()
    }

    #[test]
    fn words_need_no_blanks_between_them() {
        assert_eq!(letters("N126G93X-3.6044Y10.5358Z-27.2876B103.946F50."), "NGXYZBF");
        assert_eq!(letters("G20G17"), "GG");
        assert_eq!(letters("/2 N10 G1 (NOTE) X1.(NOTE"), "/NG(X(");
    }

    #[test]
    fn an_unclosed_comment_ends_with_its_line() {
        let token = Words::new(b"(=====").next().unwrap().unwrap().token;
        assert_eq!(token, Token::Comment { text: b"=====", closed: false });
    }

    #[test]
    fn a_variable_takes_a_plain_number() {
        let token = Words::new(b"#5204=0").next().unwrap().unwrap().token;
        let (value, _) = number::read(b"0", 0).unwrap();
        assert_eq!(token, Token::Assignment { variable: 5204, value });
        for line in ["#1=#2", "#[1]=0", "#1=2+3", "#1", "X#1", "X[1]"] {
            let fault = Words::new(line.as_bytes()).next().unwrap().unwrap_err();
            assert_eq!(fault.cause, super::super::alarm::Cause::NotModelled(NotModelled::Macro), "{line}");
        }
    }

    #[test]
    fn a_fault_names_its_column_and_ends_the_line() {
        let mut words = Words::new(b"G1X-3.6O44Y1.");
        assert!(words.next().unwrap().is_ok());
        assert!(words.next().unwrap().is_ok());
        // The letter O is read as a word of its own.
        assert!(words.next().unwrap().is_ok());
        let fault = Words::new(b"G1X1.x").nth(2).unwrap().unwrap_err();
        assert_eq!(fault, Fault::alarm(Alarm::Character, 6));
        let mut stopped = Words::new(b"G1X-Y2.");
        assert_eq!(stopped.nth(1), Some(Err(Fault::alarm(Alarm::NoDataAfterAddress, 5))));
        assert_eq!(stopped.next(), None);
    }
}
