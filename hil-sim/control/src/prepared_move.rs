//! Moves with the limits of the axes on them and in the corners between: the move in execution and those behind it.

use std::collections::VecDeque;

use arcfeed_model::machine::ArcClamp;
use arcfeed_nc::segment::Segment;
use arcfeed_units::PERCENT;

use crate::drives::brake::time_s;
use crate::drives::limits::{AXES, DriveLimits, PathLimits};

use super::action::{Action, MoveContext, ReadBlock};
use super::feeds::{FeedConditions, speed_max_mm_per_s};
use super::junction::Junction;
use super::path::Travel;
use super::signals::OVERRIDE_MAX_PERCENT;

/// Move with the limits that the axes set on it.
#[derive(Clone, Debug)]
pub struct PreparedMove {
    /// Path of the move.
    pub travel: Travel,
    /// Limits on the part of the move between its corners.
    pub limits: PathLimits,
    /// Corner at the beginning; `None` if the axes stop before this move.
    pub entry: Option<Corner>,
    /// Largest speed at the beginning, for the trapezoid planner, which passes corners with a permitted step of speed.
    pub corner_mm_per_s: f64,
    /// Largest speed of the move, whatever its feed.
    speed_max_mm_per_s: f64,
}

/// Settings of a control that limit all moves.
#[derive(Clone, Copy, Debug)]
pub struct MoveLimits<'a> {
    /// Limits of the axes; `None` without data of the drives.
    pub drives: Option<&'a DriveLimits>,
    /// The control's own clamp of the feed on arcs; `None` if it has none.
    pub arc_clamp: Option<&'a ArcClamp>,
    /// Speed of rapids (G0).
    pub rapid_mm_per_s: f64,
    /// Speed of cutting moves in dry run.
    pub dry_run_mm_per_s: f64,
}

/// Rounded corner between two moves, with the limits that the axes set in it.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Rounding of the corner.
    pub junction: Junction,
    /// Limits in the corner.
    pub limits: PathLimits,
}

/// Block that the control has read ahead.
#[derive(Clone, Debug)]
pub struct QueuedBlock {
    /// The block.
    pub block: ReadBlock,
    /// Prepared move of the block; `None` if it makes none.
    pub prepared: Option<PreparedMove>,
}

/// The move in execution.
#[derive(Clone, Debug)]
pub struct ActiveMove {
    /// The move.
    pub prepared: PreparedMove,
    /// Distance already travelled on the move.
    pub done_mm: f64,
    /// Count of executed blocks, this one included.
    pub count: u32,
    /// Context of the move.
    pub context: MoveContext,
    /// Whether the move ends at rest even if the next block could follow without a stop.
    pub ends_at_rest: bool,
}

/// Result of an advance in time on the move in execution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Advance {
    /// The move is not over: distance from its beginning, mm, and time left over, s.
    To(f64, f64),
    /// The move is over; time left over, s.
    Over(f64),
}

impl PreparedMove {
    /// Prepares a move that begins at rest. Without data of the drives, no axis limits its speed.
    pub fn new(segment: Segment, limits: &MoveLimits<'_>) -> Self {
        let MoveLimits { drives, arc_clamp, rapid_mm_per_s, dry_run_mm_per_s } = *limits;
        let travel = Travel::new(segment);
        let fastest = f64::from(OVERRIDE_MAX_PERCENT) / f64::from(PERCENT);
        let programmed = travel.programmed_mm_per_s;
        let most = programmed.map_or(f64::INFINITY, |speed| (speed * fastest).max(dry_run_mm_per_s));
        let limits = drives.filter(|_| travel.length_mm > 0.0).map(|drives| drives.along(&travel.bend(), most));
        let speed_max_mm_per_s = speed_max_mm_per_s(&travel, arc_clamp, rapid_mm_per_s);
        let limits = limits.unwrap_or(PathLimits::NONE);
        PreparedMove { travel, limits, entry: None, corner_mm_per_s: 0.0, speed_max_mm_per_s }
    }

    /// Joins the move to the one before by a rounded corner without a stop, unless stopping between them is faster.
    pub fn join(&mut self, before: &PreparedMove, drives: &DriveLimits) {
        // A path in degrees does not continue in millimetres.
        if before.travel.is_rotary() != self.travel.is_rotary() || self.travel.length_mm == 0.0 {
            return;
        }
        let junction = Junction::new(&before.travel, &self.travel, drives);
        let bend = junction.bend(&before.travel, &self.travel);
        let most = before.limits.speed.min(self.limits.speed);
        let corner = Corner { junction, limits: drives.along(&bend, most) };
        let [flowing_s, stopping_s] = [Some(&corner), None].map(|corner| before.half_s(corner) + self.half_s(corner));
        self.entry = (flowing_s <= stopping_s).then_some(corner);
    }

    /// Time from the corner, or from rest at the move's end, to the middle of the move, at the programmed feed.
    fn half_s(&self, corner: Option<&Corner>) -> f64 {
        let most = self.travel.programmed_mm_per_s.unwrap_or(f64::INFINITY).min(self.limits.speed);
        let (half_mm, speed) =
            corner.map_or((0.0, 0.0), |corner| (corner.junction.half_mm, corner.limits.speed.min(most)));
        let rounding_s = if half_mm > 0.0 { half_mm / speed } else { 0.0 };
        rounding_s + time_s(speed, 0.5 * self.travel.length_mm - half_mm, most, &self.limits)
    }

    /// Speed, mm/s along the path, that the programmed feed asks for under these conditions, after the control's own limits.
    pub fn wanted(&self, context: &MoveContext, conditions: &FeedConditions) -> f64 {
        let speed = |programmed| {
            let asked = conditions.for_context(context).speed_mm_per_s(programmed) * context.feed_ratio();
            asked.min(self.speed_max_mm_per_s)
        };
        self.travel.programmed_mm_per_s.map_or(self.speed_max_mm_per_s, speed)
    }
}

impl ActiveMove {
    /// Remaining distance of the move.
    pub fn left_mm(&self) -> f64 {
        self.prepared.travel.length_mm - self.done_mm
    }

    /// Position of the axes: X, Y, Z in mm, A, B, C in degrees.
    pub fn axes(&self, queue: &VecDeque<QueuedBlock>) -> [f64; AXES] {
        let mut axes = self.prepared.travel.axes_at(self.done_mm / self.prepared.travel.length_mm);
        let exit =
            flowing(queue).next().and_then(|(prepared, _)| prepared.entry).map(|corner| (corner, -self.left_mm()));
        for (corner, way) in self.prepared.entry.map(|corner| (corner, self.done_mm)).into_iter().chain(exit) {
            if way.abs() < corner.junction.half_mm {
                let added = corner.junction.rounding(way);
                axes.iter_mut().zip(added).for_each(|(axis, added)| *axis += added);
            }
        }
        axes
    }
}

impl QueuedBlock {
    /// Whether the axes move through this block without a stop.
    pub fn flows(&self) -> bool {
        matches!(self.block.action, Action::Move(_, None) | Action::Corner(_) | Action::Nothing | Action::Ignore(_))
    }
}

/// The moves behind the one in execution that follow without a stop, each with its context.
pub fn flowing(queue: &VecDeque<QueuedBlock>) -> impl Iterator<Item = (&PreparedMove, &MoveContext)> {
    let blocks = queue.iter().take_while(|queued| queued.flows());
    blocks.filter_map(|queued| Some((queued.prepared.as_ref()?, &queued.block.context)))
}
