//! Moves of the tool centre under G41 and G42, and moves beside a chamfer or rounded corner, line by line, as a control
//! executes them.
//!
//! The end of a move depends on the corner behind it. Therefore this reader is ahead of the lines that are planned, by as
//! many blocks as a control reads together. A block-delete switch (`/`) may change the corners of a contour, and a chamfer or
//! rounded corner (`,C`, `,R`) does, so the rest of a contour from such a block on is not known.

use std::collections::VecDeque;

use arcfeed_compensation::compensator::{CenterMove, CenterMoves, Compensator};
use arcfeed_compensation::contour::{ContourCommand, side_sign};
use arcfeed_model::cut::{ContourSide, Work};
use arcfeed_model::job::{Job, LawKind};
use arcfeed_model::tool::Tool;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::settings::CompensationType;
use arcfeed_nc::word::is_mark;
use arcfeed_units::Nm;

use super::reason::PlanReason;
use crate::program::{CornerMove, CornerMoves};

/// Path of the tool centre for the move of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CenterPath {
    /// Not one along a contour, or not known.
    #[default]
    None,
    /// The D in force has no radius.
    NoRadius,
    /// Known.
    Known(OffsetMove),
    /// Beside a chamfer or rounded corner, without G41 and G42.
    Corner(CornerMove),
}

/// Move of the tool centre along a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetMove {
    /// The move, in the coordinates of the path.
    pub segment: Segment,
    /// Conditions of its law.
    pub place: ContourPlace,
}

/// Conditions of a move along a contour that its segment does not show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourPlace {
    /// Side of the contour on which the tool runs, on an arc.
    pub side: Option<ContourSide>,
    /// Moves around a corner precede it, with its feed.
    pub has_corner: bool,
    /// Radius of the D in force.
    pub radius: Nm,
    /// Meaning of that radius.
    pub of_program: CompensationType,
}

impl ContourPlace {
    /// Whether the radius of D fits a tool: it is the tool's within a quarter, or wear of at most a quarter of it. Another one
    /// betrays a D of another tool, or the other meaning.
    pub fn fits(&self, tool_radius: Nm) -> bool {
        let expected = match self.of_program {
            CompensationType::Control => tool_radius.0,
            CompensationType::Wear => 0,
        };
        4 * (self.radius.0.abs() - expected).abs() <= tool_radius.0
    }

    /// Why the law of a rule does not govern a move here although its path is known.
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
}

impl<'a> OffsetMoves<'a> {
    /// Reader of these lines; `reader` is the control before the first.
    pub fn new(reader: Reader, lines: impl Iterator<Item = &'a [u8]> + 'a) -> Self {
        OffsetMoves {
            lines: Box::new(lines),
            compensator: Compensator::new(reader.settings().compensation),
            corners: CornerMoves::default(),
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

    /// The path for the move of the next line.
    pub fn take(&mut self) -> CenterPath {
        let is_open = |moves: &Self| {
            moves.corners.holds(moves.taken) || moves.held.front().is_some_and(|held| held.number == moves.taken)
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
        // A chamfer or rounded corner has the feed of its block, and is not among these moves.
        let is_other = self.line.parsed.block.delete.is_some() || self.line.step.corner.is_some();
        let is_other_contour = is_other && is_in_contour;
        if is_unknown || is_other_contour || (self.is_lost && sign != 0) {
            self.lose();
            return;
        }
        self.is_lost = false;
        if let Some(segment) = &self.line.segment {
            let is_start_up = command.offset != Nm(0) && !self.compensator.is_active();
            let is_along = was_in_contour && sign != 0 && !is_start_up;
            let place = is_along.then(|| self.place(segment, &command, sign));
            let number = self.taken + self.read.len() - 1;
            self.held.push_back(HeldLine { number, place });
        }
        match command.apply(self.line.segment.as_ref(), &mut self.compensator) {
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
                *entry = CenterPath::Corner(corner);
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
        ContourPlace { side, has_corner: false, radius, of_program }
    }

    /// Sets the paths of the lines whose moves come out of the compensator.
    fn release(&mut self, moves: &CenterMoves) {
        let mut has_corner = false;
        for center_move in moves {
            let CenterMove::Main(segment) = center_move else {
                has_corner = true;
                continue;
            };
            let Some(HeldLine { number, place }) = self.held.pop_front() else { return };
            let path = match place {
                None => None,
                Some(place) if place.radius == Nm(0) && place.of_program == CompensationType::Control => {
                    Some(CenterPath::NoRadius)
                }
                Some(place) => {
                    let place = ContourPlace { has_corner, ..place };
                    Some(CenterPath::Known(OffsetMove { segment: *segment, place }))
                }
            };
            if let (Some(entry), Some(path)) = (self.read.get_mut(number - self.taken), path) {
                *entry = path;
            }
            has_corner = false;
        }
    }

    fn end_held(&mut self) {
        match self.compensator.end_held() {
            Ok(moves) => self.release(&moves),
            Err(_) => self.lose(),
        }
        self.held.clear();
        self.corners = CornerMoves::default();
    }

    fn lose(&mut self) {
        self.compensator.reset();
        self.corners = CornerMoves::default();
        self.held.clear();
        self.is_lost = true;
    }
}
