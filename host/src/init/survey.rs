//! Survey of a program: units, speeds, tools, and its arcs with their distinguishing features.

use std::path::Path as FilePath;

use arcfeed_nc::block::Block;
use arcfeed_nc::modal::{Feed, Plane, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_nc::settings::{Settings, Tables};
use arcfeed_units::{LengthUnit, Nm};

use crate::program::{Program, check_line_count, read_bounded};

/// Two moves join smoothly if their directions agree to this (the cosine of two degrees).
const SMOOTH_COSINE: f64 = 0.9994;

/// Result of the survey.
#[derive(Clone, Debug)]
pub struct Survey {
    /// Unit of the first G20 or G21; `None` if the program leaves it to the control.
    pub unit: Option<LengthUnit>,
    /// Spindle speeds, in order of appearance.
    pub speeds: Vec<i64>,
    /// Loaded tools, in order of appearance.
    pub tools: Vec<i64>,
    /// Arcs, in order.
    pub arcs: Vec<FoundArc>,
    /// Straight cutting moves.
    pub lines: usize,
}

/// An arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundArc {
    /// Line, counted from 1.
    pub line: usize,
    /// N of its block.
    pub sequence: Option<i64>,
    /// Plane.
    pub plane: Plane,
    /// Sense.
    pub turn: Turn,
    /// Radius, mm.
    pub radius_mm: f64,
    /// Sweep, radians.
    pub sweep_rad: f64,
    /// Z at the start.
    pub level: Nm,
    /// The arc leads across its plane.
    pub rises: bool,
    /// Feed per minute.
    pub feed: Option<Nm>,
    /// Cutting tool.
    pub tool: Option<i64>,
    /// The cutting moves before and after it join smoothly: a rounded corner of a contour.
    pub is_corner: bool,
}

/// Reads and surveys a program file, for a control with these settings.
///
/// # Errors
/// The file cannot be read, or is too long: in words, with its path.
pub fn load(path: &FilePath, settings: Settings, tables: Tables) -> Result<(Program, Survey), String> {
    let bytes = read_bounded(path)?;
    check_line_count(path, &bytes)?;
    let read = |unit| Program::parse_with(path, &bytes, Settings { unit, ..settings }, tables);
    let mut program = read(LengthUnit::Inch);
    let unit = blocks(&program).find_map(|(_, block)| unit_of(block));
    if unit == Some(LengthUnit::Mm) {
        program = read(LengthUnit::Mm);
    }
    let survey = survey(&program, unit);
    Ok((program, survey))
}

fn survey(program: &Program, unit: Option<LengthUnit>) -> Survey {
    let mut found = Survey { unit, speeds: Vec::new(), tools: Vec::new(), arcs: Vec::new(), lines: 0 };
    // Without M6 a T word is the change itself.
    let has_changes = blocks(program).any(|(_, block)| is_change(block));
    let (mut chosen, mut tool) = (None, None);
    let mut before: Option<Segment> = None;
    for (index, line) in program.lines.iter().enumerate() {
        let Some(meaning) = &line.meaning else { continue };
        let block = &meaning.parsed.block;
        chosen = block.word(b'T').and_then(|word| word.number.as_whole()).or(chosen);
        if chosen != tool && (is_change(block) || !has_changes) {
            tool = chosen;
            found.tools.extend(tool.filter(|tool| !found.tools.contains(tool)));
        }
        let speed = meaning.step.spindle.map(|(speed, _)| speed).filter(|speed| *speed != 0);
        found.speeds.extend(speed.filter(|speed| !found.speeds.contains(speed)));
        let Some(segment) = line.segment().filter(|_| meaning.step.is_plain()) else { continue };
        // A corner needs a smooth exit, too.
        if let (Some(last), Some(before)) = (found.arcs.last_mut(), &before)
            && before.arc().is_some()
        {
            last.is_corner = last.is_corner && joins_smoothly(before, &segment);
        }
        if let Some(arc) = segment.arc() {
            let is_corner = before.as_ref().is_some_and(|before| joins_smoothly(before, &segment));
            found.arcs.push(FoundArc { tool, is_corner, ..FoundArc::new(index + 1, &segment, arc) });
        }
        found.lines += usize::from(segment.path == Path::Line);
        before = Some(segment);
    }
    found
}

impl FoundArc {
    fn new(line: usize, segment: &Segment, arc: &Arc) -> Self {
        let [_, _, level] = segment.start.linear;
        let feed = match segment.feed {
            Feed::PerMinute(feed) => Some(feed),
            Feed::InverseTime(_) | Feed::Missing => None,
        };
        FoundArc {
            line,
            sequence: segment.sequence,
            plane: arc.plane,
            turn: arc.turn,
            radius_mm: arc.radius_mm(),
            sweep_rad: arc.sweep_rad(),
            level,
            rises: segment.rise() != Nm(0),
            feed,
            tool: None,
            is_corner: false,
        }
    }
}

fn blocks(program: &Program) -> impl Iterator<Item = (usize, &Block)> {
    program.lines.iter().enumerate().filter_map(|(index, line)| Some((index + 1, &line.meaning.as_ref()?.parsed.block)))
}

fn unit_of(block: &Block) -> Option<LengthUnit> {
    block.words.iter().filter(|word| word.letter == b'G').find_map(|word| match word.number.as_whole() {
        Some(20) => Some(LengthUnit::Inch),
        Some(21) => Some(LengthUnit::Mm),
        _ => None,
    })
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
