#![doc = include_str!("../README.md")]
//!
//! A [`Program`] has its text, and the meaning and place of each line, which are read again whenever they are needed.
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod clock;

pub mod files;

mod advice;

mod diagnostic;

mod block_delete;

mod move_counts;

mod move_trace;

mod unit_survey;

mod tool_comment;

mod tool_notes;

mod corner_moves;

mod path_warnings;

mod extents;

mod path_summary;

mod lines;

mod program_lines;

mod contour_check;

mod summary;

mod library;

mod run_faults;

mod expansion;

mod executed_places;

mod source;

mod conventions;

mod expanded_source;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arcfeed_nc::block::{LineKind, Parsed, Reading};
use arcfeed_nc::machining::Machining;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::settings::{Preset, Scope, Settings, Tables};
use arcfeed_nc::text::Lines;
use arcfeed_nc_macro::program::first_macro;
use arcfeed_units::{LengthUnit, Nm};

pub use block_delete::BlockDeleteEffect;
pub use contour_check::may_have_contours;
pub use conventions::{DecimalSurvey, fitting_convention};
pub use corner_moves::{CornerMove, CornerMoves};
pub use diagnostic::{Diagnostic, FeedDeparture, Severity};
pub use executed_places::ExecutedPlaces;
pub use expansion::{Expansion, RunBounds};
pub use extents::each_extreme;
pub use library::Folder;
use lines::LineReader;
pub use lines::in_capitals;
pub use move_counts::MoveCounts;
pub use move_trace::MoveTrace;
pub use path_summary::{PathSummary, ToolUse};
pub use program_lines::ProgramLines;
pub use source::{LINES_MAX, Source, check_line_count, read_bounded};
pub use summary::ProgramSummary;
pub use tool_comment::{CommentedKind, ToolComment};
pub use tool_notes::{ToolNote, ToolNotes};
pub use unit_survey::AssumedUnit;

/// NC program, read as a whole, with the errors and warnings found. It keeps its text alone: [`Program::lines`] reads the
/// lines again, because the meaning of a line takes more than a kilobyte.
#[derive(Clone, Debug)]
pub struct Program {
    /// Path of the file.
    pub path: PathBuf,
    /// Bytes of the whole program.
    bytes: Vec<u8>,
    /// Errors and warnings, in the order of their places.
    pub diagnostics: Vec<Diagnostic>,
    /// Numbers of the moves by kind.
    pub moves: MoveCounts,
    /// First line with a macro statement or a call, counted from 1; `None` without one.
    pub macro_line: Option<usize>,
    /// State of the control before the first line.
    pub control: Reader,
    /// Number of executions of each called program, by O number; empty unless the program was run.
    pub executions: BTreeMap<u32, u32>,
    /// For a program given as its executed blocks: place of each block in the program's file. `None` if the lines are
    /// those of the file.
    pub places: Option<Arc<ExecutedPlaces>>,
    /// Summary of the executed path, for a program with macro statements that was run.
    pub run_summary: Option<PathSummary>,
    /// Moves of a run.
    run: Vec<MoveTrace>,
    /// For an interpreted program, whose lines have no meaning in the order of the file: number of lines up to its end.
    lines_alone: Option<usize>,
}

/// Line of a program, with its meaning; the default has no text and no meaning.
#[derive(Clone, Debug, Default)]
pub struct ProgramLine {
    /// Bytes without the line end.
    pub text: Vec<u8>,
    /// Line end as found (see [`arcfeed_nc::text::RawLine`]).
    pub ending: Vec<u8>,
    /// Meaning of the line; `None` if a control would stop here with an alarm.
    pub meaning: Option<InterpretedLine>,
    /// Origin of the workpiece in path coordinates: that of the work offset in force, shifted by G92.
    pub origin: Pose,
    /// Tool length offset in Z, in machine coordinates; 0 without one.
    pub tool_length: Nm,
    /// G43.4: the coordinates are those of the tool tip in the part, and the machine's axes follow.
    pub follows_tip: bool,
    /// Tool and spindle, as commanded up to this line.
    pub machining: Machining,
    /// Effect of the line with the block-delete switches the other way; `None` if they change nothing.
    pub skipping: Option<BlockDeleteEffect>,
}

impl ProgramLine {
    /// Sets the state of a control that has executed the line, from `reader`.
    fn set_state(&mut self, reader: &Reader) {
        self.origin = reader.modal().work_origin();
        (self.tool_length, self.follows_tip) = move_trace::tool_of(reader);
        self.machining = reader.modal().machining();
    }

    /// Move of the line, relative to the workpiece's origin; `None` for a line without a move, and for blocks that make
    /// several moves.
    pub fn segment(&self) -> Option<Segment> {
        let segment = self.meaning.as_ref()?.segment?;
        Some(segment.shifted(Pose::ORIGIN.minus(self.origin)))
    }

    /// Diagnostic for the first line of a program, if a control on a line takes it for the label.
    fn missing_label(&self) -> Option<Diagnostic> {
        let has_code = self.meaning.as_ref().is_none_or(|meaning| !meaning.parsed.block.is_empty());
        has_code.then(|| Diagnostic::of_line(1, &self.text, diagnostic::NO_LABEL))
    }

    /// It was read as a block, without a comment.
    fn has_no_comment(&self) -> bool {
        let is_bare = |parsed: &Parsed| parsed.line == LineKind::Block && !parsed.has_comment;
        self.meaning.as_ref().is_some_and(|meaning| is_bare(&meaning.parsed))
    }

    /// A chamfer or a rounded corner follows its move.
    fn ends_in_corner(&self) -> bool {
        self.meaning.as_ref().is_some_and(|meaning| meaning.step.corner.is_some())
    }

    /// Whether the control counts the line as a block: anything but `%` and an empty line.
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
        Ok(Program::parse(path, &files::read(path)?, unit, reading))
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
        let mut program = Program::empty(path, bytes, reader.control());
        let mut line = ProgramLine::default();
        for raw in Lines::new(bytes) {
            reader.read_into(raw, &mut line, &mut program.diagnostics);
            line.meaning.iter().for_each(|meaning| program.moves.add(meaning));
        }
        program
    }

    /// Warning if the program's first line is a block, which a control that reads from a line would skip as a label;
    /// otherwise `None`.
    pub fn missing_label(&self) -> Option<Diagnostic> {
        self.lines().next()?.missing_label()
    }

    fn empty(path: &Path, bytes: &[u8], control: &Reader) -> Self {
        Program {
            path: path.to_owned(),
            bytes: bytes.to_owned(),
            diagnostics: Vec::new(),
            moves: MoveCounts::default(),
            macro_line: first_macro(bytes),
            control: control.clone(),
            executions: BTreeMap::new(),
            places: None,
            run_summary: None,
            run: Vec::new(),
            lines_alone: None,
        }
    }

    /// Bytes of the whole program.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Texts of the lines, in order, without their line ends.
    pub fn texts(&self) -> impl Iterator<Item = &[u8]> {
        Lines::new(&self.bytes).map(|line| line.text)
    }

    /// Line of the file to which a line belongs, both counted from 1.
    pub fn line_in_file(&self, line: usize) -> usize {
        self.places.as_ref().map_or(line, |places| places.line_in_file(line))
    }

    /// Content of the program's own file, if this program consists of its executed blocks.
    pub fn file(&self) -> &[u8] {
        self.places.as_ref().map_or(&self.bytes, |places| &places.file)
    }

    /// Whether a control would stop somewhere in the program.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, reading: Reading) -> Program {
        Program::parse(Path::new("test.nc"), text.as_bytes(), LengthUnit::Inch, reading)
    }

    #[test]
    fn the_lines_have_every_byte_of_the_file() {
        for text in ["%\nN1G0X1.\r\n(A)\n\n%", "", "\n", "G0X1.\n\r\r%\n\r\r", "%\nM30\n%\nTHE END\r\nG1"] {
            let lines = parse(text, Reading::Lenient);
            let bytes: Vec<u8> = lines.lines().flat_map(|line| [line.text, line.ending].concat()).collect();
            assert_eq!((bytes.as_slice(), lines.bytes()), (text.as_bytes(), text.as_bytes()));
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
        assert_eq!((places, ProgramSummary::new(program.lines()).blocks), (vec![(5, Severity::Warning)], 1));
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
