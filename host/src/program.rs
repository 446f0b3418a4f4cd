//! NC program as a file: each line with its bytes, meaning and place.

mod block_delete;

mod move_counts;

mod move_trace;

mod lines;

mod contour_check;

mod summary;

mod expansion;

mod source;

use std::fmt;
use std::path::{Path, PathBuf};

use arcfeed_nc::alarm::{Alarm, Cause, Fault, NotModelled};
use arcfeed_nc::block::{LineKind, Notice, NoticeKind, Reading};
use arcfeed_nc::machining::Machining;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::settings::{Preset, Scope, Settings, Tables};
use arcfeed_nc::text::Lines;
use arcfeed_nc_macro::program::first_macro;
use arcfeed_units::{LengthUnit, Nm};

pub use block_delete::BlockDeleteEffect;
pub use expansion::{Expansion, Folder, RunBounds};
use lines::LineReader;
pub use move_counts::MoveCounts;
pub use move_trace::MoveTrace;
pub use source::{Source, check_line_count, read_bounded};
pub use summary::ProgramSummary;

/// Program, read as a whole.
#[derive(Clone, Debug)]
pub struct Program {
    /// Path of the file.
    pub path: PathBuf,
    /// Lines in order.
    pub lines: Vec<ProgramLine>,
    /// Diagnostics, in order of place.
    pub diagnostics: Vec<Diagnostic>,
    /// Counts of the moves.
    pub moves: MoveCounts,
    /// First line with a macro statement or a call, counted from 1, if there is one.
    pub macro_line: Option<usize>,
    /// State of the control before the first line.
    pub control: Reader,
    /// Moves of a run.
    run: Vec<MoveTrace>,
}

/// Line of a program; the default has no text and no meaning.
#[derive(Clone, Debug, Default)]
pub struct ProgramLine {
    /// Bytes without the line end.
    pub text: Vec<u8>,
    /// Line end as found (see [`arcfeed_nc::text::RawLine`]).
    pub ending: Vec<u8>,
    /// Meaning; `None` if a control would stop here.
    pub meaning: Option<InterpretedLine>,
    /// Origin of the workpiece on the path: that of the work coordinate system in force, shifted by G92.
    pub origin: Pose,
    /// Tool length offset in Z, in machine coordinates.
    pub tool_length: Nm,
    /// G43.4: the coordinates are those of the tool tip in the part, and the machine's axes follow.
    pub follows_tip: bool,
    /// Tool and spindle, as commanded up to this line.
    pub machining: Machining,
    /// Effect of the line with the block-delete switches on, if it differs from that with them off.
    pub skipping: Option<BlockDeleteEffect>,
}

/// Message about a place in the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Severity: whether the program can run in spite of it.
    pub severity: Severity,
    /// Line, counted from 1.
    pub line: usize,
    /// Column, counted from 1.
    pub column: usize,
    /// Column after the last character that it is about.
    pub end_column: usize,
    /// Alarm number of the control, if there is one.
    pub alarm: Option<u16>,
    /// Description, and what to do.
    pub message: String,
    /// Text at that place.
    pub found: String,
}

/// Most bytes of a line that a message shows.
const FOUND_MAX: usize = 400;
const BEHIND_THE_END: &str = "behind the closing %: no control reads this or what follows; remove it";
const START_UNKNOWN: &str = "this arc begins where no block before it has put the tool (no X and Y so far): its shape is unknown, \
                             and it keeps its feed";
const NO_LABEL: &str = "no % before the first block: a control that reads it over a line takes this block for the label \
                        and loses it, without an alarm; begin the program with a line %";

/// Severity of a [`Diagnostic`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The program cannot run.
    Error,
    /// The program can run; a stricter control might reject it.
    Warning,
}

impl ProgramLine {
    /// Sets the state of a control that has executed the line, from `reader`.
    fn set_state(&mut self, reader: &Reader) {
        self.origin = reader.modal().work_origin(reader.tables());
        (self.tool_length, self.follows_tip) = move_trace::tool_of(reader);
        self.machining = reader.modal().machining();
    }

    /// Move of the line, relative to the workpiece's origin; `None` for blocks that make several.
    pub fn segment(&self) -> Option<Segment> {
        let segment = self.meaning.as_ref()?.segment?;
        Some(segment.shifted(Pose::ORIGIN.minus(self.origin)))
    }

    /// Diagnostic for the first line of a program, if a control on a line takes it for the label.
    fn missing_label(&self) -> Option<Diagnostic> {
        let has_code = self.meaning.as_ref().is_none_or(|meaning| !meaning.parsed.block.is_empty());
        has_code.then(|| Diagnostic::of_line(1, &self.text, NO_LABEL))
    }

    /// The control counts the line as a block: anything but `%` and an empty line.
    pub fn is_block(&self) -> bool {
        let is_mark = self.meaning.as_ref().is_some_and(|meaning| meaning.parsed.line == LineKind::ProgramMark);
        !self.text.is_empty() && !is_mark
    }
}

impl Program {
    /// Reads a program file.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn load(path: &Path, unit: LengthUnit, reading: Reading) -> std::io::Result<Self> {
        Ok(Program::parse(path, &std::fs::read(path)?, unit, reading))
    }

    /// Reads a program from bytes, as a 16i in its standard settings would.
    pub fn parse(path: &Path, bytes: &[u8], unit: LengthUnit, reading: Reading) -> Self {
        let settings = Settings::preset(Preset::Fanuc16i, unit, reading);
        let settings = Settings { scope: Scope::Everything, ..settings };
        Program::parse_with(path, bytes, settings, Tables::default())
    }

    /// Reads a program from bytes, as a control with these settings would.
    pub fn parse_with(path: &Path, bytes: &[u8], settings: Settings, tables: Tables) -> Self {
        let mut reader = LineReader::new(settings, tables);
        let mut program = Program::empty(path, first_macro(bytes), reader.control());
        for raw in Lines::new(bytes) {
            let mut line = ProgramLine::default();
            reader.read_into(raw, &mut line, &mut program.diagnostics);
            line.meaning.iter().for_each(|meaning| program.moves.add(meaning));
            program.lines.push(line);
        }
        program
    }

    /// Diagnostic for a first block that a control on a line takes for the label.
    pub fn missing_label(&self) -> Option<Diagnostic> {
        self.lines.first()?.missing_label()
    }

    fn empty(path: &Path, macro_line: Option<usize>, control: &Reader) -> Self {
        let (lines, diagnostics, control) = (Vec::new(), Vec::new(), control.clone());
        Program {
            path: path.to_owned(),
            lines,
            diagnostics,
            moves: MoveCounts::default(),
            macro_line,
            control,
            run: Vec::new(),
        }
    }

    /// The program's bytes.
    pub fn bytes(&self) -> Vec<u8> {
        self.lines.iter().flat_map(|line| line.text.iter().chain(&line.ending)).copied().collect()
    }

    /// A control would stop somewhere in the program.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }
}

/// Reason for which a move that a cut rule matches keeps its programmed feed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedKept {
    /// A function in force there that no law covers.
    Under(NotModelled),
    /// Other reason, in words.
    Because(&'static str),
}

impl Diagnostic {
    fn of_fault(line: usize, text: &[u8], fault: Fault) -> Self {
        let alarm = match fault.cause {
            Cause::Alarm(alarm) => Some(alarm.number()),
            Cause::Macro(alarm) => alarm.number(),
            Cause::NotModelled(_) => None,
        };
        let message = match fault.cause {
            Cause::Alarm(alarm) => alarm.explanation().to_string(),
            Cause::Macro(alarm) => alarm.explanation().to_string(),
            cause @ Cause::NotModelled(_) => cause.to_string(),
        };
        let column = usize::from(fault.column).max(1);
        let place = if fault.column == 0 { text } else { word_at(text, column) };
        let end_column = column + place.len().max(1);
        Diagnostic { severity: Severity::Error, line, column, end_column, alarm, message, found: printable(place) }
    }

    /// Diagnostic for a cutting move without an F so far.
    fn of_missing_feed(line: usize, text: &[u8], reading: Reading) -> Self {
        let mut diagnostic = Diagnostic::of_fault(line, text, Fault::alarm(Alarm::NoFeed, 0));
        if reading == Reading::Lenient {
            diagnostic.severity = Severity::Warning;
            diagnostic.message = "no F before this cutting move: a control fresh from power-on raises PS0011; \
                                  one that remembers a feed moves with that"
                .into();
        }
        diagnostic
    }

    /// Diagnostic for a move that a law should govern but cannot, for the reason `why`.
    pub fn of_feed_kept(line: usize, of: &ProgramLine, why: FeedKept) -> Self {
        let words = of.meaning.iter().flat_map(|meaning| &meaning.parsed.block.words);
        let axis = words.into_iter().find(|word| b"XYZABC".contains(&word.letter));
        let cause = if let FeedKept::Under(under) = why { under } else { NotModelled::MoveUnder(0) };
        let fault = Fault::not_modelled(cause, axis.map_or(0, |word| word.column));
        let mut diagnostic = Diagnostic::of_fault(line, &of.text, fault);
        diagnostic.severity = Severity::Warning;
        diagnostic.message = match why {
            FeedKept::Under(under) => {
                format!("a cut rule matches {under}, but no law describes it: it keeps its programmed feed")
            }
            FeedKept::Because(why) => format!("a cut rule matches this move, but it keeps its programmed feed: {why}"),
        };
        diagnostic
    }

    /// Warning about a line as a whole.
    fn of_line(line: usize, text: &[u8], message: &str) -> Self {
        let (severity, message) = (Severity::Warning, message.into());
        Diagnostic {
            severity,
            line,
            column: 1,
            end_column: text.len() + 1,
            alarm: None,
            message,
            found: printable(text),
        }
    }

    fn of_notice(line: usize, text: &[u8], notice: Notice) -> Self {
        let column = usize::from(notice.column);
        let (alarm, message, place) = match notice.kind {
            NoticeKind::Title => (
                Some(Alarm::NoDataAfterAddress),
                "a title where a program number belongs: a control that takes this line as a block refuses it",
                text,
            ),
            NoticeKind::CommentCharacter(_) => (
                Some(Alarm::Character),
                "a character in a comment that the control's code does not have: some controls refuse it",
                text.get(column - 1..column).unwrap_or_default(),
            ),
            NoticeKind::UnclosedComment => (None, "a comment without ')': it ends with its line", text),
            NoticeKind::LongNumber => (
                Some(Alarm::TooManyDigits),
                "more digits than this control has for N or O: it refuses the line",
                word_at(text, column),
            ),
            NoticeKind::Zero => {
                (Some(Alarm::ProgramNumber), "numbers count from 1: some controls refuse 0", word_at(text, column))
            }
        };
        let end_column = if place.len() == text.len() { text.len() + 1 } else { column + place.len() };
        Diagnostic {
            severity: Severity::Warning,
            line,
            column,
            end_column: end_column.max(column + 1),
            alarm: alarm.map(Alarm::number),
            message: message.into(),
            found: printable(place),
        }
    }
}

impl fmt::Display for Diagnostic {
    /// `line:column: error PS0020: message (found `X1.`)`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        write!(f, "{}:{}: {severity}", self.line, self.column)?;
        if let Some(alarm) = self.alarm {
            write!(f, " PS{alarm:04}")?;
        }
        write!(f, ": {} (found `{}`)", self.message, self.found)
    }
}

/// The line has nothing but blanks and control characters, such as the end mark of DOS.
fn is_blank(text: &[u8]) -> bool {
    text.iter().all(|byte| *byte <= b' ')
}

/// Text from `column` (counted from 1) to before the next address letter; at most a few bytes.
fn word_at(text: &[u8], column: usize) -> &[u8] {
    let rest = text.get(column - 1..).unwrap_or_default();
    let end = rest.iter().skip(1).position(u8::is_ascii_uppercase).map_or(rest.len(), |at| at + 1);
    &rest[..end.min(16)]
}

fn printable(text: &[u8]) -> String {
    let shown = text.get(..FOUND_MAX).unwrap_or(text);
    let end = if shown.len() < text.len() { "..." } else { "" };
    shown.escape_ascii().to_string().replace("\\'", "'").replace("\\\"", "\"") + end
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, reading: Reading) -> Program {
        Program::parse(Path::new("test.nc"), text.as_bytes(), LengthUnit::Inch, reading)
    }

    #[test]
    fn every_byte_of_the_file_is_kept() {
        for text in ["%\nN1G0X1.\r\n(A)\n\n%", "", "\n", "G0X1.\n\r\r%\n\r\r"] {
            assert_eq!(parse(text, Reading::Lenient).bytes(), text.as_bytes());
        }
    }

    #[test]
    fn all_errors_are_found_in_one_pass_each_in_its_place() {
        let program = parse("G1X1.F5.\nG14\nX2.\nG2X1.\nY1..\n", Reading::Lenient);
        let places: Vec<_> = program.diagnostics.iter().map(|found| (found.line, found.column, found.alarm)).collect();
        assert_eq!(places, [(2, 1, Some(10)), (4, 1, Some(22)), (5, 4, Some(7))]);
    }

    #[test]
    fn nothing_behind_the_closing_mark_is_read() {
        let program = parse("%\nG1X1.F5.\n%\n\x1a\nTHE END\nG14\n", Reading::Lenient);
        let places: Vec<_> = program.diagnostics.iter().map(|found| (found.line, found.severity)).collect();
        assert_eq!((places, ProgramSummary::new(&program.lines).blocks), (vec![(5, Severity::Warning)], 1));
        assert_eq!(parse("(LEADER)\nG1X1.F5.\n%\nG14\n", Reading::Lenient).diagnostics.len(), 1);
        assert!(parse("%\nG14\n%\n", Reading::Lenient).has_errors());
    }

    #[test]
    fn a_first_block_without_a_mark_is_lost_on_a_line() {
        for (text, is_lost) in [("G1X1.\n", true), ("%\nG1X1.\n", false), ("\nG1X1.\n", false), ("(A)\nG1\n", false)] {
            assert_eq!(parse(text, Reading::Lenient).missing_label().is_some(), is_lost, "{text}");
        }
    }

    #[test]
    fn a_diagnostic_reads_like_a_compilers() {
        let program = parse("N5G1X-1.O5Y1.F1.\n", Reading::Lenient);
        let text = program.diagnostics[0].to_string();
        assert!(text.starts_with("1:9: error PS0009: "), "{text}");
        assert!(text.ends_with("(found `O5`)"), "{text}");
    }

    #[test]
    fn a_missing_feed_is_a_warning_or_an_alarm() {
        let severity = |reading| parse("G1X1.\n", reading).diagnostics[0].severity;
        assert_eq!(severity(Reading::Lenient), Severity::Warning);
        assert_eq!(severity(Reading::Strict), Severity::Error);
    }
}
