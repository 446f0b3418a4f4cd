//! A line of NC text to words, without allocation.
//!
//! Blanks between and inside words mean nothing to the control, but a number must be in one piece here. A comment
//! that is not closed ends with its line: the end-of-block code cannot be part of a comment.

use super::alarm::{Alarm, Fault, NotModelled};
use super::number::{self, Number};

/// A token and the bytes of the line it takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece<'a> {
    /// What it says.
    pub token: Token<'a>,
    /// Offset of its first byte.
    pub start: usize,
    /// Offset behind its last byte.
    pub end: usize,
}

/// One piece of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Token<'a> {
    /// An address letter and its number.
    Word(Word),
    /// `#variable=number`.
    Assignment {
        /// The variable's number.
        variable: i64,
        /// What it is set to.
        value: Number,
    },
    /// `/` before a block, with the switch it belongs to (1 if none is written).
    BlockDelete(u8),
    /// `(text)`: the text between the brackets.
    Comment {
        /// What stands between the brackets.
        text: &'a [u8],
        /// Whether a `)` ended it.
        closed: bool,
    },
    /// `%`.
    ProgramMark,
}

/// An address letter and its number, with its place in the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// `b'A'..=b'Z'`.
    pub letter: u8,
    /// The number after it.
    pub number: Number,
    /// Column of the letter, counted from 1.
    pub column: u16,
    /// Bytes from the letter to the number's last digit.
    pub len: u16,
}

/// The tokens of one line, which must not contain its line end.
#[derive(Clone, Debug)]
pub struct Words<'a> {
    line: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    /// Starts at the line's first byte.
    pub fn new(line: &'a [u8]) -> Self {
        Words { line, at: 0 }
    }

    #[inline]
    fn rest(&self) -> &'a [u8] {
        self.line.get(self.at..).unwrap_or_default()
    }

    #[inline]
    fn column(&self) -> u16 {
        column(self.at)
    }

    #[cold]
    fn is_at_beginning(&self) -> bool {
        self.line.get(..self.at).unwrap_or_default().iter().all(|byte| is_ignored(*byte))
    }

    #[inline]
    fn number(&mut self) -> Result<Number, Fault> {
        match number::read(self.rest()) {
            Ok((number, len)) => {
                self.at += len;
                Ok(number)
            }
            Err((alarm, offset)) => {
                self.at += offset;
                Err(Fault::alarm(alarm, self.column()))
            }
        }
    }

    fn comment(&mut self) -> Token<'a> {
        let body = self.rest().get(1..).unwrap_or_default();
        match body.iter().position(|&byte| byte == b')') {
            Some(len) => {
                self.at += len + 2;
                Token::Comment { text: body.get(..len).unwrap_or_default(), closed: true }
            }
            None => {
                self.at = self.line.len();
                Token::Comment { text: body, closed: false }
            }
        }
    }

    #[inline]
    fn word(&mut self, letter: u8) -> Result<Token<'a>, Fault> {
        let (column, start) = (self.column(), self.at);
        self.at += 1;
        if matches!(self.rest().first(), Some(b'#' | b'[')) {
            return Err(Fault::not_modelled(NotModelled::Macro, self.column()));
        }
        let number = self.number()?;
        Ok(Token::Word(Word { letter, number, column, len: u16::try_from(self.at - start).unwrap_or(u16::MAX) }))
    }

    fn assignment(&mut self) -> Result<Token<'a>, Fault> {
        let column = self.column();
        self.at += 1;
        let macro_fault = Fault::not_modelled(NotModelled::Macro, column);
        let variable = self.number().map_err(|_| macro_fault)?;
        let variable = variable.as_whole().ok_or(macro_fault)?;
        if self.rest().first() != Some(&b'=') {
            return Err(macro_fault);
        }
        self.at += 1;
        let value = self.number().map_err(|_| macro_fault)?;
        // `#1=2` is whole; `#1=2+3` and `#1=2X` are not what they look like.
        match self.rest().first() {
            None | Some(b'(' | b' ') => Ok(Token::Assignment { variable, value }),
            Some(_) => Err(macro_fault),
        }
    }

    fn block_delete(&mut self) -> Token<'a> {
        self.at += 1;
        match self.rest().first() {
            Some(&digit @ b'1'..=b'9') => {
                self.at += 1;
                Token::BlockDelete(digit - b'0')
            }
            _ => Token::BlockDelete(1),
        }
    }
}

impl<'a> Iterator for Words<'a> {
    /// A token in its place, or the fault that ends the line.
    type Item = Result<Piece<'a>, Fault>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        while self.rest().first().is_some_and(|byte| is_ignored(*byte)) {
            self.at += 1;
        }
        let &byte = self.rest().first()?;
        let start = self.at;
        let token = match byte {
            b'A'..=b'Z' => self.word(byte),
            b':' => self.word(b'O'),
            b'(' => Ok(self.comment()),
            b'#' => self.assignment(),
            b'/' => Ok(self.block_delete()),
            b'%' => {
                self.at += 1;
                Ok(Token::ProgramMark)
            }
            b'0'..=b'9' | b'+' | b'-' | b'.' if self.is_at_beginning() => {
                Err(Fault::alarm(Alarm::AddressNotFound, self.column()))
            }
            b'0'..=b'9' | b'+' | b'-' | b'.' => Err(Fault::alarm(Alarm::IllegalAddress, self.column())),
            _ => Err(Fault::alarm(Alarm::Character, self.column())),
        };
        if token.is_err() {
            self.at = self.line.len();
        }
        Some(token.map(|token| Piece { token, start, end: self.at }))
    }
}

/// The column, counted from 1, of the byte at `offset`.
#[inline]
pub fn column(offset: usize) -> u16 {
    u16::try_from(offset + 1).unwrap_or(u16::MAX)
}

/// Characters that mean nothing between words: blank, and in ISO code NUL, BS, HT, CR and DEL.
#[inline]
const fn is_ignored(byte: u8) -> bool {
    matches!(byte, b' ' | 0 | 8 | b'\t' | b'\r' | 0x7f)
}

/// Whether the control's code (ISO, upper case) has this character; in a comment, the only check there is.
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
        let value = Number::whole(0);
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
