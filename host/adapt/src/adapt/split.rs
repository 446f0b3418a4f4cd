//! Division of one block into several, each with its own F (mode `rewrite-only`): for an arc or a plunge.
//!
//! The text of the pieces is read back as the control will read it: each piece must be a line, or an arc of the same sense
//! about the same centre, each must begin at the end of the one before, and the last must end at the programmed point. A move that does not
//! read back so, or cannot be written in pieces, stays whole and is sent with the least feed that the law demands on it.

use arcfeed_model::job::PieceSettings;
use arcfeed_nc::block::Block;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::reader::Reader;
use arcfeed_nc::segment::{Arc, Segment};
use arcfeed_nc::settings::ArcCenters;
use arcfeed_units::Nm;

use super::asked_cells::CELLS;
use super::modes::Modes;
use super::pieces::{self, Piece};
use super::points::{Divider, Grid, Part, axis_of, divide_line};
use super::profile::Profile;
use super::rewrite::{Edit, FeedRewriter, apply, round_down};
use super::spelling::{Spelling, WrittenShape, increment_nm};
use crate::program::ProgramLine;

/// Largest distance of a piece's centre from the arc's, nm: R and two points on the arc give it no better.
const CENTER_MAX_NM: i64 = 20_000;

/// Reason why a move is sent as one block although its law would have it divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whole {
    /// It is a line other than a plunge; only arcs and plunges are divided.
    Line,
    /// The block has words that several blocks cannot share: M, T, a variable, another G.
    Words,
    /// G51, G52 or G68 changes the program's coordinates, or G90.1 the meaning of I, J, K.
    Coordinates,
    /// No suitable points or centre can be expressed in the control's increments and digits.
    Digits,
    /// The text of the pieces, read back, is not the same move.
    ReadBack,
}

impl Whole {
    /// Name of the reason in tables and JSON.
    pub const fn label(self) -> &'static str {
        match self {
            Whole::Line => "line",
            Whole::Words => "words",
            Whole::Coordinates => "coordinates",
            Whole::Digits => "digits",
            Whole::ReadBack => "read-back",
        }
    }
}

/// Part of a divided move with its F.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SentPiece {
    /// End of the piece, as a fraction (0 to 1) of the move.
    pub until_ratio: f64,
    /// F of the piece, per minute.
    pub feed: Nm,
}

/// Relative error of the chip in a divided move: chip with the F of the pieces over the target chip, minus 1. Negative: the chip is
/// thinner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipError {
    /// Smallest value on the move.
    pub min: f64,
    /// Mean along the path.
    pub mean: f64,
    /// Largest value on the move; not above 0.
    pub max: f64,
}

/// Governed move as it is sent: as one block or as several.
#[derive(Clone, Debug, PartialEq)]
pub struct Split {
    /// Pieces of the move; at least one.
    pub pieces: Vec<SentPiece>,
    /// Text of each piece, without line ends.
    pub texts: Vec<Vec<u8>>,
    /// Reason why it is one block although the law would have it divided; `None` otherwise.
    pub whole: Option<Whole>,
}

/// Governed move with everything that is needed to write its blocks.
#[derive(Debug)]
pub struct Governed<'a> {
    /// Program line of the move.
    pub line: &'a ProgramLine,
    /// Move for which the law was evaluated.
    pub segment: &'a Segment,
    /// The plunge law governs the move.
    pub is_descent: bool,
    /// Law's demand along the move.
    pub profile: &'a Profile,
    /// Modes in force after the G words of the line.
    pub modes: Modes,
    /// State of the control before the line.
    pub before: &'a Reader,
    /// Number of teeth that pass in a minute.
    pub teeth_per_min: f64,
    /// Largest permitted ratio of a piece's feed to the smallest one.
    pub most_ratio: f64,
    /// Fastest feed that machine, control and the job's ceiling allow; infinite if nothing limits the move.
    pub limit_mm_per_min: f64,
}

impl Governed<'_> {
    /// Writes the blocks of the move. `rewriter` knows the F in force on the control, and is updated. `None` if the law has no finite
    /// demand.
    pub fn split(&self, settings: &PieceSettings, rewriter: &mut FeedRewriter) -> Option<Split> {
        let least = self.feed(self.profile.least()?);
        let mut after = *rewriter;
        match self.parts(settings).and_then(|parts| self.write(&parts, &mut after)) {
            Ok(split) => {
                *rewriter = after;
                Some(split)
            }
            Err(whole) => {
                let edit = rewriter.edit(self.line, Some(least), self.modes).ok()?;
                let pieces = vec![SentPiece { until_ratio: 1.0, feed: least }];
                Some(Split { pieces, texts: vec![apply(&self.line.text, edit.as_slice())], whole })
            }
        }
    }

    fn feed(&self, path_mm_per_tooth: f64) -> Nm {
        round_down((self.teeth_per_min * path_mm_per_tooth).min(self.limit_mm_per_min), self.modes.unit)
    }

    /// The pieces with their ends; an error where it stays whole, for a reason or because one feed does for all of it.
    fn parts(&self, settings: &PieceSettings) -> Result<Vec<Part>, Option<Whole>> {
        if self.profile.is_uniform() {
            return Err(None);
        }
        let plan = |settings: &PieceSettings| {
            let length_mm = self.segment.feed_length_mm();
            pieces::plan(self.profile, length_mm, settings, self.most_ratio)
                .filter(|pieces| pieces.len() > 1)
                .ok_or(None)
        };
        let axis = axis_of(self.segment).filter(|_| self.is_descent);
        if self.segment.arc().is_none() && axis.is_none() {
            return Err(plan(settings).is_ok().then_some(Whole::Line));
        }
        if !self.is_in_program() {
            return Err(plan(settings).is_ok().then_some(Whole::Coordinates));
        }
        let spelling = || self.spelling().ok_or(Some(Whole::Words));
        let Some(arc) = self.segment.arc() else {
            let pieces = plan(settings)?;
            spelling()?;
            let parts = axis.and_then(|axis| divide_line(self.segment, axis, self.grid(), pieces));
            return parts.filter(|parts| parts.len() > 1).ok_or(Some(Whole::Digits));
        };
        let divider = Divider::new(self.segment, arc, self.grid(), settings.least_length.to_mm());
        let longer = Nm::from_mm(settings.least_length.to_mm() + divider.allowance_mm());
        let pieces: Vec<Piece> = plan(&PieceSettings { least_length: longer, ..*settings })?;
        let parts = divider.divide(pieces, spelling()?.is_by_radius()).ok_or(Some(Whole::Digits))?;
        if parts.len() > 1 { Ok(parts) } else { Err(Some(Whole::Digits)) }
    }

    fn write(&self, parts: &[Part], rewriter: &mut FeedRewriter) -> Result<Split, Option<Whole>> {
        let spelling = self.spelling().ok_or(Some(Whole::Words))?;
        let rises = self.segment.rise() != Nm(0);
        let (mut texts, mut pieces, mut start) = (Vec::new(), Vec::new(), self.segment.start);
        for (index, Part { piece, end }) in parts.iter().enumerate() {
            let feed = self.feed(piece.path_mm_per_tooth);
            let text = if index == 0 {
                let mut edits: Vec<Edit> = spelling.first(&start, end, rises).ok_or(Some(Whole::Digits))?;
                edits.extend(rewriter.edit(self.line, Some(feed), self.modes).map_err(|_| Some(Whole::Words))?);
                apply(&self.line.text, &edits)
            } else {
                let words = spelling.later(&start, end, self.segment.arc(), rises).ok_or(Some(Whole::Digits))?;
                (words + &rewriter.added(feed, self.modes.unit)).into_bytes()
            };
            texts.push(text);
            pieces.push(SentPiece { until_ratio: piece.until_ratio, feed });
            start = *end;
        }
        if !self.reads_back(&texts, parts) {
            return Err(Some(Whole::ReadBack));
        }
        Ok(Split { pieces, texts, whole: None })
    }

    /// Whether the program's coordinates are the workpiece's, and I, J, K count from the arc's start.
    fn is_in_program(&self) -> bool {
        let mut reader = self.before.clone();
        let _understood = reader.read(&self.line.text);
        let frame = &reader.modal().frame;
        let is_from_start = reader.modal().arc_centers != ArcCenters::Absolute;
        is_from_start && frame.is_shift() && frame.shift() == self.line.origin
    }

    fn spelling(&self) -> Option<Spelling<'_>> {
        let shape = match self.segment.arc() {
            Some(arc) => WrittenShape::InPlane(arc.plane),
            None => WrittenShape::Line(axis_of(self.segment)?),
        };
        Spelling::of(&self.line.text, self.block()?, self.modes, shape)
    }

    fn block(&self) -> Option<&Block> {
        self.line.meaning.as_ref().map(|meaning| &meaning.parsed.block)
    }

    fn grid(&self) -> Grid {
        let origin = if self.modes.absolute { [Nm(0); 3] } else { self.segment.start.linear };
        Grid { step_nm: increment_nm(self.modes.unit), origin }
    }

    fn reads_back(&self, texts: &[Vec<u8>], parts: &[Part]) -> bool {
        let (mut reader, mut at) = (self.before.clone(), self.segment.start);
        let mut turned = 0.0;
        let as_meant = texts.iter().zip(parts).all(|(text, part)| {
            let Some(read) = reader.read(text).ok().and_then(|understood| understood.segment) else { return false };
            let segment = read.shifted(Pose::ORIGIN.minus(self.line.origin));
            let starts = segment.start == at;
            at = segment.end;
            turned += segment.arc().map_or(0.0, Arc::sweep_rad);
            let is_of_move = match (segment.arc(), self.segment.arc()) {
                (Some(piece), Some(arc)) => is_same_circle(piece, arc),
                _ => segment.path == self.segment.path,
            };
            starts && segment.end == part.end && is_of_move
        });
        let sweep_rad = self.segment.arc().map_or(0.0, Arc::sweep_rad);
        as_meant && at == self.segment.end && libm::fabs(turned - sweep_rad) < 1e-3
    }
}

/// Whether a piece runs on the circle of its arc.
fn is_same_circle(piece: &Arc, arc: &Arc) -> bool {
    let apart = |axis: usize| (piece.center[axis].0 - arc.center[axis].0).abs();
    piece.plane == arc.plane && piece.turn == arc.turn && apart(0).max(apart(1)) <= CENTER_MAX_NM
}

impl ChipError {
    /// Chip error of these pieces, each run with its F, against the demand in `profile`; `None` if the law has no demand anywhere.
    pub fn of(pieces: &[SentPiece], profile: &Profile, teeth_per_min: f64) -> Option<Self> {
        let (mut min, mut max, mut sum, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0);
        let mut from = 0.0;
        for SentPiece { until_ratio, feed } in pieces {
            let asked = profile.answers.iter().map(|(point, _)| point / CELLS as f64);
            let inside = asked.filter(|ratio| *ratio > from && ratio < until_ratio);
            let ratios: Vec<f64> = [from].into_iter().chain(inside).chain([*until_ratio]).collect();
            let error = |ratio: &f64| Some(feed.to_mm() / (teeth_per_min * profile.demand_at(*ratio)?) - 1.0);
            for ends in ratios.windows(2) {
                let errors = (error(&ends[0]), error(&ends[1]));
                for error in [errors.0, errors.1].into_iter().flatten() {
                    (min, max) = (min.min(error), max.max(error));
                }
                if let (Some(a), Some(b)) = errors {
                    let width = ends[1] - ends[0];
                    (sum, count) = (sum + 0.5 * (a + b) * width, count + width);
                }
            }
            from = *until_ratio;
        }
        (count > 0.0).then(|| ChipError { min, mean: (sum / count).clamp(min, max), max })
    }
}
