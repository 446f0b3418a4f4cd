//! Survey of a program: unit, speeds, tools with the comments about them, and arcs with the features by which they differ.

use std::path::Path as FilePath;

use arcfeed_nc::alarm::NotModelled;
use arcfeed_nc::block::Block;
use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_nc::settings::{CompensationType, Settings, Tables};
use arcfeed_units::{LengthUnit, Nm};

use crate::console::note;
use crate::program::{
    AssumedUnit, CornerMoves, Program, ProgramLine, ToolNote, ToolNotes, check_line_count, each_extreme, read_bounded,
};

/// Two moves join smoothly if their directions agree to this (the cosine of two degrees).
const SMOOTH_COSINE: f64 = 0.9994;

/// Result of surveying a program: unit, speeds, tools and arcs.
#[derive(Clone, Debug, Default)]
pub struct Survey {
    /// Unit of the first G20 or G21; `None` if the program has neither.
    pub unit: Option<LengthUnit>,
    /// Likely unit of a program without G20 and G21, from the number of its decimals.
    pub likely_unit: Option<LengthUnit>,
    /// Unit that is assumed because neither the program nor the options state it; `None` if one does.
    pub assumed: Option<AssumedUnit>,
    /// Spindle speeds (S words), rev/min, in order of first appearance.
    pub speeds: Vec<i64>,
    /// T numbers of the loaded tools, in order of first appearance.
    pub tools: Vec<i64>,
    /// Speeds and feeds of each tool that cuts, in order of first appearance.
    pub uses: Vec<SurveyedTool>,
    /// Comments of the program about tools.
    pub notes: Vec<ToolNote>,
    /// Arcs of the program, in order.
    pub arcs: Vec<FoundArc>,
    /// Number of straight cutting moves.
    pub lines: usize,
    /// Lowest and highest X, Y and Z of the cutting moves, mm; `None` for an axis along which none goes.
    pub extents_mm: [Option<[f64; 2]>; 3],
    /// Arcs under G41 or G42 whose D has no known radius: line of the first, counted from 1, and their number.
    pub without_radius: Option<(usize, usize)>,
    /// Line of the first block that mirrors an axis (G51.1, G51 with a negative scale), counted from 1: arcs turn the other way
    /// behind it.
    pub mirrored: Option<usize>,
}

/// Cutting speeds and feeds of a tool in a program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurveyedTool {
    /// T number; `None` before the first.
    pub tool: Option<i64>,
    /// Spindle speeds, rev/min, in order of first appearance.
    pub speeds: Vec<i64>,
    /// Highest feed per minute; `None` without an F.
    pub feed_max: Option<Nm>,
}

/// An arc of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundArc {
    /// Line, counted from 1.
    pub line: usize,
    /// N number of its block; `None` without one.
    pub sequence: Option<i64>,
    /// Plane of the arc.
    pub plane: Plane,
    /// Direction: clockwise or counter-clockwise.
    pub turn: Turn,
    /// Radius, mm.
    pub radius_mm: f64,
    /// Angle of the arc (sweep), rad.
    pub sweep_rad: f64,
    /// Z coordinate at the start.
    pub level: Nm,
    /// The arc also moves along the axis square to its plane (helix).
    pub rises: bool,
    /// Feed per minute; `None` before the first F.
    pub feed: Option<Nm>,
    /// T number of the cutting tool; `None` before the first.
    pub tool: Option<i64>,
    /// The cutting moves before and after it join smoothly, therefore it rounds a corner of a contour.
    pub is_corner: bool,
}

/// Reads and surveys a program file, for a control with these settings; one with macro statements or calls at its blocks as
/// executed, with those of `library`. `given` is the unit of a program without G20 and G21, if it is known.
///
/// # Errors
/// The file cannot be read, or is too long: in words, with its path.
pub fn load(
    path: &FilePath,
    (settings, tables): (Settings, Tables),
    given: Option<LengthUnit>,
    library: Option<&FilePath>,
) -> Result<(Program, Survey), String> {
    let bytes = read_bounded(path)?;
    check_line_count(path, &bytes)?;
    let read = |unit| Program::executed(path, &bytes, (Settings { unit, ..settings }, tables), library);
    let assumed = if given.is_none() { AssumedUnit::of(&bytes) } else { None };
    let likely_unit = assumed.as_ref().and_then(|assumed| assumed.likely);
    let mut program = read(given.or(likely_unit).unwrap_or(LengthUnit::Inch));
    let unit = blocks(&program).find_map(|(_, block)| unit_of(&block));
    let counted = unit.or(given).or(likely_unit).unwrap_or(LengthUnit::Inch);
    if counted != program.control.settings().unit {
        program = read(counted);
    }
    let mut survey = Survey { unit, likely_unit, assumed, ..survey(&program, counted) };
    survey.arcs.iter_mut().for_each(|arc| arc.line = program.line_in_file(arc.line));
    survey.notes.iter_mut().for_each(|note| note.line = program.line_in_file(note.line));
    survey.mirrored = survey.mirrored.map(|line| program.line_in_file(line));
    Ok((program, survey))
}

/// Survey of a program whose comments count in `unit`.
fn survey(program: &Program, unit: LengthUnit) -> Survey {
    let mut found = Survey::default();
    let mut notes = ToolNotes::new(unit);
    // Without M6 a T word is the change itself.
    let has_changes = blocks(program).any(|(_, block)| is_change(&block));
    let has_radii = has_radii(program);
    let (mut chosen, mut tool, mut speed) = (None, None, None);
    let (mut before, mut corners): (Option<Segment>, _) = (None, CornerMoves::default());
    for (index, line) in program.lines().enumerate() {
        let Some(meaning) = &line.meaning else { continue };
        let block = &meaning.parsed.block;
        let selected = block.word(b'T').and_then(|word| word.number.as_whole());
        chosen = selected.or(chosen);
        if chosen != tool && (is_change(block) || !has_changes) {
            tool = chosen;
            found.tools.extend(tool.filter(|tool| *tool != 0 && !found.tools.contains(tool)));
        }
        found.mirrored = found.mirrored.or(mirrors(block).then_some(index + 1));
        notes.read(index + 1, &line.text, selected.or(chosen.filter(|_| is_change(block))));
        let commanded = meaning.step.spindle.map(|(speed, _)| speed).filter(|speed| *speed != 0);
        speed = commanded.or(speed);
        found.speeds.extend(commanded.filter(|speed| !found.speeds.contains(speed)));
        let rounded = inserted_arc(&mut corners, (index, &line), tool, has_radii);
        let is_governed = meaning.step.is_plain() || is_corner(meaning) || has_radii && is_along_contour(meaning);
        if !is_governed && is_along_contour(meaning) && line.segment().is_some_and(|segment| segment.arc().is_some()) {
            let (first, count) = found.without_radius.unwrap_or((index + 1, 0));
            found.without_radius = Some((first, count + 1));
        }
        let Some(segment) = line.segment().filter(|_| is_governed) else { continue };
        // A corner needs a smooth exit, too.
        if let (Some(last), Some(before)) = (found.arcs.last_mut(), &before)
            && before.arc().is_some()
        {
            last.is_corner = last.is_corner && joins_smoothly(before, &segment);
        }
        found.arcs.extend(rounded);
        if let Some(arc) = segment.arc() {
            let is_corner = before.as_ref().is_some_and(|before| joins_smoothly(before, &segment));
            found.arcs.push(FoundArc { tool, is_corner, ..FoundArc::new(index + 1, &segment, arc) });
        }
        found.add_use(tool, speed, &segment);
        found.lines += usize::from(segment.path == Path::Line);
        before = Some(segment);
    }
    found.notes = notes.finish();
    found
}

/// Whether the radii of D are known, from the settings or the program, so that laws can govern moves under G41 and G42.
fn has_radii(program: &Program) -> bool {
    let (settings, tables) = (program.control.settings(), program.control.tables());
    let sets_radius = |block: &Block| {
        let has = |letter: u8, value: i64| {
            block.words.iter().any(|word| word.letter == letter && word.number.as_whole() == Some(value))
        };
        has(b'G', 10) && has(b'L', 12)
    };
    settings.compensation.of_program == CompensationType::Wear
        || tables.radii.iter().any(|radius| *radius != [Nm(0); 2])
        || blocks(program).any(|(_, block)| sets_radius(&block))
}

fn is_along_contour(meaning: &InterpretedLine) -> bool {
    matches!(meaning.step.beyond_plain, Some(NotModelled::MoveUnder(410 | 420)))
}

/// Whether a chamfer or rounded corner outside compensated contours is at one of the ends of its move.
fn is_corner(meaning: &InterpretedLine) -> bool {
    meaning.step.beyond_plain == Some(NotModelled::Corner)
}

/// Rounded corner before the move of a line, given with its index; `has_radii`: also under G41 and G42.
fn inserted_arc(
    corners: &mut CornerMoves,
    (index, line): (usize, &ProgramLine),
    tool: Option<i64>,
    has_radii: bool,
) -> Option<FoundArc> {
    let meaning = line.meaning.as_ref()?;
    let is_followed = meaning.step.is_plain() || is_corner(meaning) || has_radii && is_along_contour(meaning);
    if !is_followed {
        *corners = CornerMoves::default();
        return None;
    }
    let [before, _] = corners.pass(index, meaning);
    let (before, corner) = before?;
    let segment = corner.inserted?;
    Some(FoundArc { tool, is_corner: true, ..FoundArc::new(before + 1, &segment, segment.arc()?) })
}

impl Survey {
    /// Warns on stderr of a unit that is assumed by the program's text.
    pub fn warn_of_unit(&self, path: &FilePath) {
        // Without evidence the unit is asked for.
        if let Some(assumed) = self.assumed.as_ref().filter(|assumed| assumed.likely.is_some()) {
            note(format_args!("{}:{}", path.display(), assumed.warning()));
        }
    }

    /// Checks that outside arcs are not to be fed faster if the program mirrors an axis: there, an arc that looks
    /// like an outside arc may run inside.
    ///
    /// # Errors
    /// The place, and what to do.
    pub fn check_max(&self, path: &FilePath, max_percent: Option<u16>) -> Result<(), String> {
        match self.mirrored.filter(|_| max_percent.is_some()) {
            None => Ok(()),
            Some(line) => Err(format!(
                "{}:{line}: --max: the program mirrors an axis here, which exchanges the directions of inside and outside arcs; leave \
                 --max out, or name the arcs of each direction by `lines` in a job file (docs/job.md)",
                path.display()
            )),
        }
    }

    /// Speeds and feeds of a tool.
    pub fn use_of(&self, tool: Option<i64>) -> Option<&SurveyedTool> {
        self.uses.iter().find(|used| used.tool == tool)
    }

    fn add_use(&mut self, tool: Option<i64>, speed: Option<i64>, segment: &Segment) {
        if segment.path == Path::Rapid {
            return;
        }
        each_extreme(segment, &Pose::ORIGIN, |axis, reached| {
            if let Some(extent) = self.extents_mm.get_mut(axis) {
                let [low, high] = extent.get_or_insert(reached);
                (*low, *high) = (low.min(reached[0]), high.max(reached[1]));
            }
        });
        let index = self.uses.iter().position(|used| used.tool == tool).unwrap_or_else(|| {
            self.uses.push(SurveyedTool { tool, ..SurveyedTool::default() });
            self.uses.len() - 1
        });
        let used = &mut self.uses[index];
        used.speeds.extend(speed.filter(|speed| !used.speeds.contains(speed)));
        used.feed_max = used.feed_max.max(feed_of(segment));
    }
}

fn feed_of(segment: &Segment) -> Option<Nm> {
    match segment.feed {
        Feed::PerMinute(feed) => Some(feed),
        Feed::InverseTime(_) | Feed::Missing => None,
    }
}

impl FoundArc {
    fn new(line: usize, segment: &Segment, arc: &Arc) -> Self {
        let [_, _, level] = segment.start.linear;
        FoundArc {
            line,
            sequence: segment.sequence,
            plane: arc.plane,
            turn: arc.turn,
            radius_mm: arc.radius_mm(),
            sweep_rad: arc.sweep_rad(),
            level,
            rises: segment.rise() != Nm(0),
            feed: feed_of(segment),
            tool: None,
            is_corner: false,
        }
    }
}

fn blocks(program: &Program) -> impl Iterator<Item = (usize, Block)> {
    (1..).zip(program.lines()).filter_map(|(number, line)| Some((number, line.meaning?.parsed.block)))
}

fn unit_of(block: &Block) -> Option<LengthUnit> {
    block.words.iter().filter(|word| word.letter == b'G').find_map(|word| match word.number.as_whole() {
        Some(20) => Some(LengthUnit::Inch),
        Some(21) => Some(LengthUnit::Mm),
        _ => None,
    })
}

fn mirrors(block: &Block) -> bool {
    let has =
        |tenths: i64| block.words.iter().any(|word| word.letter == b'G' && word.number.as_tenths() == Some(tenths));
    let is_negative = block.words.iter().any(|word| b"IJKP".contains(&word.letter) && word.number.is_negative());
    has(511) || has(510) && is_negative
}

fn is_change(block: &Block) -> bool {
    block.words.iter().any(|word| word.letter == b'M' && word.number.as_whole() == Some(6))
}

/// One cutting move continues in the direction in which the other ends.
fn joins_smoothly(before: &Segment, after: &Segment) -> bool {
    let (Some(out), Some(into)) = (direction(before, 1.0), direction(after, 0.0)) else { return false };
    let dot: f64 = out.iter().zip(&into).map(|(a, b)| a * b).sum();
    before.end == after.start && dot > SMOOTH_COSINE
}

/// Unit direction of a cutting move at the fraction `ratio` of its path; for arcs without the part across the plane.
fn direction(segment: &Segment, ratio: f64) -> Option<[f64; 3]> {
    match &segment.path {
        Path::Rapid => None,
        Path::Line => {
            let length = segment.length_mm();
            let part = |axis: usize| (segment.end.linear[axis].to_mm() - segment.start.linear[axis].to_mm()) / length;
            (length > 0.0).then(|| [0, 1, 2].map(part))
        }
        Path::Arc(arc) => {
            let (first, second, _) = arc.plane.axes();
            let ([x, y], sign) = (arc.direction_at(ratio), f64::from(arc.turn.sign()));
            let mut tangent = [0.0; 3];
            (tangent[first], tangent[second]) = (-sign * y, sign * x);
            Some(tangent)
        }
    }
}
