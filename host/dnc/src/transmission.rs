//! Text that goes over the line to the control: the program in the control's code, checked completely before the first character leaves.

use std::fmt;

use arcfeed_nc::block::{Parsed, Reading, parse_line};
use arcfeed_nc::text::Lines;
use arcfeed_nc::word::{BYTE_ORDER_MARK, is_control_character};

/// Longest block: one that does not fit the control's buffer is never complete there, and the transmission stops.
const BLOCK_MAX: usize = 256;
/// End mark of DOS.
const END_MARK: u8 = 0x1a;
/// Starts of the lines of a report; programs with macro statements of their own are not sent.
const REPORT: [&str; 3] = ["POPEN", "PCLOS", "DPRNT["];

/// Rules by which program text becomes the characters on the line.
#[derive(Clone, Copy, Debug)]
pub struct Wire {
    /// Gives the control's code for an ASCII character; `None` if the code does not have it.
    pub encode: fn(u8) -> Option<u8>,
    /// Characters in comments that the control's code lacks are replaced by capitals or blanks; otherwise they are faults.
    pub filters: bool,
    /// A blank is added to blocks with an odd number of characters, for a control with its TV check on.
    pub tv_check: bool,
}

/// Program as it is sent over the line, complete or from some line on (restart), with the line of the file for each line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Transmission {
    text: Vec<u8>,
    frames: Vec<u8>,
    lines: Vec<SentLine>,
    changes: Changes,
}

/// Differences between the text that is sent and the program's file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Lines whose code has small letters; sent as capitals.
    pub capitals: Change,
    /// Lines whose comments have characters that the control's code lacks; sent as capitals or blanks.
    pub comments: Change,
    /// Lines with marks that are not sent: the byte order mark at the start, `;` after a block, the end mark of DOS.
    pub left_out: Change,
    /// A `%` line is sent before the program, because its first line is a block, which the control would skip as a label.
    pub has_mark: bool,
}

/// Number of lines with one kind of change, and the first of these lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Change {
    /// Number of lines; 0 if there is no such change.
    pub lines: usize,
    /// First such line of the program's file, counted from 1.
    pub first: usize,
}

impl Changes {
    /// One sentence for each kind of change that occurs.
    pub fn in_words(&self) -> Vec<String> {
        let mark =
            self.has_mark.then(|| "% is sent before the first block, which the control would skip otherwise".into());
        let lines = [
            (self.capitals, "with small letters in code, sent in capitals"),
            (self.comments, "with comments of characters that the code lacks, sent as capitals or blanks"),
            (
                self.left_out,
                "with marks that are not sent: a byte order mark, `;` behind the code, or the end mark of DOS",
            ),
        ];
        let found = lines.into_iter().filter(|(change, _)| change.lines > 0);
        let said = found.map(|(Change { lines, first }, what)| {
            let noun = if lines == 1 { "line" } else { "lines" };
            format!("{lines} {noun} {what} (first: line {first})")
        });
        mark.into_iter().chain(said).collect()
    }
}

impl Change {
    fn add(&mut self, line: usize) {
        self.first = if self.lines == 0 { line } else { self.first };
        self.lines += 1;
    }
}

/// Line of a transmission: where it ends, and the line of the program's file from which it comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SentLine {
    /// Offset in characters of the line's end in the transmission, after its end of block.
    pub end: usize,
    /// Line of the program's file from which it comes, counted from 1; 0 for a line that arcfeed has added.
    pub source: usize,
}

/// Place in a program because of which it cannot be sent, with the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TransmissionFault {
    /// Line of the program's file, counted from 1.
    pub line: usize,
    /// Column, counted from 1; for a line that arcfeed has written, the column in that line.
    pub column: usize,
    /// Fault and remedy.
    pub message: String,
}

impl fmt::Display for TransmissionFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: error: {}", self.line, self.column, self.message)
    }
}

impl Transmission {
    /// Transmission of a whole program; `source` gives the line of the file for the character at an offset in `text`.
    ///
    /// # Errors
    /// Lists every fault because of which the control would not get the program, or would get a different one.
    pub fn new(text: &[u8], source: impl Fn(usize) -> usize, wire: &Wire) -> Result<Self, Vec<TransmissionFault>> {
        let mut sent = Transmission { text: Vec::with_capacity(text.len() + 3), ..Transmission::default() };
        let (mut refusals, mut at) = (Vec::new(), 0);
        if lacks_label(text) {
            sent.changes.has_mark = true;
            sent.add(b"%", b"\n", 0, (wire, &mut refusals));
        }
        for raw in Lines::new(text) {
            let line = source(at);
            at += raw.text.len() + raw.ending.len();
            sent.add(raw.text, raw.ending, line, (wire, &mut refusals));
        }
        refusals.extend(sent.without_end());
        if refusals.is_empty() { Ok(sent) } else { Err(refusals) }
    }

    /// Transmission for a restart: the lines of `preamble`, which arcfeed has written, then this transmission from the line with index
    /// `from` on.
    ///
    /// # Errors
    /// The control's code lacks a character of `preamble`.
    pub fn resumed(&self, preamble: &str, from: usize, wire: &Wire) -> Result<Self, Vec<TransmissionFault>> {
        let mut sent = Transmission { changes: self.changes, ..Transmission::default() };
        let mut refusals = Vec::new();
        for line in preamble.lines() {
            sent.add(line.as_bytes(), b"\n", 0, (wire, &mut refusals));
        }
        if !refusals.is_empty() {
            return Err(refusals);
        }
        let (start, shift) = (self.start_of(from), sent.text.len());
        sent.text.extend_from_slice(&self.text[start..]);
        sent.frames.extend_from_slice(&self.frames[start..]);
        sent.lines.extend(self.lines[from..].iter().map(|line| SentLine { end: line.end - start + shift, ..*line }));
        Ok(sent)
    }

    /// This transmission with lines inserted: each item of `added` is the index of the line after which its text is inserted, in ascending
    /// order. Inserted lines count as parts of the line before them.
    ///
    /// # Errors
    /// The control's code lacks a character of an inserted line.
    pub fn with_lines(&self, added: &[(usize, String)], wire: &Wire) -> Result<Self, Vec<TransmissionFault>> {
        let mut sent = Transmission { changes: self.changes, ..Transmission::default() };
        let (mut refusals, mut added) = (Vec::new(), added.iter().peekable());
        for (index, line) in self.lines.iter().enumerate() {
            let range = self.start_of(index)..line.end;
            sent.text.extend_from_slice(&self.text[range.clone()]);
            sent.frames.extend_from_slice(&self.frames[range]);
            sent.lines.push(SentLine { end: sent.text.len(), ..*line });
            while let Some((_, text)) = added.next_if(|(behind, _)| *behind == index) {
                text.lines().for_each(|text| sent.add(text.as_bytes(), b"\n", line.source, (wire, &mut refusals)));
            }
        }
        if refusals.is_empty() { Ok(sent) } else { Err(refusals) }
    }

    /// Whether the line with this index belongs to an inserted position report, which the interpreter of plain blocks cannot read.
    pub fn is_of_report(&self, index: usize) -> bool {
        let text = self.line_text(index).unwrap_or_default();
        REPORT.iter().any(|begin| text.starts_with(begin.as_bytes()))
    }

    fn add(
        &mut self,
        text: &[u8],
        ending: &[u8],
        source: usize,
        (wire, refusals): (&Wire, &mut Vec<TransmissionFault>),
    ) {
        let start = self.text.len();
        let before = refusals.len();
        let mark = if text.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        let (mut in_comment, mut has_small, mut has_other, mut has_marks) = (false, false, false, false);
        for (index, &byte) in text.iter().enumerate() {
            in_comment |= byte == b'(';
            let kept = match byte {
                _ if fits(byte, wire) => Some(byte),
                b'\r' | 0 => None,
                _ if index < mark || is_mark_behind_code(&text[index..], in_comment) => {
                    has_marks = true;
                    None
                }
                _ if in_comment && wire.filters && !is_line_code(byte) => {
                    has_other = true;
                    let upper = byte.to_ascii_uppercase();
                    Some(if fits(upper, wire) { upper } else { b' ' })
                }
                _ if !in_comment && byte.is_ascii_lowercase() => {
                    has_small = true;
                    Some(byte.to_ascii_uppercase())
                }
                // One message per line is enough.
                _ => {
                    if refusals.len() == before {
                        refusals.push(refused_character(source, index + 1, byte));
                    }
                    None
                }
            };
            self.text.extend(kept);
            in_comment &= byte != b')';
        }
        for (is_changed, change) in [
            (has_small, &mut self.changes.capitals),
            (has_other, &mut self.changes.comments),
            (has_marks, &mut self.changes.left_out),
        ] {
            if is_changed {
                change.add(source);
            }
        }
        if self.text.len() - start > BLOCK_MAX {
            let message = format!(
                "{} characters in one block: more than {BLOCK_MAX} may not fit the control's buffer, and then nothing goes \
                 on; shorten the comment or split the block",
                self.text.len() - start
            );
            refusals.push(TransmissionFault { line: source, column: BLOCK_MAX + 1, message });
        }
        // A control executes a block at its LF: one without it would never be executed.
        let ending = if ending.contains(&b'\n') { ending } else { b"\n" };
        let ending: Vec<u8> = ending.iter().copied().filter(|byte| (wire.encode)(*byte).is_some()).collect();
        let is_odd = (self.text.len() - start + ending.len()) % 2 == 1;
        if wire.tv_check && is_odd && !text.starts_with(b"%") && !self.lines.is_empty() {
            self.text.push(b' ');
        }
        self.text.extend_from_slice(&ending);
        // Characters that cannot be encoded have been rejected above.
        self.frames.extend(self.text[start..].iter().map(|byte| (wire.encode)(*byte).unwrap_or(*byte)));
        self.lines.push(SentLine { end: self.text.len(), source });
    }

    fn without_end(&self) -> Option<TransmissionFault> {
        let ends = |index: &usize| {
            let text = self.line_text(*index).unwrap_or_default().trim_ascii_end();
            let Ok(parsed) = parse_line(text, Reading::Lenient) else { return false };
            let whole = |word: &arcfeed_nc::word::Word| word.number.as_whole();
            parsed.block.words.iter().any(|word| word.letter == b'M' && matches!(whole(word), Some(2 | 30)))
        };
        let message = "no M02 or M30 anywhere: the control would wait for more; end the program with one";
        let last = self.lines.last().map_or(1, |line| line.source);
        let refusal = TransmissionFault { line: last, column: 1, message: message.into() };
        (!(0..self.lines.len()).any(|index| ends(&index))).then_some(refusal)
    }

    /// Differences between this text and the program's file.
    pub fn changes(&self) -> &Changes {
        &self.changes
    }

    /// Text that is sent, in ASCII; character by character the same as [`Transmission::frames`].
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    /// Characters that go over the line, in the control's code.
    pub fn frames(&self) -> &[u8] {
        &self.frames
    }

    /// Lines of the transmission, in order.
    pub fn lines(&self) -> &[SentLine] {
        &self.lines
    }

    /// Offset of the first character of the line with this index; the end of the text for the index after the last line.
    pub fn start_of(&self, index: usize) -> usize {
        index.checked_sub(1).and_then(|before| self.lines.get(before)).map_or(0, |before| before.end)
    }

    /// Index of the line that contains the character at this offset.
    pub fn line_at(&self, offset: usize) -> usize {
        self.lines.partition_point(|line| line.end <= offset)
    }

    /// Text of the line with this index, with its line end; `None` if there is no such line.
    pub fn line_text(&self, index: usize) -> Option<&[u8]> {
        let line = self.lines.get(index)?;
        self.text.get(self.start_of(index)..line.end)
    }

    /// Whether a control counts the line as a block: all but `%` and empty lines.
    pub fn is_block(&self, index: usize) -> bool {
        let text = self.line_text(index).unwrap_or_default().trim_ascii();
        !text.is_empty() && !text.starts_with(b"%")
    }

    /// Number of blocks among the lines before the line with this index.
    pub fn blocks_before(&self, index: usize) -> usize {
        (0..index.min(self.lines.len())).filter(|line| self.is_block(*line)).count()
    }

    /// Indices of the lines that the control executes as blocks, in order; the first line is never among them.
    pub fn block_lines(&self) -> Vec<usize> {
        (1..self.lines.len()).filter(|line| self.is_block(*line)).collect()
    }

    /// Index of the line of the `count`th block, counted from 1; `None` if there are fewer. The first line does not count, because the
    /// control skips it as a label.
    pub fn line_of_block(&self, count: usize) -> Option<usize> {
        (1..self.lines.len()).filter(|line| self.is_block(*line)).nth(count.checked_sub(1)?)
    }
}

/// The line carries the character and the control knows it.
fn fits(byte: u8, wire: &Wire) -> bool {
    let is_known = is_control_character(byte) || matches!(byte, b' ' | b'\t');
    is_known && (wire.encode)(byte).is_some()
}

/// The control would skip the first block as a label: everything up to the first end of block.
fn lacks_label(text: &[u8]) -> bool {
    let first = Lines::new(text).next().map(|line| line.text).unwrap_or_default();
    let is_nothing = |parsed: Parsed| parsed.block.is_empty() && parsed.block.program.is_none();
    !parse_line(first.trim_ascii_end(), Reading::Lenient).is_ok_and(is_nothing)
}

/// Whether the text begins with the end mark of DOS, or with a `;` that no code follows, as a control's screen shows it.
fn is_mark_behind_code(text: &[u8], in_comment: bool) -> bool {
    match text {
        [END_MARK, ..] => true,
        [b';', rest @ ..] if !in_comment => matches!(rest.trim_ascii_start().first(), None | Some(b'(' | b';')),
        _ => false,
    }
}

/// DC1 to DC4, which the control would take as commands.
fn is_line_code(byte: u8) -> bool {
    matches!(byte, 0x11..=0x14)
}

fn refused_character(line: usize, column: usize, byte: u8) -> TransmissionFault {
    let found = byte.escape_ascii();
    let message = match byte {
        _ if is_line_code(byte) => {
            format!("`{found}` is DC1 to DC4 to the control: it would start or stop the line; remove it")
        }
        _ => format!(
            "`{found}` is not in the control's code: it raises PS0001 or reads something else; write it otherwise (in comments \
             stream does so itself without --keep-comments)"
        ),
    };
    TransmissionFault { line, column, message }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Wire = Wire { encode: Some, filters: false, tv_check: false };

    fn transmission(text: &str, wire: &Wire) -> Result<Transmission, Vec<TransmissionFault>> {
        let line = |offset: usize| 1 + text.as_bytes()[..offset].iter().filter(|byte| **byte == b'\n').count();
        Transmission::new(text.as_bytes(), line, wire)
    }

    fn refusal(text: &str, wire: &Wire) -> (usize, usize) {
        let refusals = transmission(text, wire).unwrap_err();
        assert_eq!(refusals.len(), 1, "{refusals:?}");
        (refusals[0].line, refusals[0].column)
    }

    #[test]
    fn a_plain_program_goes_as_it_is_and_gets_its_last_line_end() {
        let sent = transmission("%\r\nG0X1.\n\nM30\n%", &PLAIN).unwrap();
        assert_eq!(sent.frames(), b"%\r\nG0X1.\n\nM30\n%\n");
        assert_eq!((sent.lines().len(), sent.blocks_before(9)), (5, 2));
        assert_eq!((sent.line_of_block(2), sent.line_at(3), sent.line_at(8)), (Some(3), 1, 1));
    }

    #[test]
    fn what_would_not_arrive_is_refused_with_its_place() {
        for (text, place) in [
            ("%\nG0X1.(Tool)\nM30\n%\n", (2, 8)),
            ("%\n(\u{11})\nM30\n%\n", (2, 2)),
            ("%\nG0X1.;Y2.\nM30\n%\n", (2, 6)),
            ("%\nG0X1.\n%\n", (3, 1)),
        ] {
            let refusals = transmission(text, &PLAIN).unwrap_err();
            assert_eq!((refusals[0].line, refusals[0].column), place, "{text:?}: {refusals:?}");
        }
        let long = format!("%\n({})\nM30\n%\n", "A".repeat(300));
        assert_eq!(refusal(&long, &PLAIN), (2, 257));
    }

    #[test]
    fn a_filter_corrupts_comments_only() {
        let wire = Wire { filters: true, ..PLAIN };
        let sent = transmission("%\n(tool \"4\")G0X1.\nM30\n%\n", &wire).unwrap();
        assert_eq!(sent.line_text(1), Some(b"(TOOL  4 )G0X1.\n".as_slice()));
        assert_eq!(sent.changes().comments, Change { lines: 1, first: 2 });
        assert_eq!(refusal("%\nG0?X1.\nM30\n%\n", &wire), (2, 3));
    }

    #[test]
    fn small_letters_in_code_are_sent_as_capitals() {
        let sent = transmission("%\no1 (A)\nn5g0x1.y-2.5\nm30\n%\n", &PLAIN).unwrap();
        assert_eq!(sent.frames(), b"%\nO1 (A)\nN5G0X1.Y-2.5\nM30\n%\n");
        assert_eq!(sent.changes().capitals, Change { lines: 3, first: 2 });
        assert_eq!(sent.changes().comments, Change::default());
    }

    #[test]
    fn a_program_without_a_mark_gets_one_and_marks_of_editors_stay_behind() {
        let sent = transmission("G0X1.\nM30\n", &PLAIN).unwrap();
        assert_eq!(sent.frames(), b"%\nG0X1.\nM30\n");
        assert_eq!(sent.lines().iter().map(|line| line.source).collect::<Vec<_>>(), [0, 1, 2]);
        assert!(sent.changes().has_mark);
        let sent = transmission("\u{feff}%\nG0X1.;\nY2. ; (A)\nM30\n%\n\u{1a}", &PLAIN).unwrap();
        assert_eq!(sent.frames(), b"%\nG0X1.\nY2.  (A)\nM30\n%\n\n");
        assert_eq!((sent.changes().left_out, sent.changes().has_mark), (Change { lines: 4, first: 1 }, false));
    }

    #[test]
    fn blocks_are_made_even_for_the_tv_check() {
        let sent = transmission("%\nG90\nG1X1.\nM30\n%\n", &Wire { tv_check: true, ..PLAIN }).unwrap();
        assert_eq!(sent.frames(), b"%\nG90\nG1X1.\nM30\n%\n");
        let sent = transmission("%\nG0\nG1X1\nM30\n%\n", &Wire { tv_check: true, ..PLAIN }).unwrap();
        assert_eq!(sent.frames(), b"%\nG0 \nG1X1 \nM30\n%\n");
    }

    #[test]
    fn a_program_with_bare_returns_gets_ends_that_the_control_knows() {
        assert_eq!(transmission("%\rG0X1.\rM30\r%\r", &PLAIN).unwrap().frames(), b"%\nG0X1.\nM30\n%\n");
    }

    #[test]
    fn resumed_it_has_our_blocks_before_the_rest() {
        let wire = PLAIN;
        let sent = transmission("%\nG0X1.\nG1X2.F1.\nM30\n%\n", &wire).unwrap();
        let resumed = sent.resumed("%\nG90\n", 2, &wire).unwrap();
        assert_eq!(resumed.frames(), b"%\nG90\nG1X2.F1.\nM30\n%\n");
        let sources: Vec<usize> = resumed.lines().iter().map(|line| line.source).collect();
        assert_eq!(sources, [0, 0, 3, 4, 5]);
    }
}
