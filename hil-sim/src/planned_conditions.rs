//! Conditions of moves that only their plan knows, and how a move in execution is recognised as one of them.

use std::collections::VecDeque;

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_law::move_table::MoveTable;
use arcfeed_model::cut::ContourSide;
use arcfeed_model::machine::FeedLimit;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::{Arc, Path, RADIUS_TOLERANCE, Segment};
use arcfeed_units::{MmPerTooth, Nm};

/// Largest difference between the ends of a planned move and the executed one: a corner behind a divided line is computed
/// again from the rest of the line. Far below the least increments of controls.
const SAME_POINT_MAX: Nm = Nm(5);

/// Conditions of a move that only its plan knows, such as its engaged arcs or its largest feed.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedConditions {
    /// The move, in the workpiece's coordinates; it is recognised by its path, whatever its feed.
    pub segment: Segment,
    /// Index of the cut rule for the move in the job's list; `None` without a rule.
    pub rule: Option<usize>,
    /// Table along the move: engaged arcs for a rule that expects them with each move, or feeds for a move without a rule.
    pub along: Option<Box<MoveTable>>,
    /// Largest feed on the move; `None` if the limits of the job's axes and its ceiling apply.
    pub limit: Option<FeedLimit>,
    /// Largest override at the end of the move, %: the next move begins with it.
    pub end_percent: u8,
    /// Side of the contour on which the tool runs; only for a move under G41 or G42.
    pub side: Option<ContourSide>,
    /// Target chip load of this move; only for a tool whose target is the programmed feed.
    pub target: Option<MmPerTooth>,
}

impl PlannedConditions {
    fn is_of(&self, segment: &Segment) -> bool {
        let own = &self.segment;
        is_same_point(&own.start, &segment.start)
            && is_same_point(&own.end, &segment.end)
            && is_same_path(&own.path, &segment.path)
    }

    /// Whether a move is this one, or the first piece of it.
    pub(crate) fn is_at(&self, segment: &Segment, is_in_pieces: bool) -> bool {
        self.is_of(segment) || is_in_pieces && self.begins_with(segment)
    }

    fn begins_with(&self, segment: &Segment) -> bool {
        let (Some(own), Some(arc)) = (self.segment.arc(), segment.arc()) else { return false };
        is_same_point(&self.segment.start, &segment.start) && is_same_circle(own, arc)
    }

    /// Conditions of the first piece of its arc: those that do not depend on where the move ends.
    fn of_piece(self) -> Self {
        let end_percent = FeedOverride::PROGRAMMED.percent;
        PlannedConditions { along: None, limit: None, end_percent, side: None, target: None, ..self }
    }
}

/// Takes the next of these moves that equals this one, or of which it is the first piece; discards those before it.
pub(crate) fn take_planned(
    ahead: &mut VecDeque<PlannedConditions>,
    segment: &Segment,
    is_in_pieces: bool,
) -> Option<PlannedConditions> {
    let at = ahead.iter().position(|known| known.is_at(segment, is_in_pieces))?;
    let known = ahead.drain(..=at).next_back()?;
    Some(if known.is_of(segment) { known } else { known.of_piece() })
}

/// Whether an arc is the next piece of another: it has no N, begins where the other ended, and continues about the same
/// centre. A piece belongs to its arc's rule, whatever N and level the rule requires.
pub(crate) fn continues(last: &Segment, next: &Segment) -> bool {
    let (Some(before), Some(arc)) = (last.arc(), next.arc()) else { return false };
    next.sequence.is_none() && next.start == last.end && is_same_circle(before, arc)
}

/// Whether two poses are the same point, but for the rounding of corners.
fn is_same_point(one: &Pose, other: &Pose) -> bool {
    let mut linear = one.linear.iter().zip(&other.linear);
    one.rotary == other.rotary && linear.all(|(a, b)| (a.0 - b.0).abs() <= SAME_POINT_MAX.0)
}

/// Whether two moves between the same points have the same path, but for the rounding of corners.
fn is_same_path(one: &Path, other: &Path) -> bool {
    match (one, other) {
        (Path::Arc(one), Path::Arc(other)) => {
            is_same_circle(one, other) && (one.from == one.to) == (other.from == other.to)
        }
        _ => one == other,
    }
}

/// Whether two arcs run about the same centre in the same sense.
fn is_same_circle(one: &Arc, other: &Arc) -> bool {
    let is_near = |a: Nm, b: Nm| (a.0 - b.0).abs() <= RADIUS_TOLERANCE.0;
    let mut centers = one.center.iter().zip(&other.center);
    (one.plane, one.turn) == (other.plane, other.turn) && centers.all(|(a, b)| is_near(*a, *b))
}
