//! Moves on their way: the one in work, those behind it, and what the axes allow on them and in the corners between.

use std::collections::VecDeque;

use arcfeed_shared::machine::ArcClamp;
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::PERCENT;

use crate::drives::brake::time_s;
use crate::drives::limits::{AXES, DriveLimits, PathLimits};

use super::action::{Action, MoveContext, ReadBlock};
use super::feeds::{FeedConditions, most_mm_per_s};
use super::junction::Junction;
use super::path::Travel;
use super::signals::OVERRIDE_MAX_PERCENT;

/// A move, with what the axes allow on it.
#[derive(Clone, Debug)]
pub struct Leg {
    /// The path.
    pub travel: Travel,
    /// Between its corners.
    pub limits: PathLimits,
    /// The corner at its beginning, if the move before flows into it.
    pub entry: Option<Corner>,
    /// Greatest speed at its beginning, where corners are passed with a jump of speed.
    pub corner_mm_per_s: f64,
    /// The most that the control runs it with, whatever its feed.
    most_mm_per_s: f64,
}

/// What a control is set to that limits all moves.
#[derive(Clone, Copy, Debug)]
pub struct MoveLimits<'a> {
    /// Of the axes.
    pub drives: Option<&'a DriveLimits>,
    /// The control's clamp on arcs.
    pub arc_clamp: Option<&'a ArcClamp>,
    /// Speed at G0.
    pub rapid_mm_per_s: f64,
    /// Speed of cutting moves in dry run.
    pub dry_run_mm_per_s: f64,
}

/// A corner, with what the axes allow in it.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Its rounding.
    pub junction: Junction,
    /// In it.
    pub limits: PathLimits,
}

/// A block read ahead.
#[derive(Clone, Debug)]
pub struct Queued {
    /// The block.
    pub block: ReadBlock,
    /// Its move, if it makes one.
    pub leg: Option<Leg>,
}

/// The move in work.
#[derive(Clone, Debug)]
pub struct Active {
    /// The move.
    pub leg: Leg,
    /// How far it is done.
    pub done_mm: f64,
    /// Blocks executed, up to and including its own.
    pub count: u32,
    /// What holds for it.
    pub context: MoveContext,
    /// Whether nothing flows from it into the next block.
    pub ends_at_rest: bool,
}

/// What a stretch of time comes to on the move in work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Advance {
    /// It goes on from there, in mm from its beginning; the time left, s.
    To(f64, f64),
    /// It is over; the time left, s.
    Over(f64),
}

impl Leg {
    /// A move that begins at rest; without drives nothing limits it.
    pub fn new(segment: Segment, limits: &MoveLimits<'_>) -> Self {
        let MoveLimits { drives, arc_clamp, rapid_mm_per_s, dry_run_mm_per_s } = *limits;
        let travel = Travel::new(segment);
        let fastest = f64::from(OVERRIDE_MAX_PERCENT) / f64::from(PERCENT);
        let programmed = travel.programmed_mm_per_s;
        let most = programmed.map_or(f64::INFINITY, |speed| (speed * fastest).max(dry_run_mm_per_s));
        let limits = drives.filter(|_| travel.length_mm > 0.0).map(|drives| drives.along(&travel.bend(), most));
        let most_mm_per_s = most_mm_per_s(&travel, arc_clamp, rapid_mm_per_s);
        let limits = limits.unwrap_or(PathLimits::NONE);
        Leg { travel, limits, entry: None, corner_mm_per_s: 0.0, most_mm_per_s }
    }

    /// Lets the move before flow into it, where that is faster than to stop between them.
    pub fn join(&mut self, before: &Leg, drives: &DriveLimits) {
        // Degrees do not go on as millimetres.
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

    /// The time from a corner, or from rest at its end, to its middle, at the programmed feed.
    fn half_s(&self, corner: Option<&Corner>) -> f64 {
        let most = self.travel.programmed_mm_per_s.unwrap_or(f64::INFINITY).min(self.limits.speed);
        let (half_mm, speed) =
            corner.map_or((0.0, 0.0), |corner| (corner.junction.half_mm, corner.limits.speed.min(most)));
        let rounding_s = if half_mm > 0.0 { half_mm / speed } else { 0.0 };
        rounding_s + time_s(speed, 0.5 * self.travel.length_mm - half_mm, most, &self.limits)
    }

    /// The speed wanted on it, mm/s.
    pub fn wanted(&self, context: &MoveContext, conditions: &FeedConditions) -> f64 {
        let speed = |programmed| conditions.for_context(context).speed_mm_per_s(programmed).min(self.most_mm_per_s);
        self.travel.programmed_mm_per_s.map_or(self.most_mm_per_s, speed)
    }
}

impl Active {
    /// What of it is to do.
    pub fn left_mm(&self) -> f64 {
        self.leg.travel.length_mm - self.done_mm
    }

    /// Where the axes are: X, Y, Z in mm, A, B, C in degrees.
    pub fn axes(&self, queue: &VecDeque<Queued>) -> [f64; AXES] {
        let mut axes = self.leg.travel.axes_at(self.done_mm / self.leg.travel.length_mm);
        let exit = flowing(queue).next().and_then(|(leg, _)| leg.entry).map(|corner| (corner, -self.left_mm()));
        for (corner, way) in self.leg.entry.map(|corner| (corner, self.done_mm)).into_iter().chain(exit) {
            if way.abs() < corner.junction.half_mm {
                let added = corner.junction.rounding(way);
                axes.iter_mut().zip(added).for_each(|(axis, added)| *axis += added);
            }
        }
        axes
    }
}

impl Queued {
    /// Whether the axes go on through it.
    pub fn flows(&self) -> bool {
        matches!(self.block.action, Action::Move(_, None) | Action::Nothing | Action::Ignore(_))
    }
}

/// The moves behind the one in work that flow into each other, with what holds for each.
pub fn flowing(queue: &VecDeque<Queued>) -> impl Iterator<Item = (&Leg, &MoveContext)> {
    let blocks = queue.iter().take_while(|queued| queued.flows());
    blocks.filter_map(|queued| Some((queued.leg.as_ref()?, &queued.block.context)))
}
