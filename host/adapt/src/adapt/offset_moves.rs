//! Moves of the tool centre under G41 and G42, and moves beside a chamfer or rounded corner, line by line, as a control
//! executes them.
//!
//! The end of a move depends on the corner behind it. Therefore this reader is ahead of the lines that are planned, by as
//! many blocks as a control reads together. A chamfer or rounded corner (`,C`, `,R`) is inserted into the contour before the
//! offset, as the control does. A block-delete switch (`/`) may change the corners of a contour, so the rest of a contour from
//! such a block on is not known.

use std::collections::VecDeque;

use arcfeed_compensation::compensator::{CenterMove, CenterMoves, Compensator};
use arcfeed_compensation::contour::{ContourCommand, side_sign};
use arcfeed_compensation::insertion::InsertedCorner;
use arcfeed_compensation::inside_arc::{PPM, feed_ratio_ppm};
use arcfeed_model::cut::{ContourSide, Work};
use arcfeed_model::job::{Job, LawKind};
use arcfeed_model::tool::Tool;
use arcfeed_nc::modal::Corner;
use arcfeed_nc::motion::Pose;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_nc::settings::CompensationType;
use arcfeed_nc::word::is_mark;
use arcfeed_units::Nm;

use super::reason::PlanReason;
use crate::program::{CornerMove, CornerMoves};

/// Path of the tool centre for the move of one line.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum CenterPath {
    /// The line has no move along a compensated contour, or its path is not known.
    #[default]
    None,
    /// The line is under G41 or G42, and the D in force has no radius.
    NoRadius,
    /// Move of the tool centre along a contour under G41 or G42.
    Known(Box<OffsetMove>),
    /// Move next to a chamfer or rounded corner, without G41 and G42.
    Corner(Box<CornerMove>),
}

/// Move of the tool centre along a contour, under cutter compensation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetMove {
    /// Move of the tool centre, in workpiece coordinates.
    pub segment: Segment,
    /// Conditions for the law that the segment does not contain.
    pub place: ContourPlace,
    /// Chamfer or rounded corner after the move, which has the F of the same block; `None` without one.
    pub inserted: Option<InsertedMove>,
    /// Move along the contour as programmed, up to the inserted corners.
    pub programmed: Segment,
}

/// Chamfer or rounded corner of a contour, as a move of the tool centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InsertedMove {
    /// Move of the tool centre along the corner, in workpiece coordinates.
    pub segment: Segment,
    /// Conditions for the law that the segment does not contain.
    pub place: ContourPlace,
}

/// Conditions of a move under cutter compensation that its segment does not contain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourPlace {
    /// For an arc: whether the tool runs inside or outside it; `None` for a line.
    pub side: Option<ContourSide>,
    /// The control inserts moves around a corner before this move, with the same F.
    pub has_corner: bool,
    /// Radius stored for the D in force.
    pub radius: Nm,
    /// Whether that radius is the tool's radius, or only its wear (the program then contains the radius).
    pub of_program: CompensationType,
    /// Feed on the move divided by F: below 1 where the control itself reduces the feed of an inside arc.
    pub feed_ratio: f64,
}

impl OffsetMove {
    /// Part of the programmed line that is parallel to the path of the tool centre: both ends projected on the line.
    pub fn beside_contour(&self) -> Segment {
        let [from, to] = [self.programmed.start, self.programmed.end].map(|pose| pose.linear.map(Nm::to_mm));
        let along: [f64; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
        let square: f64 = along.iter().map(|part| part * part).sum();
        let at = |pose: Pose| {
            let point = pose.linear.map(Nm::to_mm);
            let dot: f64 = (0..3).map(|axis| (point[axis] - from[axis]) * along[axis]).sum();
            let ratio = (dot / square).clamp(0.0, 1.0);
            Pose { linear: std::array::from_fn(|axis| Nm::from_mm(from[axis] + ratio * along[axis])), ..pose }
        };
        Segment { start: at(self.segment.start), end: at(self.segment.end), path: Path::Line, ..self.programmed }
    }
}

impl ContourPlace {
    /// Whether the radius of D belongs to this tool: it is the tool's radius within a quarter, or a wear of at most a quarter of it.
    /// Otherwise D probably is that of another tool, or the radius has the other meaning.
    pub fn fits(&self, tool_radius: Nm) -> bool {
        let expected = match self.of_program {
            CompensationType::Control => tool_radius.0,
            CompensationType::Wear => 0,
        };
        4 * (self.radius.0.abs() - expected).abs() <= tool_radius.0
    }

    /// Reason why the law of the cut rule with the index `rule` does not govern this move although its path is known; `None` if it does.
    pub fn fault(&self, job: &Job, rule: usize) -> Option<PlanReason> {
        let rule = job.rules.get(rule)?;
        let setup = job.tool_of(rule);
        let (Tool::EndMill(mill), Work::Mill { .. }) = (&setup.tool, &rule.work) else {
            return Some(PlanReason::Special);
        };
        match setup.law {
            _ if !self.fits(mill.radius) => Some(PlanReason::OtherRadius),
            LawKind::Contour { .. } => None,
            LawKind::Engagement if !self.has_corner => None,
            _ => Some(PlanReason::Special),
        }
    }
}

/// Reader of a program that is ahead of the lines planned.
pub(super) struct OffsetMoves<'a> {
    lines: Box<dyn Iterator<Item = &'a [u8]> + 'a>,
    reader: Reader,
    compensator: Compensator,
    corners: CornerMoves,
    line: InterpretedLine,
    /// Lines read and not yet taken.
    read: VecDeque<CenterPath>,
    /// Lines taken.
    taken: usize,
    /// Move of a contour that waits for the one behind its corner.
    cornered: Option<CorneredLine>,
    /// Moves in the compensator.
    held: VecDeque<HeldLine>,
    has_begun: bool,
    has_ended: bool,
    /// The rest of the contour is not known.
    is_lost: bool,
}

/// Line whose move is in the compensator.
#[derive(Clone, Copy, Debug)]
struct HeldLine {
    /// Number of the line, from 0.
    number: usize,
    /// Conditions, for a move along a contour.
    place: Option<ContourPlace>,
    /// The move as programmed.
    programmed: Segment,
    /// Whether it is the chamfer or rounded corner behind the line's own move.
    is_inserted: bool,
}

/// Line that ends in a chamfer or rounded corner.
#[derive(Clone, Copy, Debug)]
struct CorneredLine {
    held: HeldLine,
    command: ContourCommand,
    corner: Corner,
    /// Side of the contour on which the tool runs: 1 left, -1 right.
    sign: i8,
}

impl<'a> OffsetMoves<'a> {
    /// Offset moves of `lines`. `reader` has the modal state of the control before the first of them.
    pub fn new(reader: Reader, lines: impl Iterator<Item = &'a [u8]> + 'a) -> Self {
        OffsetMoves {
            lines: Box::new(lines),
            compensator: Compensator::new(reader.settings().compensation),
            corners: CornerMoves::default(),
            cornered: None,
            reader,
            line: InterpretedLine::default(),
            read: VecDeque::new(),
            taken: 0,
            held: VecDeque::new(),
            has_begun: false,
            has_ended: false,
            is_lost: false,
        }
    }

    /// Path of the tool centre for the move of the next line; called once for each line, in order.
    pub fn take(&mut self) -> CenterPath {
        let is_open = |moves: &Self| {
            moves.corners.holds(moves.taken)
                || moves.held.front().is_some_and(|held| held.number == moves.taken)
                || moves.cornered.is_some_and(|line| line.held.number == moves.taken)
        };
        while (self.read.is_empty() || is_open(self)) && self.read_next() {}
        self.taken += 1;
        self.read.pop_front().unwrap_or_default()
    }

    /// Reads a line; `false` behind the last.
    fn read_next(&mut self) -> bool {
        let Some(text) = self.lines.next() else {
            self.end_held();
            return false;
        };
        self.read.push_back(CenterPath::None);
        let is_end = self.has_begun && is_mark(text);
        self.has_begun |= text.iter().any(|byte| *byte > b' ');
        self.has_ended |= is_end;
        if self.has_ended {
            self.end_held();
            return true;
        }
        let was_in_contour = self.reader.modal().is_in_contour();
        if self.reader.read_into(text, &mut self.line).is_ok() {
            self.compensate(was_in_contour);
        } else {
            self.lose();
        }
        true
    }

    /// Passes the line that was read to the compensator.
    fn compensate(&mut self, was_in_contour: bool) {
        let command = ContourCommand::of(&self.line, self.reader.modal(), self.reader.tables());
        let sign = side_sign(self.reader.modal());
        let is_in_contour = sign != 0 || self.compensator.is_active();
        self.pass_corner(is_in_contour);
        let is_unknown = self.line.step.motion.is_some() && self.line.segment.is_none();
        let is_switched = self.line.parsed.block.delete.is_some() && is_in_contour;
        if is_unknown || is_switched || (self.is_lost && sign != 0) {
            self.lose();
            return;
        }
        self.is_lost = false;
        let Some(segment) = self.line.segment else {
            // A comment may stand between a corner and the move behind it.
            if self.cornered.is_some() && command.has_words {
                self.lose();
            } else {
                self.pass(&command, None);
            }
            return;
        };
        let Some(segment) = self.insert(&command, segment) else { return self.lose() };
        let is_start_up = command.offset != Nm(0) && !self.compensator.is_active();
        let is_along = was_in_contour && sign != 0 && !is_start_up;
        let place = is_along.then(|| self.place(&segment, &command, sign));
        let number = self.taken + self.read.len() - 1;
        let held = HeldLine { number, place, programmed: segment, is_inserted: false };
        match self.line.step.corner.filter(|_| is_in_contour) {
            Some(corner) => self.cornered = Some(CorneredLine { held, command, corner, sign }),
            None => self.pass(&command, Some(held)),
        }
    }

    /// Passes the move that waits for this one, and the corner between them; returns what the corner leaves of this move, and
    /// `None` where the control inserts none.
    fn insert(&mut self, command: &ContourCommand, segment: Segment) -> Option<Segment> {
        let Some(CorneredLine { held, command: before, corner, sign }) = self.cornered.take() else {
            return Some(segment);
        };
        let inserted = InsertedCorner::new(&held.programmed, &segment, command.plane, corner).ok()?;
        self.pass(&before, Some(HeldLine { programmed: inserted.first, ..held }));
        if let Some(between) = inserted.between {
            let place = held.place.map(|_| self.place(&between, &before, sign));
            self.pass(&before, Some(HeldLine { programmed: between, place, is_inserted: true, ..held }));
        }
        (!self.is_lost).then_some(inserted.second)
    }

    /// Passes a block, with its move, to the compensator.
    fn pass(&mut self, command: &ContourCommand, held: Option<HeldLine>) {
        self.held.extend(held);
        match command.apply(held.map(|held| held.programmed).as_ref(), &mut self.compensator) {
            Ok(moves) => self.release(&moves),
            Err(_) => self.lose(),
        }
    }

    /// Sets the moves beside corners that are known by now; those within a contour under compensation are not.
    fn pass_corner(&mut self, is_in_contour: bool) {
        if is_in_contour {
            self.corners = CornerMoves::default();
            return;
        }
        let number = self.taken + self.read.len() - 1;
        for (line, corner) in self.corners.pass(number, &self.line).into_iter().flatten() {
            if let Some(entry) = self.read.get_mut(line - self.taken) {
                *entry = CenterPath::Corner(Box::new(corner));
            }
        }
    }

    fn place(&self, segment: &Segment, command: &ContourCommand, sign: i8) -> ContourPlace {
        let of_program = self.reader.settings().compensation.of_program;
        // A program with the path of the tool centre names the tool's side; wear of either sign does not exchange it.
        let sign = match of_program {
            CompensationType::Control => command.offset.0.signum(),
            CompensationType::Wear => i64::from(sign),
        };
        let side = segment.arc().map(|arc| match i64::from(arc.turn.sign()) * sign {
            1 => ContourSide::Inside,
            _ => ContourSide::Outside,
        });
        let radius = self.reader.tables().radius(self.reader.modal().radius_offset);
        ContourPlace { side, has_corner: false, radius, of_program, feed_ratio: 1.0 }
    }

    /// Sets the paths of the lines whose moves come out of the compensator.
    fn release(&mut self, moves: &CenterMoves) {
        let mut has_corner = false;
        for center_move in moves {
            let CenterMove::Main(segment) = center_move else {
                has_corner = true;
                continue;
            };
            let Some(held) = self.held.pop_front() else { return };
            self.set_path(&held, segment, has_corner);
            has_corner = false;
        }
    }

    /// Sets the path of a line, or of the corner behind its move.
    fn set_path(&mut self, held: &HeldLine, segment: &Segment, has_corner: bool) {
        let least = self.reader.settings().compensation.inside_arc_least_percent;
        let Some((entry, place)) = self.read.get_mut(held.number - self.taken).zip(held.place) else { return };
        if place.radius == Nm(0) && place.of_program == CompensationType::Control {
            *entry = CenterPath::NoRadius;
            return;
        }
        let feed_ratio = f64::from(feed_ratio_ppm(&held.programmed, segment, least)) / f64::from(PPM);
        let (place, segment) = (ContourPlace { has_corner, feed_ratio, ..place }, *segment);
        match entry {
            CenterPath::Known(offset) if held.is_inserted => offset.inserted = Some(InsertedMove { segment, place }),
            entry => {
                let programmed = held.programmed;
                *entry = CenterPath::Known(Box::new(OffsetMove { segment, place, inserted: None, programmed }));
            }
        }
    }

    fn end_held(&mut self) {
        match self.compensator.end_held() {
            Ok(moves) => self.release(&moves),
            Err(_) => self.lose(),
        }
        self.clear_held();
    }

    /// Forgets the moves that wait, and those whose corner does.
    fn clear_held(&mut self) {
        for held in self.held.drain(..).filter(|held| held.is_inserted) {
            if let Some(entry) = self.read.get_mut(held.number - self.taken) {
                *entry = CenterPath::None;
            }
        }
        self.cornered = None;
        self.corners = CornerMoves::default();
    }

    fn lose(&mut self) {
        self.compensator.reset();
        self.clear_held();
        self.is_lost = true;
    }
}
