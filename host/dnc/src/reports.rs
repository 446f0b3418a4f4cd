//! Position reports that the control prints during a transmission, if the job requests them (`[dnc] report_every`;
//! needs custom macro B).
//!
//! arcfeed inserts three lines after every so many blocks of the *transmission* (never of the program's file). For a
//! block of line 53 they are:
//!
//! ```text
//! POPEN
//! DPRNT[ARCFEED*L53X#5001[53]Y#5002[53]Z#5003[53]F#4109[53]]          in inches X, Y and Z are [44]
//! PCLOS
//! ```
//! and the control prints `ARCFEED L53X   12.500Y   -1.000Z    5.000F 1000.000` (blanks or none, as its parameters
//! say): the position at the end of the preceding block in the program's coordinates, and the last F. Both are known
//! from the program. A difference shows that the control does not execute what was sent.
//!
//! A control executes macro statements when it *reads* them, not when the blocks before are done (Series 15i-MA,
//! B-63324EN p. 674; the simulated one too). A report therefore says only that the control has read up to this place.
//! At least those blocks are executed that lie further back than the look-ahead of the control. No report is inserted
//! where #5001 differs from the program's position: under G41, G42, cycles, polar coordinates, scaling, rotation,
//! tilted planes, G43.4.

use arcfeed_nc::modal::{Modal, ProgramStop};
use arcfeed_units::LengthUnit;

use super::restored_state::PowerOn;
use super::transmission::{Transmission, TransmissionFault, Wire};

/// Text with which each report begins.
pub const NAME: &str = "ARCFEED";
/// Numbers from here on do not fit the columns.
const VALUE_MAX: f64 = 99_999.0;
/// Longest line that is waited for, and most characters of other text that are kept.
const LINE_MAX: usize = 256;
const PRINTED_MAX: usize = 65_536;

/// Report that is still to come.
#[derive(Clone, Debug, PartialEq)]
struct Expected {
    /// Line of the program's file.
    line: usize,
    /// Index, in the transmission, of the last block that the control has read by then.
    index: usize,
    /// X, Y, Z, F.
    values: [f64; 4],
    /// Tolerance of a printed X, Y or Z: one unit of its last digit.
    tolerance: f64,
}

/// Something wrong with a position report of the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReportFinding {
    /// A report has a wrong line, position or feed: the control does not execute the program that was sent. With the
    /// message.
    Differs(String),
    /// A report is missing or cannot be read, so the blocks before it are unconfirmed. With the message.
    Doubtful(String),
}

/// Position reports that a control prints during a transmission: those that are expected, and a comparison with those
/// that arrive.
#[derive(Clone, Debug, Default)]
pub struct Reports {
    expected: Vec<Expected>,
    /// Number of reports that have been received or missed.
    next: usize,
    heard: usize,
    last: Option<(usize, usize)>,
    line: Vec<u8>,
    printed: Vec<u8>,
}

impl Reports {
    /// Inserts a report after every `every`th block, and one before the program's end, where the control's #5001 to
    /// #5003 are comparable. Returns the transmission with the reports, and the reports to expect.
    ///
    /// # Errors
    /// The control's code lacks a character that a report needs.
    pub fn insert_into(
        sent: &Transmission,
        every: usize,
        control: &PowerOn,
        wire: &Wire,
    ) -> Result<(Transmission, Self), Vec<TransmissionFault>> {
        let (mut reader, mut since, mut feed) = (control.reader(), 0, 0.0);
        let mut added: Vec<(usize, String)> = Vec::new();
        let mut reports = Reports::default();
        for index in 1..sent.lines().len() {
            let text = sent.line_text(index).unwrap_or_default();
            let before = *reader.modal();
            let read = reader.read(text.strip_suffix(b"\n").unwrap_or(text));
            let is_end = read.as_ref().is_ok_and(|read| read.step.stop == Some(ProgramStop::End));
            if is_end && since > 0 && agrees_with_program(&before) {
                reports.expect(sent, (index - 1, &before, feed), &mut added);
            }
            let Some(read) = read.ok().filter(|_| !is_end) else { break };
            feed = read.parsed.block.word(b'F').map_or(feed, |word| word.number.to_f64());
            since += usize::from(sent.is_block(index));
            if since >= every && agrees_with_program(reader.modal()) {
                reports.expect(sent, (index, reader.modal(), feed), &mut added);
                since = 0;
            }
        }
        let whole = sent.with_lines(&added, wire)?;
        // Each report has moved the text behind it by its own three lines.
        for (count, expected) in reports.expected.iter_mut().enumerate() {
            expected.index += 3 * count + 2;
        }
        Ok((whole, reports))
    }

    fn expect(
        &mut self,
        sent: &Transmission,
        (index, modal, feed): (usize, &Modal, f64),
        added: &mut Vec<(usize, String)>,
    ) {
        let [x, y, z] = modal.program.linear.map(|axis| axis.0 as f64 / modal.unit.nm() as f64);
        let values = [x, y, z, feed];
        if values.iter().any(|value| value.abs() >= VALUE_MAX) {
            return;
        }
        let line = sent.lines().get(index).map_or(0, |line| line.source);
        let (format, tolerance) = match modal.unit {
            LengthUnit::Mm => (53, 0.001),
            LengthUnit::Inch => (44, 0.0001),
        };
        let axes: String = ["X#5001", "Y#5002", "Z#5003"].iter().map(|axis| format!("{axis}[{format}]")).collect();
        added.push((index, format!("POPEN\nDPRNT[{NAME}*L{line}{axes}F#4109[53]]\nPCLOS\n")));
        self.expected.push(Expected { line, index, values, tolerance });
    }

    /// Reports of a restarted transmission, which begins with `own_lines` lines of arcfeed and continues with the line
    /// of index `from` of the present transmission. Reports before that line are no longer expected.
    #[must_use]
    pub fn resumed(mut self, from: usize, own_lines: usize) -> Self {
        self.expected.retain(|expected| expected.index >= from);
        for expected in &mut self.expected {
            expected.index = expected.index - from + own_lines;
        }
        self
    }

    /// Reads characters that the control has printed; returns a finding for each report that is wrong, missing or
    /// unreadable.
    pub fn read_printed(&mut self, bytes: &[u8]) -> Vec<ReportFinding> {
        let mut remarks = Vec::new();
        for byte in bytes.iter().map(|byte| byte & 0x7F) {
            if self.line.len() < LINE_MAX {
                self.line.push(byte);
            }
            if byte == b'\n' {
                let line = std::mem::take(&mut self.line);
                remarks.extend(self.read(&line));
            }
        }
        remarks
    }

    fn read(&mut self, line: &[u8]) -> Option<ReportFinding> {
        let text: String = line.iter().filter(|byte| byte.is_ascii_graphic()).map(|byte| char::from(*byte)).collect();
        if self.expected.is_empty() || !text.starts_with(NAME) {
            if self.printed.len() < PRINTED_MAX {
                self.printed.extend_from_slice(line);
            }
            return None;
        }
        let corrupted = || ReportFinding::Doubtful(format!("a report of the control cannot be read: `{text}`"));
        let Some((number, values)) = parse(&text) else { return Some(corrupted()) };
        let rest = self.expected.get(self.next..).unwrap_or_default();
        let Some(ahead) = rest.iter().position(|expected| expected.line == number) else {
            return Some(ReportFinding::Differs(format!(
                "the control reports line {number}, and no such report was to come now"
            )));
        };
        let expected = rest[ahead].clone();
        let missing = self.expected[self.next].line;
        self.next += ahead + 1;
        for (name, found, wanted) in [0, 1, 2, 3].map(|at| (["X", "Y", "Z", "F"][at], values[at], expected.values[at]))
        {
            let tolerance = if name == "F" { 0.001 } else { expected.tolerance };
            if (found - wanted).abs() > 1.01 * tolerance {
                return Some(ReportFinding::Differs(format!(
                    "the control reports {name}{found} behind line {number}, and the program has {name}{wanted} there: what \
                     it reads is not what was sent"
                )));
            }
        }
        self.heard += 1;
        self.last = Some((expected.line, expected.index));
        (ahead > 0).then(|| {
            ReportFinding::Doubtful(format!(
                "no report of line {missing} has come, but that of line {number} says what it should"
            ))
        })
    }

    /// Number of reports inserted in the transmission, and number of those that have arrived with the expected values.
    pub fn counts(&self) -> (usize, usize) {
        (self.expected.len(), self.heard)
    }

    /// Line of the program's file up to which the control has read, by its latest report; `None` before the first.
    pub fn read_up_to(&self) -> Option<usize> {
        self.last.map(|(line, _)| line)
    }

    /// Line of the program's file after which the next expected report stands; `None` if no more are expected.
    pub fn awaited(&self) -> Option<usize> {
        self.expected.get(self.next).map(|expected| expected.line)
    }

    /// Number of blocks that the control must have started at least, by its latest report, if it reads at most
    /// `read_ahead` blocks ahead. `None` if nothing is known: no report yet, or the block of the latest one is closer to the program's begin than
    /// `read_ahead`.
    pub fn taken_up(&self, sent: &Transmission, read_ahead: usize) -> Option<usize> {
        let (_, index) = self.last?;
        Some(sent.blocks_before(index + 1).saturating_sub(read_ahead)).filter(|blocks| *blocks > 0)
    }

    /// Text that the control has printed and that is no report (of the program's own DPRNT, for instance).
    pub fn printed(&self) -> Vec<u8> {
        [self.printed.as_slice(), self.line.as_slice()].concat()
    }
}

/// #5001 to #5003 agree with the program's position.
fn agrees_with_program(modal: &Modal) -> bool {
    modal.compensation.is_none()
        && modal.cycle.is_none()
        && modal.polar.is_none()
        && modal.frame.scaling().is_none()
        && modal.frame.rotation().is_none()
        && modal.unmodelled == 0
        && !modal.follows_tool_center
}

/// Line, X, Y, Z and F of a report without its blanks.
fn parse(text: &str) -> Option<(usize, [f64; 4])> {
    let (line, rest) = text.strip_prefix(NAME)?.strip_prefix('L')?.split_once('X')?;
    let (x, rest) = rest.split_once('Y')?;
    let (y, rest) = rest.split_once('Z')?;
    let (z, f) = rest.split_once('F')?;
    let number = |text: &str| {
        let is_plain = text.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'-'));
        text.parse().ok().filter(|_| is_plain)
    };
    Some((line.parse().ok()?, [number(x)?, number(y)?, number(z)?, number(f)?]))
}

#[cfg(test)]
mod tests;
