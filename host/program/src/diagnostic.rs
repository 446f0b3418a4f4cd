//! Messages about places in a program: alarms with their remedies, and warnings.

use std::fmt;

use arcfeed_nc::alarm::{Alarm, Cause, Fault, NotModelled};
use arcfeed_nc::block::{Notice, NoticeKind, Reading};

use super::ProgramLine;
use super::advice::{FLOW_WORD, advice};

/// Most bytes of a line that a message shows.
const FOUND_MAX: usize = 400;
const BEHIND_THE_END: &str = "behind the closing %: no control reads this or what follows; remove it";
/// A program behind the closing `%`.
const PROGRAM_BEHIND_THE_END: &str = "a program behind the closing %: no control reads it; remove the % before it";
pub(super) const START_UNKNOWN: &str = "this arc begins where no block before it has put the tool (no X and Y so far): its shape is unknown, \
                             and it keeps its feed";
pub(super) const NO_LABEL: &str = "no % before the first block: a control that reads it over a line takes this block for the label \
                        and loses it, without an alarm; begin the program with a line %";

/// Message about a place in the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Severity: whether the program can run in spite of it.
    pub severity: Severity,
    /// Line, counted from 1.
    pub line: usize,
    /// Column, counted from 1.
    pub column: usize,
    /// Column after the last character that the message is about.
    pub end_column: usize,
    /// Number of the alarm that a control would raise; `None` without one.
    pub alarm: Option<u16>,
    /// Description of the fault, and what to do.
    pub message: String,
    /// Text of the program at that place.
    pub found: String,
}

/// Severity of a [`Diagnostic`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The program cannot run.
    Error,
    /// The program can run; a stricter control might reject it.
    Warning,
}

/// Reason why a move does not have the feed that its law demands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedDeparture {
    /// It keeps its programmed feed: a function is in force there that no law covers (G43.4, G95 and the like).
    Under(NotModelled),
    /// It keeps its programmed feed for another reason, in words.
    Because(&'static str),
    /// It has the lowest feed that the law allows.
    AtFloor,
}

/// Explanation of a move at the contour law's floor.
const AT_FLOOR: &str = "the contour law sets its lowest feed here (`floor` in [law]): the arc is so tight that the feed at the contour stays \
                        above the target; the chip does not, as it is at most the path of the centre per tooth";

impl Diagnostic {
    pub(super) fn of_fault(line: usize, text: &[u8], fault: Fault) -> Self {
        let alarm = match fault.cause {
            Cause::Alarm(alarm) => Some(alarm.number()),
            Cause::Macro(alarm) => alarm.number(),
            Cause::NotModelled(_) => None,
        };
        let message = match (fault.cause, advice(text, fault)) {
            (Cause::Alarm(alarm), Some(remedy)) => format!("{}; {remedy}", alarm.when()),
            (Cause::NotModelled(_), Some(remedy)) => format!("this is no NC block; {remedy}"),
            (Cause::Alarm(alarm), None) => alarm.explanation().to_string(),
            (Cause::Macro(alarm), _) => alarm.explanation().to_string(),
            (cause @ Cause::NotModelled(_), None) => cause.to_string(),
        };
        let column = usize::from(fault.column).max(1);
        let place = if fault.column == 0 { text } else { word_at(text, column) };
        let end_column = column + place.len().max(1);
        Diagnostic { severity: Severity::Error, line, column, end_column, alarm, message, found: printable(place) }
    }

    /// Diagnostic for a cutting move without an F so far.
    pub(super) fn of_missing_feed(line: usize, text: &[u8], reading: Reading) -> Self {
        let mut diagnostic = Diagnostic::of_fault(line, text, Fault::alarm(Alarm::NoFeed, 0));
        if reading == Reading::Lenient {
            diagnostic.severity = Severity::Warning;
            diagnostic.message = "no F before this cutting move: a control fresh from power-on raises PS0011; \
                                  one that remembers a feed moves with that; write F here or before"
                .into();
        }
        diagnostic
    }

    /// Warning about a move that does not have the feed that its law demands, for the reason `why`.
    pub fn of_feed_departure(line: usize, of: &ProgramLine, why: FeedDeparture) -> Self {
        let words = of.meaning.iter().flat_map(|meaning| &meaning.parsed.block.words);
        let axis = words.into_iter().find(|word| b"XYZABC".contains(&word.letter));
        let cause = if let FeedDeparture::Under(under) = why { under } else { NotModelled::MoveUnder(0) };
        let fault = Fault::not_modelled(cause, axis.map_or(0, |word| word.column));
        let mut diagnostic = Diagnostic::of_fault(line, &of.text, fault);
        diagnostic.severity = Severity::Warning;
        diagnostic.message = match why {
            FeedDeparture::Under(under) => {
                format!("a cut rule matches {under}, but no law describes it: it keeps its programmed feed")
            }
            FeedDeparture::Because(why) => {
                format!("a law of the job is for this move, but it keeps its programmed feed: {why}")
            }
            FeedDeparture::AtFloor => AT_FLOOR.into(),
        };
        diagnostic
    }

    /// Flow control of LinuxCNC.
    pub(super) fn of_flow_word(line: usize, text: &[u8]) -> Self {
        Diagnostic { severity: Severity::Error, ..Diagnostic::of_line(line, text, FLOW_WORD) }
    }

    /// Warning about a line as a whole.
    pub(super) fn of_line(line: usize, text: &[u8], message: &str) -> Self {
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

    /// Warning about the first line behind the closing `%`.
    pub(super) fn of_text_behind_the_end(line: usize, text: &[u8]) -> Self {
        let is_program = text.first().is_some_and(|byte| byte.eq_ignore_ascii_case(&b'O'));
        Diagnostic::of_line(line, text, if is_program { PROGRAM_BEHIND_THE_END } else { BEHIND_THE_END })
    }

    pub(super) fn of_notice(line: usize, text: &[u8], notice: Notice) -> Self {
        let column = usize::from(notice.column);
        let (alarm, message, place) = match notice.kind {
            NoticeKind::Title => (
                Some(Alarm::NoDataAfterAddress),
                "a title where a program number belongs: a control that takes this line as a block refuses it; write \
                 O and a number before the title, and the title in ( )",
                text,
            ),
            NoticeKind::CommentCharacter(_) => (
                Some(Alarm::Character),
                "characters in a comment that the control's code does not have: some controls refuse them; `stream` sends a blank \
                 in their place",
                text.get(column - 1..column).unwrap_or_default(),
            ),
            NoticeKind::SmallLetter => (
                Some(Alarm::Character),
                "small letters in code, read as capitals: some controls skip them and read another block, others refuse them; \
                 `stream` sends capitals",
                word_at(text, column),
            ),
            NoticeKind::Blank => (
                None,
                "a blank among the digits of a number: the control ignores it; remove it, or write the letter that is missing",
                word_at(text, column),
            ),
            NoticeKind::EndSign => (
                Some(Alarm::Character),
                "; is how the control's screen shows the end of a block: in a file some controls refuse it; `stream` leaves it out",
                text.get(column - 1..column).unwrap_or_default(),
            ),
            NoticeKind::UnclosedComment => (None, "a comment without ')': it ends with its line; close it", text),
            NoticeKind::LongNumber => (
                Some(Alarm::TooManyDigits),
                "more digits than this control has for N or O: it refuses the line; shorten it, or read the program as one for a 31i \
                 (--control fanuc-31i)",
                word_at(text, column),
            ),
            NoticeKind::Zero => (
                Some(Alarm::ProgramNumber),
                "numbers count from 1, and some controls refuse 0; write another",
                word_at(text, column),
            ),
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
pub(super) fn is_blank(text: &[u8]) -> bool {
    text.iter().all(|byte| *byte <= b' ')
}

/// Text from `column` (counted from 1) to before the next address letter; at most a few bytes.
fn word_at(text: &[u8], column: usize) -> &[u8] {
    let rest = text.get(column - 1..).unwrap_or_default();
    let end = rest.iter().skip(1).position(u8::is_ascii_alphabetic).map_or(rest.len(), |at| at + 1);
    &rest[..end.min(16)]
}

fn printable(text: &[u8]) -> String {
    let shown = text.get(..FOUND_MAX).unwrap_or(text);
    let end = if shown.len() < text.len() { "..." } else { "" };
    shown.escape_ascii().to_string().replace("\\'", "'").replace("\\\"", "\"") + end
}
