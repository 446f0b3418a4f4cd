//! Summary of a program's tool path: extents of the cutting moves, and the work of each tool; also cuts with a stopped spindle, and G62.
//!
//! Times are those at the programmed feed: without rapids, acceleration, override and tool changes.

use std::collections::BTreeSet;

use arcfeed_nc::machining::{Machining, SpindleCommand, ToolInSpindle};
use arcfeed_nc::modal::{Feed, PER_MIN_SCALE, Pose};
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_nc::series::SeriesAction;
use arcfeed_units::{LengthUnit, MicroDeg, Micros, Nm, S_PER_MIN};
use memchr::memchr;

use super::extents::each_extreme;
use super::move_trace::series_segments;
use super::path_warnings;
use super::tool_notes::{ToolNotes, comments};
use super::{Diagnostic, ProgramLine};

/// Most tools.
const TOOLS_MAX: usize = 200;
/// Most H and D numbers of a tool.
const OFFSETS_MAX: usize = 8;
/// Most lines that are warned of.
const WARNED_MAX: usize = 1_000;

/// Summary of a program's tool path: extents, times and tools.
#[derive(Clone, Debug)]
pub struct PathSummary {
    /// Unit of the program: the first that it states, otherwise that at power-on.
    pub unit: LengthUnit,
    is_unit_stated: bool,
    /// Lowest and highest coordinate of cutting moves: X, Y, Z in mm, A, B, C in degrees, relative to the workpiece's origin;
    /// `None` for an axis that no cutting move has.
    pub extents: [Option<[f64; 2]>; 6],
    /// Tools in the order of their first use.
    pub tools: Vec<ToolUse>,
    /// Total time of the dwells.
    pub dwell: Micros,
    lines: usize,
    /// Tool of the last T word.
    selected: Option<i64>,
    /// Tool of the last block, and its index.
    current: Option<(Option<i64>, usize)>,
    comments: ToolComments,
    /// Lines of the first cutting moves with a stopped spindle.
    stopped: BTreeSet<usize>,
    was_stopped: bool,
    /// First line with G62.
    corner_override: Option<usize>,
    /// A line that could not be read may start the spindle.
    has_unread_lines: bool,
}

/// Work of one tool in a program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolUse {
    /// T number; `None` for a tool that the program does not name.
    pub number: Option<i64>,
    /// Comment at its tool change; see [`PathSummary::comment_of`].
    pub comment: String,
    /// First line of the program with the tool in the spindle, counted from 1.
    pub line: usize,
    /// Tool length offset numbers (H) used with it.
    pub lengths: Vec<i64>,
    /// Tool radius offset numbers (D) used with it.
    pub radii: Vec<i64>,
    /// Lowest and highest spindle speed during cutting moves, rev/min; `None` if none is known.
    pub spindle: Option<[i64; 2]>,
    /// Lowest and highest feed per minute of cutting moves; `None` if none is known.
    pub feed: Option<[Nm; 2]>,
    /// Length of its cutting moves, mm.
    pub cutting_mm: f64,
    /// Length of its rapid moves, mm.
    pub rapid_mm: f64,
    /// Time of its cutting moves at the programmed feed, s.
    pub cutting_s: f64,
}

/// Comments that may describe a tool.
#[derive(Clone, Debug)]
struct ToolComments {
    /// Comments with data of tools.
    notes: ToolNotes,
    /// The last line with a comment, and the number of lines since.
    last: (Vec<u8>, usize),
    /// Index of the tool whose comment may be in the next line.
    next: Option<usize>,
}

impl PathSummary {
    /// Summary before the first line; `unit` applies at power-on.
    pub fn new(unit: LengthUnit) -> Self {
        PathSummary {
            unit,
            is_unit_stated: false,
            extents: [None; 6],
            tools: Vec::new(),
            dwell: Micros(0),
            lines: 0,
            selected: None,
            current: None,
            comments: ToolComments { notes: ToolNotes::new(unit), last: (Vec::new(), 0), next: None },
            stopped: BTreeSet::new(),
            was_stopped: false,
            corner_override: None,
            has_unread_lines: false,
        }
    }

    /// Adds the next line of a program without macro statements.
    pub fn add_line(&mut self, line: &ProgramLine) {
        self.lines += 1;
        let before = self.current_tool();
        let comment = if line.has_no_comment() { None } else { comment_in(&line.text) };
        self.add_comment(comment);
        match &line.meaning {
            Some(meaning) => self.add_block(self.lines, meaning, &line.machining, &line.origin),
            None => self.has_unread_lines = true,
        }
        let words = line.meaning.as_ref().map(|meaning| &meaning.parsed.block);
        let selected = words.and_then(|words| words.word(b'T')).and_then(|word| word.number.as_whole());
        let loaded = self.current_tool().filter(|number| Some(*number) != before);
        let change = selected.or(loaded);
        if comment.is_some() || change.is_some() {
            self.comments.notes.read(self.lines, comment.unwrap_or_default(), change);
        }
    }

    /// Number of the tool of the last block; `None` if it has none.
    fn current_tool(&self) -> Option<i64> {
        self.current.and_then(|(number, _)| number)
    }

    /// Notes the comment of the next line of the file.
    fn add_comment(&mut self, text: Option<&[u8]>) {
        if let (Some(index), Some(text)) = (self.comments.next.take(), text)
            && let Some(tool) = self.tools.get_mut(index)
        {
            tool.comment = comments(text).next().unwrap_or_default();
        }
        self.comments.add(text);
    }

    /// Reads the tool data in the comments of a file whose blocks are executed afterwards.
    pub fn add_tool_list<'a>(&mut self, texts: impl IntoIterator<Item = &'a [u8]>) {
        (1..).zip(texts).for_each(|(line, text)| self.comments.notes.read(line, text, None));
    }

    /// Adds a block that is executed.
    pub fn add_block(&mut self, line: usize, block: &InterpretedLine, machining: &Machining, origin: &Pose) {
        let words = &block.parsed.block;
        for code in words.words.iter().filter(|word| word.letter == b'G').filter_map(|word| word.number.as_whole()) {
            match code {
                20 | 21 if !self.is_unit_stated => {
                    self.unit = if code == 20 { LengthUnit::Inch } else { LengthUnit::Mm };
                    self.is_unit_stated = true;
                }
                62 => self.corner_override = self.corner_override.or(Some(line)),
                _ => {}
            }
        }
        let whole = |letter: u8| words.word(letter).and_then(|word| word.number.as_whole());
        self.selected = whole(b'T').or(self.selected);
        let number = match machining.tool {
            ToolInSpindle::Number(number) => Some(number),
            ToolInSpindle::Unstated => self.selected,
            ToolInSpindle::Unknown => None,
        };
        let index = self.index_of(number, line);
        if let Some(tool) = self.tools.get_mut(index) {
            for (place, found) in [(&mut tool.lengths, whole(b'H')), (&mut tool.radii, whole(b'D'))] {
                place.extend(found.filter(|found| *found != 0 && !place.contains(found) && place.len() < OFFSETS_MAX));
            }
        }
        let (mut cuts, mut turns) = (false, false);
        let mut add = |segment: &Segment| {
            if let Some(tool) = self.tools.get_mut(index) {
                tool.add(segment, machining.spindle, self.unit);
            }
            if segment.path != Path::Rapid {
                cuts = true;
                self.extend(segment, origin);
            }
        };
        block.segment.iter().for_each(&mut add);
        if let Some(series) = &block.step.series {
            series_segments(block).for_each(|segment| add(&segment));
            for act in series.actions() {
                match act {
                    SeriesAction::Dwell(time) => self.dwell = self.dwell.after(time),
                    // A tapping cycle turns the spindle itself.
                    SeriesAction::Spindle(_) => turns = true,
                    SeriesAction::Move(_) => {}
                }
            }
        }
        self.dwell = block.step.dwell.into_iter().fold(self.dwell, Micros::after);
        if cuts && !turns {
            let is_stopped = machining.spindle == SpindleCommand::Stopped;
            if is_stopped && !self.was_stopped && !self.has_unread_lines && self.stopped.len() < WARNED_MAX {
                self.stopped.insert(line);
            }
            self.was_stopped = is_stopped;
        }
    }

    /// Warnings of the first cuts with a stopped spindle, up to the first line that could not be read, and of the first G62, each
    /// with the text of its line in the program.
    pub fn warnings<'a>(&self, program: &'a [u8]) -> Vec<(Diagnostic, &'a [u8])> {
        path_warnings::warnings(&self.stopped, self.corner_override, program)
    }

    /// Comment about a tool: preferably one with its data, otherwise the comment at its tool change.
    pub fn comment_of<'s>(&'s self, tool: &'s ToolUse) -> &'s str {
        let described = tool.number.and_then(|number| self.comments.notes.text_of(number));
        described.unwrap_or(&tool.comment)
    }

    /// Index of a tool; a tool without a move does not count yet.
    fn index_of(&mut self, number: Option<i64>, line: usize) -> usize {
        if let Some((_, index)) = self.current.filter(|(current, _)| *current == number) {
            return index;
        }
        let known = self.tools.iter().position(|tool| tool.number == number);
        let index = known.unwrap_or(self.tools.len());
        self.current = Some((number, index));
        if known.is_none() && index < TOOLS_MAX {
            let comment = self.comments.of(number);
            self.comments.next = (comment.is_empty() && number.is_some()).then_some(index);
            self.tools.push(ToolUse { number, line, comment, ..ToolUse::default() });
        }
        index
    }

    fn extend(&mut self, segment: &Segment, origin: &Pose) {
        each_extreme(segment, origin, |axis, reached| {
            let [low, high] = self.extents[axis].get_or_insert(reached);
            if reached[0] < *low {
                *low = reached[0];
            }
            if reached[1] > *high {
                *high = reached[1];
            }
        });
    }

    /// Tools that make at least one move.
    pub fn tools_in_use(&self) -> impl Iterator<Item = &ToolUse> {
        self.tools.iter().filter(|tool| tool.cutting_mm > 0.0 || tool.rapid_mm > 0.0 || tool.cutting_s > 0.0)
    }
}

impl ToolUse {
    fn add(&mut self, segment: &Segment, spindle: SpindleCommand, unit: LengthUnit) {
        let feed_length_mm = segment.feed_length_mm();
        let length_mm = match segment.path {
            Path::Arc(_) if segment.rise() == Nm(0) => feed_length_mm,
            Path::Arc(_) => segment.length_mm(),
            Path::Rapid | Path::Line => feed_length_mm,
        };
        if segment.path == Path::Rapid {
            self.rapid_mm += length_mm;
            return;
        }
        self.cutting_mm += length_mm;
        if let SpindleCommand::RevPerMin(speed) = spindle {
            let [low, high] = self.spindle.unwrap_or([speed; 2]);
            self.spindle = Some([low.min(speed), high.max(speed)]);
        }
        match segment.feed {
            Feed::PerMinute(feed) if feed.0 > 0 => {
                let [low, high] = self.feed.unwrap_or([feed; 2]);
                self.feed = Some([low.min(feed), high.max(feed)]);
                let minutes = if length_mm > 0.0 {
                    feed_length_mm / feed.to_mm()
                } else {
                    // F of a move of rotary axes alone is in degrees per minute.
                    let [start, end] = [segment.start, segment.end].map(|pose| pose.rotary);
                    let turned = (0..3).map(|axis| (end[axis].0 - start[axis].0).abs()).max().unwrap_or(0);
                    MicroDeg(turned).to_deg() / (feed.0 as f64 / unit.nm() as f64)
                };
                self.cutting_s += minutes * S_PER_MIN;
            }
            Feed::InverseTime(times) if times > 0 => self.cutting_s += PER_MIN_SCALE as f64 / times as f64 * S_PER_MIN,
            Feed::PerMinute(_) | Feed::InverseTime(_) | Feed::Missing => {}
        }
    }
}

impl ToolComments {
    fn add(&mut self, comment: Option<&[u8]>) {
        let (last, age) = &mut self.last;
        *age += 1;
        if let Some(comment) = comment {
            last.clear();
            last.extend_from_slice(comment);
            *age = 0;
        }
    }

    /// Comment of a tool that is loaded in the current line: in it or right before it.
    fn of(&self, number: Option<i64>) -> String {
        let (last, age) = &self.last;
        number.filter(|_| *age <= 1).and_then(|_| comments(last).next()).unwrap_or_default()
    }
}

/// A line from its first comment on, if a comment has a letter or a digit.
fn comment_in(text: &[u8]) -> Option<&[u8]> {
    let comment = text.get(memchr(b'(', text)?..)?;
    let mut is_comment = false;
    let has_text = comment.iter().any(|byte| {
        is_comment = (is_comment || *byte == b'(') && *byte != b')';
        is_comment && (byte.is_ascii_alphanumeric() || !byte.is_ascii())
    });
    has_text.then_some(comment)
}

#[cfg(test)]
mod tests {
    use std::path::Path as FilePath;

    use arcfeed_nc::block::Reading;

    use super::super::Program;
    use super::*;

    fn summary(text: &str) -> PathSummary {
        let program = Program::parse(FilePath::new("t.nc"), text.as_bytes(), LengthUnit::Mm, Reading::Lenient);
        let mut summary = PathSummary::new(LengthUnit::Mm);
        program.lines().for_each(|line| summary.add_line(&line));
        summary
    }

    #[test]
    fn the_extents_of_an_arc_reach_to_its_quarters() {
        // Half a circle about (10, 0) with radius 10, counter-clockwise from (20, 0): it reaches Y10, not Y-10.
        let found = summary("G0X20.Y0Z0\nG3X0Y0I-10.F100.\n").extents;
        let near = |axis: usize, wanted: [f64; 2]| {
            let [low, high] = found[axis].unwrap();
            assert!((low - wanted[0]).abs() < 1e-9 && (high - wanted[1]).abs() < 1e-9, "{axis}: {low} {high}");
        };
        near(0, [0.0, 20.0]);
        near(1, [0.0, 10.0]);
        assert_eq!(found[3], None);
        let whole = summary("G0X20.Y0\nG2I-10.F100.\n").extents;
        assert_eq!(whole[1].map(|[low, high]| [low.round(), high.round()]), Some([-10.0, 10.0]));
    }

    #[test]
    fn cuts_with_a_stopped_spindle_are_warned_of_once_for_each_stop() {
        let lines = |text: &str| {
            let found = summary(text).warnings(text.as_bytes());
            found.into_iter().map(|(warning, _)| warning.line).collect::<Vec<_>>()
        };
        assert_eq!(lines("T1M6\nS1000M3\nG1X1.F100.\nM5\nG0X0\nG1X1.\nX2.\nM3\nX3.\nM30\n"), [6]);
        assert_eq!(lines("T1M6\nG0X0\nG1X1.F100.\nT2M6\nX3.\nS100M4\nX2.\nM5\nG81Z-1.R1.\n"), [3, 9]);
        assert_eq!(lines("S1000\nG1X1.F100.\n"), [2]);
        assert_eq!(lines("T1M6\nG187M3\nG1X1.F100.\n"), [0; 0]);
        assert_eq!(lines("G1X1.F100.\nM3\nX2.\nT1M6\nM29S500\nG84Z-5.R1.F500.\n"), [0; 0]);
    }

    #[test]
    fn the_first_g62_of_a_program_is_warned_of() {
        let text = "G1X1.F100.\nG64\nG62X2.\nG62\n";
        let found: Vec<_> = summary(text).warnings(text.as_bytes()).into_iter().map(|(found, _)| found).collect();
        assert_eq!(found.iter().map(|found| found.line).collect::<Vec<_>>(), [3]);
        assert!(found[0].message.starts_with("G62 has no effect here"));
    }

    #[test]
    fn distance_and_time_are_those_of_the_programmed_feed() {
        let text = "G21G90G0X0Y0Z0\nT1M6(CUTTER)\nS1000M3\nG43H1G0Z5.\nG1Z0F100.\nX300.F600.\nG4P2000\nG93X310.F2.\nG94\n\
                    T2M6\nG0X0\nG81Z-5.R5.F50.\nM30\n";
        let found = summary(text);
        let [_, first, second] = found.tools.as_slice() else { panic!("{:?}", found.tools) };
        assert_eq!(
            (first.number, first.comment.as_str(), first.line, first.lengths.as_slice()),
            (Some(1), "CUTTER", 2, &[1][..])
        );
        assert_eq!((first.cutting_mm, first.rapid_mm), (315.0, 5.0));
        // 5 mm at 100, 300 mm at 600 mm/min, half a minute.
        assert!((first.cutting_s - (3.0 + 30.0 + 30.0)).abs() < 1e-9, "{first:?}");
        assert_eq!(first.spindle, Some([1_000; 2]));
        assert_eq!(first.feed.map(|feed| feed.map(Nm::to_mm)), Some([100.0, 600.0]));
        assert!((second.cutting_s - 12.0).abs() < 1e-9, "{second:?}");
        assert_eq!(found.dwell, Micros(2_000_000));
    }

    #[test]
    fn a_tool_gets_the_comment_of_the_list_or_of_the_lines_about_its_change() {
        let comment = |text: &str| {
            let found = summary(&format!("{text}G0X1.\n"));
            found.tools_in_use().last().map(|tool| found.comment_of(tool).to_owned()).unwrap()
        };
        assert_eq!(comment("(T1 D=10. - FLAT)\n(POCKET)\nT1M6\n"), "T1 D=10. - FLAT");
        assert_eq!(comment("( TOOL 3 - FACE MILL )\nM8\nT3M6\n"), "TOOL 3 - FACE MILL");
        assert_eq!(comment("(T1 D=10.)\nT1M6(OWN)\n"), "T1 D=10.");
        assert_eq!(comment("T1M6(OWN)\n"), "OWN");
        assert_eq!(comment("(10MM ENDMILL)\n()\nT1M6( )\n(---)\n"), "10MM ENDMILL");
        assert_eq!(comment("(T3 SPECIAL)\n(OP10)\nM8\nM9\nT3M6\n"), "T3 SPECIAL");
        assert_eq!(comment("(DRILL)\nT4M6\n"), "DRILL");
        assert_eq!(comment("M1\nM6T4\n(REAMER)\n"), "REAMER");
        assert_eq!(comment("(PART)\nM8\nM9\nT4M6\n"), "");
    }
}
