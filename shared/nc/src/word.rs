//! Lexer of a line of NC text, without allocation.
//!
//! The control ignores blanks between and inside words; this lexer accepts none inside a number. An unclosed comment
//! ends with its line: the end-of-block code cannot be part of a comment.

use super::alarm::{Alarm, Fault, NotModelled};
use super::number::{self, Number};

/// Maximum length of a line in bytes: columns are 16 bits wide.
pub const LINE_MAX: usize = u16::MAX as usize - 1;

/// A token and its bytes in the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece<'a> {
    /// The token.
    pub token: Token<'a>,
    /// Offset of its first byte.
    pub start: usize,
    /// Offset after its last byte.
    pub end: usize,
}

/// Token of a line.
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
    /// `/` before a block, with the number of its switch (1 if none is written).
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

/// An address letter and its number, with its position in the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// `b'A'..=b'Z'`.
    pub letter: u8,
    /// The number after it.
    pub number: Number,
    /// Column of the letter, counted from 1.
    pub column: u16,
    /// Bytes from the letter to the number's last digit.
    pub len: u8,
}

/// The tokens of one line, which must not contain its line end.
#[derive(Clone, Debug)]
pub struct Words<'a> {
    line: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    /// Starts at the line's first byte; bytes after [`LINE_MAX`] are ignored.
    pub fn new(line: &'a [u8]) -> Self {
        Words { line: line.get(..LINE_MAX).unwrap_or(line), at: 0 }
    }

    /// Starts at byte `at` of the line.
    pub(super) fn from(line: &'a [u8], at: usize) -> Self {
        Words { at, ..Words::new(line) }
    }

    /// Offset of the next byte.
    #[inline]
    pub fn offset(&self) -> usize {
        self.at
    }

    #[inline]
    fn peek(&self) -> Option<u8> {
        self.line.get(self.at).copied()
    }

    /// The next token if it is a word without blanks. Nearly every token is, and this path needs half the instructions
    /// of [`Words::next`], which reads all tokens.
    #[inline]
    pub fn next_word(&mut self) -> Option<Word> {
        let (word, end) = plain_word(self.line, self.at)?;
        self.at = end;
        Some(word)
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
        Ok(Token::Word(Word { letter, number, column: (start + 1) as u16, len: (self.at - start) as u8 }))
    }

    fn number(&mut self) -> Option<Number> {
        let (number, end) = number::read(self.line, self.at)?;
        self.at = end;
        Some(number)
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
        let Some(digit @ b'1'..=b'9') = self.peek() else { return Token::BlockDelete(1) };
        self.at += 1;
        Token::BlockDelete(digit - b'0')
    }

    #[cold]
    fn character_alarm(&self, byte: u8, start: usize) -> Alarm {
        let is_at_beginning = || self.line.iter().take(start).all(|byte| is_ignored(*byte));
        match byte {
            b'0'..=b'9' | b'+' | b'-' | b'.' if is_at_beginning() => Alarm::AddressNotFound,
            b'0'..=b'9' | b'+' | b'-' | b'.' => Alarm::IllegalAddress,
            _ => Alarm::Character,
        }
    }
}

impl<'a> Iterator for Words<'a> {
    /// A token with its position, or the fault that ends the line.
    type Item = Result<Piece<'a>, Fault>;

    fn next(&mut self) -> Option<Self::Item> {
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
            _ => Err(Fault::alarm(self.character_alarm(byte, start), column(start))),
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

/// Whether the character is ignored between words: blank, and in ISO code NUL, BS, HT, CR and DEL.
#[inline]
const fn is_ignored(byte: u8) -> bool {
    matches!(byte, b' ' | 0 | 8 | b'\t' | b'\r' | 0x7f)
}

/// Whether the control's code (ISO, upper case) has this character. It is the only check of comments.
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
