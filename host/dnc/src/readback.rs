//! Comparison of a program that a control sends back from its memory (punches) with the program that was sent to it.
//!
//! Changes that a control may make when it stores a program are ignored: blanks outside comments, empty blocks, CR,
//! NUL, the text before the first `%` line and behind the last, `:` or `O`, and leading zeros of the program's number.

use super::transmission::Transmission;

const LF: u8 = b'\n';
const DC4: u8 = 0x14;
/// Byte that stands in the text for a received character which the control's code does not have.
pub const DAMAGED: u8 = 0xFF;

/// Program that a control sends back from its memory, collected as it arrives and decoded into ASCII.
#[derive(Clone, Debug)]
pub struct ReadBack {
    decode: [u8; 256],
    text: Vec<u8>,
    is_over: bool,
}

/// First difference between the program read back and the program sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Line of the program's file, counted from 1; if the control has more blocks than were sent, the line of the last
    /// block sent.
    pub line: usize,
    /// Column in the line as it was sent, counted from 1.
    pub column: usize,
    /// Text of the block as it was sent; `None` if the control has more blocks than were sent.
    pub sent: Option<String>,
    /// Text of the block as it was received; `None` if the control's program ends before it.
    pub received: Option<String>,
}

impl ReadBack {
    /// Empty text. `encode` gives the control's code for an ASCII character; it is inverted here.
    pub fn new(encode: fn(u8) -> Option<u8>) -> Self {
        let mut decode = [DAMAGED; 256];
        for byte in 0..0x80_u8 {
            if let Some(frame) = encode(byte) {
                decode[usize::from(frame)] = byte;
            }
        }
        ReadBack { decode, text: Vec::new(), is_over: false }
    }

    /// Appends received characters; returns true once the program's end (`%` or DC4) has arrived.
    pub fn take(&mut self, frames: &[u8]) -> bool {
        for frame in frames {
            // DC1 to DC4 may come with their parity bit or without, whatever the code.
            let byte = match frame & 0x7F {
                DC4 if self.has_begun() => {
                    self.is_over = true;
                    continue;
                }
                0x11..=0x14 => continue,
                _ => self.decode[usize::from(*frame)],
            };
            if matches!(byte, 0 | b'\r' | 0x7F) || self.is_over {
                continue;
            }
            self.is_over = byte == b'%' && self.has_begun() && self.text.last() == Some(&LF);
            self.text.push(byte);
        }
        self.is_over
    }

    /// Whether at least one block has been received.
    pub fn has_begun(&self) -> bool {
        self.blocks().next().is_some()
    }

    /// Text received so far in ASCII, without DC1 to DC4, CR and NUL.
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    fn blocks(&self) -> impl Iterator<Item = &[u8]> {
        // The text before the first end of block is the label.
        let lines = self.text.split(|byte| *byte == LF).skip(1);
        lines.filter(|line| !line.starts_with(b"%") && !bare(line).is_empty())
    }

    /// Compares the received program with the one sent; returns the number of blocks, which are then all equal.
    ///
    /// # Errors
    /// The first block that differs, is missing, or was never sent.
    pub fn compare(&self, sent: &Transmission) -> Result<usize, Box<Difference>> {
        let is_code = |index: &usize| sent.is_block(*index) && !bare(line_of(sent, *index)).is_empty();
        let mut wanted = (1..sent.lines().len()).filter(is_code);
        let (mut found, mut count, mut line) = (self.blocks(), 0, 1);
        loop {
            let (index, block) = (wanted.next(), found.next());
            let text = index.map(|index| line_of(sent, index));
            line = index.map_or(line, |index| sent.lines()[index].source);
            let column = match (text, block) {
                (None, None) => return Ok(count),
                (Some(text), Some(block)) => first_difference(text, block),
                (Some(_), None) | (None, Some(_)) => Some(1),
            };
            if let Some(column) = column {
                let shown = |text: &[u8]| text.trim_ascii_end().escape_ascii().to_string();
                return Err(Box::new(Difference { line, column, sent: text.map(shown), received: block.map(shown) }));
            }
            count += 1;
        }
    }
}

fn line_of(sent: &Transmission, index: usize) -> &[u8] {
    let text = sent.line_text(index).unwrap_or_default();
    text.strip_suffix(b"\n").unwrap_or(text)
}

/// Significant characters, each with its column.
fn bare(text: &[u8]) -> Vec<(usize, u8)> {
    let (mut in_comment, mut kept) = (false, Vec::new());
    for (at, &byte) in text.iter().enumerate() {
        in_comment |= byte == b'(';
        if in_comment || !matches!(byte, b' ' | b'\t' | b'\r' | 0) {
            kept.push((at + 1, byte));
        }
        in_comment &= byte != b')';
    }
    // A program's number.
    if let Some((_, first)) = kept.first_mut().filter(|(_, byte)| *byte == b':') {
        *first = b'O';
    }
    if kept.first().is_some_and(|(_, byte)| *byte == b'O') {
        while kept.get(1).is_some_and(|(_, byte)| *byte == b'0')
            && kept.get(2).is_some_and(|(_, byte)| byte.is_ascii_digit())
        {
            kept.remove(1);
        }
    }
    kept
}

/// Column of the sent text at which the control has something else.
fn first_difference(sent: &[u8], received: &[u8]) -> Option<usize> {
    let (ours, theirs) = (bare(sent), bare(received));
    let behind = ours.last().map_or(1, |(column, _)| column + 1);
    (0..ours.len().max(theirs.len())).find_map(|at| {
        let is_same = ours.get(at).map(|(_, byte)| byte) == theirs.get(at).map(|(_, byte)| byte);
        (!is_same).then(|| ours.get(at).map_or(behind, |(column, _)| *column))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transmission::Wire;

    const SENT: &str = "%\nO0012 (A PART)\nN1 G1 X1.5 F100.\n\nM30\n%\n";

    fn compare(received: &[u8]) -> Result<usize, (usize, usize)> {
        let wire = Wire { encode: Some, filters: false, tv_check: false };
        let source = |at: usize| 1 + SENT.as_bytes()[..at].iter().filter(|byte| **byte == LF).count();
        let sent = Transmission::new(SENT.as_bytes(), source, &wire).unwrap();
        let mut back = ReadBack::new(Some);
        back.take(received);
        back.compare(&sent).map_err(|found| (found.line, found.column))
    }

    #[test]
    fn what_a_control_changes_when_it_stores_a_program_counts_for_nothing() {
        for received in [
            SENT.as_bytes(),
            b"\x12%\r\n\r\r:0012(A PART)\r\nN1G1X1.5F100.\nM30\n%\n\x14",
            b"\0\0%\nO12(A PART)\nN1G1X1.5F100.\nM30\n%",
        ] {
            assert_eq!(compare(received), Ok(3), "{}", received.escape_ascii());
        }
    }

    #[test]
    fn the_first_difference_is_reported_with_its_place_in_what_was_sent() {
        for (received, place) in [
            ("%\nO12(A PART)\nN1G1X1.6F100.\nM30\n%\n", (3, 10)),
            ("%\nO12(A PART)\nN1G1X1.5F100\nM30\n%\n", (3, 16)),
            ("%\nO12(A PART)\nN1G1X1.5F100.M8\nM30\n%\n", (3, 17)),
            ("%\nO12(A  PART)\nN1G1X1.5F100.\nM30\n%\n", (2, 10)),
            ("%\nO12(A PART)\nM30\n%\n", (3, 1)),
            ("%\nO12(A PART)\nN1G1X1.5F100.\n%\n", (5, 1)),
            ("%\nO12(A PART)\nN1G1X1.5F100.\nM30\nM30\n%\n", (5, 1)),
            ("%\nO120(A PART)\nN1G1X1.5F100.\nM30\n%\n", (2, 7)),
        ] {
            assert_eq!(compare(received.as_bytes()), Err(place), "{received}");
        }
    }

    #[test]
    fn a_character_that_is_none_is_a_difference() {
        let even = |byte: u8| byte.is_ascii().then(|| byte | if byte.count_ones() % 2 == 1 { 0x80 } else { 0 });
        let mut back = ReadBack::new(even);
        let frames: Vec<u8> = b"%\nM30\n".iter().filter_map(|byte| even(*byte)).collect();
        assert!(!back.take(&frames) && back.has_begun());
        back.take(&[b'M' | 0x80]);
        assert_eq!(back.text().last(), Some(&DAMAGED));
        assert!(back.take(&[LF, 0x14]), "DC4 ends it");
    }
}
