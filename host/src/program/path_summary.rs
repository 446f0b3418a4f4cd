//! Tool path of a program in figures: extents of the cutting moves, and what each tool does.
//!
//! Times are those at the programmed feed: without rapids, acceleration, override and tool changes.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, TAU};

use arcfeed_nc::machining::{Machining, SpindleCommand, ToolInSpindle};
use arcfeed_nc::modal::{Feed, PER_MIN_SCALE, Pose};
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_nc::series::SeriesAction;
use arcfeed_units::{LengthUnit, Micros, Nm, S_PER_MIN};

use super::ProgramLine;
use super::move_trace::segments;

/// Most tools, and most comments of a tool list.
const TOOLS_MAX: usize = 200;
/// Most H and D numbers of a tool.
const OFFSETS_MAX: usize = 8;

/// Figures of a program's path.
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
    /// Dwells.
    pub dwell: Micros,
    lines: usize,
    /// Tool of the last T word.
    selected: Option<i64>,
    comments: ToolComments,
}

/// Work of one tool.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolUse {
    /// T number; `None` for a tool that the program does not name.
    pub number: Option<i64>,
    /// Comment at its tool change or in the program's tool list.
    pub comment: String,
    /// First line with it in the spindle, counted from 1.
    pub line: usize,
    /// H numbers.
    pub lengths: Vec<i64>,
    /// D numbers.
    pub radii: Vec<i64>,
    /// Lowest and highest speed of cutting moves, rev/min.
    pub spindle: Option<[i64; 2]>,
    /// Lowest and highest feed per minute of cutting moves.
    pub feed: Option<[Nm; 2]>,
    /// Length of its cutting moves, mm.
    pub cutting_mm: f64,
    /// Length of its rapid moves, mm.
    pub rapid_mm: f64,
    /// Duration of its cutting moves at their programmed feeds, s.
    pub cutting_s: f64,
}

/// Comments that may describe a tool.
#[derive(Clone, Debug, Default)]
struct ToolComments {
    /// Comments that begin with a tool number.
    list: BTreeMap<i64, String>,
    /// The last comment, and the number of lines since.
    last: Option<(String, usize)>,
    /// Index of the tool whose comment may be in the next line.
    next: Option<usize>,
}

impl PathSummary {
    /// No line so far; `unit` at power-on.
    pub fn new(unit: LengthUnit) -> Self {
        PathSummary {
            unit,
            is_unit_stated: false,
            extents: [None; 6],
            tools: Vec::new(),
            dwell: Micros(0),
            lines: 0,
            selected: None,
            comments: ToolComments::default(),
        }
    }

    /// Adds the next line of a program without macro statements.
    pub fn add_line(&mut self, line: &ProgramLine) {
        self.add_text(&line.text);
        if let Some(meaning) = &line.meaning {
            self.add_block(self.lines, meaning, line.machining, line.origin);
        }
    }

    /// Notes the comment of the next line of the file.
    fn add_text(&mut self, text: &[u8]) {
        self.lines += 1;
        let comment = comment_of(text);
        if let (Some(index), Some(comment)) = (self.comments.next.take(), &comment)
            && let Some(tool) = self.tools.get_mut(index)
        {
            tool.comment.clone_from(comment);
        }
        self.comments.add(comment);
    }

    /// Notes the tool list in the comments of a file that is executed afterwards.
    pub fn add_tool_list<'a>(&mut self, texts: impl IntoIterator<Item = &'a [u8]>) {
        texts.into_iter().for_each(|text| self.comments.add(comment_of(text)));
        self.comments.last = None;
    }

    /// Adds a block that is executed.
    pub fn add_block(&mut self, line: usize, block: &InterpretedLine, machining: Machining, origin: Pose) {
        let words = &block.parsed.block;
        if !self.is_unit_stated {
            let codes = words.words.iter().filter(|word| word.letter == b'G').filter_map(|word| word.number.as_whole());
            for code in codes.filter(|code| matches!(code, 20 | 21)) {
                self.unit = if code == 20 { LengthUnit::Inch } else { LengthUnit::Mm };
                self.is_unit_stated = true;
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
        let unit = self.unit;
        if let Some(tool) = self.tools.get_mut(index) {
            for (place, found) in [(&mut tool.lengths, whole(b'H')), (&mut tool.radii, whole(b'D'))] {
                place.extend(found.filter(|found| *found != 0 && !place.contains(found) && place.len() < OFFSETS_MAX));
            }
            segments(block).for_each(|segment| tool.add(&segment, machining.spindle, unit));
        }
        segments(block).filter(|segment| segment.path != Path::Rapid).for_each(|segment| self.extend(&segment, origin));
        let of_series = block.step.series.iter().flat_map(|series| series.actions()).filter_map(|act| match act {
            SeriesAction::Dwell(time) => Some(time),
            SeriesAction::Move(_) | SeriesAction::Spindle(_) => None,
        });
        self.dwell = block.step.dwell.into_iter().chain(of_series).fold(self.dwell, Micros::after);
    }

    /// Index of a tool; a tool without a move does not count yet.
    fn index_of(&mut self, number: Option<i64>, line: usize) -> usize {
        if let Some(index) = self.tools.iter().position(|tool| tool.number == number) {
            return index;
        }
        let index = self.tools.len();
        if index < TOOLS_MAX {
            let comment = self.comments.of(number);
            self.comments.next = (comment.is_empty() && number.is_some()).then_some(index);
            self.tools.push(ToolUse { number, line, comment, ..ToolUse::default() });
        }
        index
    }

    fn extend(&mut self, segment: &Segment, origin: Pose) {
        let relative = segment.shifted(Pose::ORIGIN.minus(origin));
        let Segment { start, end, path, .. } = &relative;
        for index in 0..3 {
            if start.linear[index] != end.linear[index] || matches!(path, Path::Arc(_)) {
                self.include(index, start.linear[index].to_mm());
                self.include(index, end.linear[index].to_mm());
            }
            if start.rotary[index] != end.rotary[index] {
                self.include(3 + index, start.rotary[index].to_deg());
                self.include(3 + index, end.rotary[index].to_deg());
            }
        }
        if let Path::Arc(arc) = path {
            let (first, second, _) = arc.plane.axes();
            for [x, y] in extreme_points(arc) {
                self.include(first, x);
                self.include(second, y);
            }
        }
    }

    fn include(&mut self, axis: usize, value: f64) {
        let [low, high] = self.extents[axis].unwrap_or([value; 2]);
        self.extents[axis] = Some([low.min(value), high.max(value)]);
    }

    /// Tools that move.
    pub fn tools_in_use(&self) -> impl Iterator<Item = &ToolUse> {
        self.tools.iter().filter(|tool| tool.cutting_mm > 0.0 || tool.rapid_mm > 0.0 || tool.cutting_s > 0.0)
    }
}

impl ToolUse {
    fn add(&mut self, segment: &Segment, spindle: SpindleCommand, unit: LengthUnit) {
        let length_mm = segment.length_mm();
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
                // F of a move of rotary axes alone is in degrees per minute.
                let turned: i64 = (0..3)
                    .map(|axis| (segment.end.rotary[axis].0 - segment.start.rotary[axis].0).abs())
                    .max()
                    .unwrap_or(0);
                let minutes = if length_mm > 0.0 {
                    segment.feed_length_mm() / feed.to_mm()
                } else {
                    arcfeed_units::MicroDeg(turned).to_deg() / (feed.0 as f64 / unit.nm() as f64)
                };
                self.cutting_s += minutes * S_PER_MIN;
            }
            Feed::InverseTime(times) if times > 0 => self.cutting_s += PER_MIN_SCALE as f64 / times as f64 * S_PER_MIN,
            Feed::PerMinute(_) | Feed::InverseTime(_) | Feed::Missing => {}
        }
    }
}

impl ToolComments {
    fn add(&mut self, comment: Option<String>) {
        match comment {
            Some(comment) => {
                if let Some(number) = tool_number(&comment)
                    && self.list.len() < TOOLS_MAX
                {
                    self.list.entry(number).or_insert_with(|| comment.clone());
                }
                self.last = Some((comment, 0));
            }
            None => self.last.iter_mut().for_each(|(_, age)| *age += 1),
        }
    }

    /// Comment of a tool that is loaded in the current line.
    fn of(&self, number: Option<i64>) -> String {
        let last = |oldest: usize| self.last.iter().find(|(_, age)| *age <= oldest).map(|(comment, _)| comment);
        let listed = number.and_then(|number| self.list.get(&number));
        number.and(last(0).or(listed).or(last(1))).cloned().unwrap_or_default()
    }
}

/// The first comment of a line, if it has text.
fn comment_of(text: &[u8]) -> Option<String> {
    let begin = text.iter().position(|byte| *byte == b'(')? + 1;
    let rest = text.get(begin..)?;
    let end = rest.iter().position(|byte| *byte == b')').unwrap_or(rest.len());
    let comment = String::from_utf8_lossy(&rest[..end]).trim().to_owned();
    (!comment.is_empty()).then_some(comment)
}

/// Number of the tool that a comment such as `T1 D=10.` or `TOOL 1 - FACE MILL` describes.
fn tool_number(comment: &str) -> Option<i64> {
    let upper = comment.to_ascii_uppercase();
    let rest = upper.strip_prefix("TOOL").or(upper.strip_prefix('T'))?.trim_start_matches([' ', '#', '-']);
    let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    rest[..digits].parse().ok()
}

/// Points of an arc, in mm, with the lowest or highest coordinate of an axis, but for its ends.
fn extreme_points(arc: &Arc) -> impl Iterator<Item = [f64; 2]> {
    let [x, y] = arc.center.map(Nm::to_mm);
    let (radius, angles) = (arc.radius_mm(), arc.angles());
    (0..4).filter_map(move |quarter| {
        let angle = f64::from(quarter) * FRAC_PI_2;
        let ahead = ((angle - angles.start_rad) * angles.turned_rad.signum()).rem_euclid(TAU);
        let (sin, cos) = libm::sincos(angle);
        (ahead < angles.turned_rad.abs()).then_some([x + radius * cos, y + radius * sin])
    })
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
        program.lines.iter().for_each(|line| summary.add_line(line));
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
            found.tools_in_use().last().map(|tool| tool.comment.clone()).unwrap()
        };
        assert_eq!(comment("(T1 D=10. - FLAT)\n(POCKET)\nT1M6\n"), "T1 D=10. - FLAT");
        assert_eq!(comment("( TOOL 3 - FACE MILL )\nM8\nT3M6\n"), "TOOL 3 - FACE MILL");
        assert_eq!(comment("(T1 D=10.)\nT1M6(OWN)\n"), "OWN");
        assert_eq!(comment("(DRILL)\nT4M6\n"), "DRILL");
        assert_eq!(comment("M1\nM6T4\n(REAMER)\n"), "REAMER");
        assert_eq!(comment("(PART)\nM8\nM9\nT4M6\n"), "");
    }
}
