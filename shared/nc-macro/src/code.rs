//! Code of a line: its bytes without blanks and comments, each with its column.

use alloc::vec::Vec;

use arcfeed_nc::alarm::{Alarm, Fault};
use arcfeed_nc::macro_alarm::MacroAlarm;
use arcfeed_nc::number::{self, Number};
use arcfeed_nc::word::{BYTE_ORDER_MARK, column};

/// The code of one line without blanks and comments, with the column of each byte.
#[derive(Clone, Debug, Default)]
pub struct MacroCode {
    bytes: Vec<u8>,
    columns: Vec<u16>,
    end: u16,
    /// The text of the first comment: the message of `#3000` and `#3006`.
    pub comment: Vec<u8>,
}

impl MacroCode {
    /// Removes blanks and comments from a line; small letters of the code become capitals. A reader that must reject
    /// small letters checks the line before.
    pub fn new(line: &[u8]) -> Self {
        let mut code = MacroCode { end: column(line.len()), ..MacroCode::default() };
        let (mut in_comment, mut comments) = (false, 0);
        let begin = if line.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        for (at, &byte) in line.iter().enumerate().skip(begin) {
            match byte {
                b'(' if !in_comment => {
                    in_comment = true;
                    comments += 1;
                }
                b')' if in_comment => in_comment = false,
                _ if in_comment && comments == 1 => code.comment.push(byte),
                _ if in_comment => {}
                b' ' | b'\t' | b'\r' | 0x1a => {}
                b';' if is_end(line.get(at + 1..).unwrap_or_default()) => {}
                _ => {
                    code.bytes.push(byte.to_ascii_uppercase());
                    code.columns.push(column(at));
                }
            }
        }
        code
    }

    /// A cursor at the first byte.
    pub fn cursor(&self) -> CodeCursor<'_> {
        CodeCursor { code: self, at: 0 }
    }

    /// All bytes of the code.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// Read position in a line's code.
#[derive(Clone, Copy, Debug)]
pub struct CodeCursor<'a> {
    code: &'a MacroCode,
    at: usize,
}

impl<'a> CodeCursor<'a> {
    /// The bytes of the code that are not read yet.
    pub fn rest(&self) -> &'a [u8] {
        self.code.bytes.get(self.at..).unwrap_or_default()
    }

    /// The next byte of the code; `None` at its end.
    pub fn peek(&self) -> Option<u8> {
        self.rest().first().copied()
    }

    /// Skips `len` bytes.
    pub fn skip(&mut self, len: usize) {
        self.at = self.at.saturating_add(len).min(self.code.bytes.len());
    }

    /// Column of the next byte in the line, counted from 1.
    pub fn column(&self) -> u16 {
        self.code.columns.get(self.at).copied().unwrap_or(self.code.end)
    }

    /// Skips `text` if the code continues with it; returns whether it does.
    pub fn accept(&mut self, text: &[u8]) -> bool {
        let found = self.rest().starts_with(text);
        if found {
            self.skip(text.len());
        }
        found
    }

    /// The capital letters at the cursor; does not skip them.
    pub fn letters(&self) -> &'a [u8] {
        let rest = self.rest();
        let len = rest.iter().position(|byte| !byte.is_ascii_uppercase()).unwrap_or(rest.len());
        rest.get(..len).unwrap_or_default()
    }

    /// Skips a keyword if the code continues with it, in full or shortened to its first two letters; returns whether
    /// it does.
    pub fn accept_keyword(&mut self, keyword: &[u8]) -> bool {
        let letters = self.letters();
        let found = letters == keyword || keyword.get(..2) == Some(letters);
        found && self.accept(letters)
    }

    /// Reads the number of an NC word.
    ///
    /// # Errors
    /// PS0003, PS0005, PS0007 at the offending byte.
    pub fn number(&mut self) -> Result<Number, Fault> {
        let Some((number, end)) = number::read(&self.code.bytes, self.at) else {
            let (alarm, at) = number::number_fault(&self.code.bytes, self.at);
            self.at = at;
            return Err(Fault::alarm(alarm, self.column()));
        };
        self.at = end;
        Ok(number)
    }

    /// Reads an unsigned integer; `None` if there are no digits.
    ///
    /// # Errors
    /// PS0003 for more than eight digits.
    pub fn digits(&mut self) -> Result<Option<u32>, Fault> {
        let column = self.column();
        let rest = self.rest();
        let len = rest.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(rest.len());
        if len > number::DIGITS_MAX {
            return Err(Fault::alarm(Alarm::TooManyDigits, column));
        }
        self.skip(len);
        let digits = rest.get(..len).unwrap_or_default();
        let value = digits.iter().fold(0, |value, digit| value * 10 + u32::from(digit - b'0'));
        Ok((len > 0).then_some(value))
    }

    /// Checks that nothing follows a macro statement.
    ///
    /// # Errors
    /// PS0127 or PS0114 if something follows.
    pub fn finish(&self) -> Result<(), Fault> {
        match self.peek() {
            None => Ok(()),
            Some(b'A'..=b'Z') => Err(self.fault(MacroAlarm::MixedStatements)),
            Some(_) => Err(self.fault(MacroAlarm::ExpressionFormat)),
        }
    }

    /// Reads the number after DO or END, with which the statement ends.
    ///
    /// # Errors
    /// PS0126 for a number other than 1, 2 or 3; and as [`CodeCursor::finish`].
    pub fn loop_number(&mut self) -> Result<(), Fault> {
        let column = self.column();
        let number = self.digits()?;
        self.finish()?;
        if matches!(number, Some(1..=3)) { Ok(()) } else { Err(Fault::in_macro(MacroAlarm::LoopNumber, column)) }
    }

    /// Fault with a macro alarm at the next byte of the code.
    pub fn fault(&self, alarm: MacroAlarm) -> Fault {
        Fault::in_macro(alarm, self.column())
    }
}

/// Whether no code follows a `;`, with which the control's screen ends a block.
fn is_end(rest: &[u8]) -> bool {
    matches!(rest.trim_ascii_start().first(), None | Some(b'(' | b';'))
}

/// Whether these letters are a keyword of a macro statement.
pub fn is_keyword(letters: &[u8]) -> bool {
    const KEYWORDS: [&[u8]; 10] =
        [b"IF", b"GOTO", b"WHILE", b"DO", b"END", b"THEN", b"DPRNT", b"BPRNT", b"POPEN", b"PCLOS"];
    KEYWORDS.contains(&letters)
}

/// Whether these letters are a keyword shortened to two letters.
pub fn is_short_keyword(letters: &[u8]) -> bool {
    const SHORT: [&[u8]; 8] = [b"GO", b"WH", b"EN", b"TH", b"DP", b"BP", b"PO", b"PC"];
    SHORT.contains(&letters)
}

/// Head of a block, before its words: block-delete `/`, sequence number and program number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// Number of the block-delete switch that a leading `/` names; `None` without a `/`.
    pub delete: Option<u32>,
    /// Sequence number (N).
    pub sequence: Option<u32>,
    /// Program number (O, also written `:`).
    pub program: Option<u32>,
}

impl Head {
    /// Reads the head and moves the cursor after it. The reader of the block reports faults of the head.
    pub fn read(cursor: &mut CodeCursor<'_>) -> Self {
        let mut head = Head::default();
        loop {
            let before = *cursor;
            let value = match cursor.peek() {
                Some(letter @ (b'/' | b'N' | b'O' | b':')) => {
                    cursor.skip(1);
                    cursor.digits().ok().flatten().or((letter == b'/').then_some(1))
                }
                _ => return head,
            };
            match (before.peek(), value) {
                (Some(b'/'), Some(_)) if head.delete.is_none() => head.delete = value,
                (Some(b'N'), Some(_)) if head.sequence.is_none() => head.sequence = value,
                (Some(b'O' | b':'), Some(_)) if head.program.is_none() => head.program = value,
                _ => {
                    *cursor = before;
                    return head;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_and_comments_are_no_code_and_columns_stay() {
        let code = MacroCode::new(b"N10 #1 = 2 (A (B) + 3");
        assert_eq!(code.bytes(), b"N10#1=2+3");
        assert_eq!(code.comment, b"A (B");
        let mut cursor = code.cursor();
        assert_eq!(Head::read(&mut cursor).sequence, Some(10));
        assert_eq!((cursor.peek(), cursor.column()), (Some(b'#'), 5));
        cursor.skip(99);
        assert_eq!((cursor.peek(), cursor.column()), (None, 22));
    }

    #[test]
    fn a_head_is_read_as_far_as_it_is_one() {
        let read = |line: &[u8]| {
            let code = MacroCode::new(line);
            let mut cursor = code.cursor();
            let head = Head::read(&mut cursor);
            (head, cursor.rest().to_vec())
        };
        assert_eq!(read(b"/2N5X1").0, Head { delete: Some(2), sequence: Some(5), program: None });
        assert_eq!(read(b"O9010"), (Head { program: Some(9010), ..Head::default() }, Vec::new()));
        assert_eq!(read(b"OTITLE").1, b"OTITLE");
        assert_eq!(read(b"N1N2").1, b"N2");
    }
}
