//! Blocks to motion: look-ahead and execution at override-scaled feed under acceleration limits.
//!
//! One trapezoid along the path, also of a helix, where the feed counts in the plane of its arc. The speed at a corner is
//! such that no axis jumps by more than the permitted speed difference, and low enough for everything that is queued
//! behind it to be stopped in time. What is not queued yet counts as a stop. Feed hold, dry run and override change the
//! speed wanted; how fast the axes follow is the acceleration's.
//!
//! Source: the corner rule is that of the 16i's look-ahead control (permissible speed difference, parameter 1783).

use std::collections::VecDeque;

use arcfeed_shared::machine::ArcClamp;
use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::{MmPerMin, S_PER_MIN};

use super::action::{Action, Manner, ReadBlock};
use super::dynamics::Dynamics;
use super::feeds::{FeedConditions, speed_mm_per_s};
use super::path::Travel;

/// The interpolator's state.
#[derive(Debug)]
pub struct Interpolator {
    dynamics: Dynamics,
    arc_clamp: Option<ArcClamp>,
    queue: VecDeque<Queued>,
    active: Option<Active>,
    position: Pose,
    speed_mm_per_s: f64,
    commanded: MmPerMin,
}

#[derive(Debug)]
struct Queued {
    block: ReadBlock,
    travel: Option<Travel>,
}

#[derive(Debug)]
struct Active {
    travel: Travel,
    done_mm: f64,
    count: u32,
    manner: Manner,
    /// Whether nothing flows from it into the next block.
    ends_at_rest: bool,
}

impl Interpolator {
    /// At rest at the origin, nothing queued.
    pub fn new(dynamics: Dynamics, arc_clamp: Option<ArcClamp>) -> Self {
        Interpolator {
            dynamics,
            arc_clamp,
            queue: VecDeque::new(),
            active: None,
            position: Pose::default(),
            speed_mm_per_s: 0.0,
            commanded: MmPerMin(0.0),
        }
    }

    /// Blocks read ahead.
    pub fn queued(&self) -> usize {
        self.queue.len()
    }

    /// Adds a block behind the others.
    pub fn queue(&mut self, block: ReadBlock) {
        let travel = match &block.action {
            Action::Move(segment, _) => Some(Travel::new(*segment)),
            _ => None,
        };
        self.queue.push_back(Queued { block, travel });
    }

    /// Takes the next block up if the one before is done; `count` is the number of blocks executed before it.
    pub fn take_next(&mut self, count: usize) -> Option<ReadBlock> {
        if self.active.is_some() {
            return None;
        }
        let Queued { block, travel } = self.queue.pop_front()?;
        if let Some(travel) = travel.filter(|travel| travel.length_mm > 0.0) {
            let count = u32::try_from(count + 1).unwrap_or(u32::MAX);
            self.active = Some(Active { travel, done_mm: 0.0, count, manner: block.manner, ends_at_rest: false });
        }
        Some(block)
    }

    /// Begins a move of a block that makes several; `count` as in [`Interpolator::take_next`], this block among them.
    pub fn begin(&mut self, segment: Segment, manner: Manner, count: usize) {
        let travel = Travel::new(segment);
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        if travel.length_mm > 0.0 {
            self.active = Some(Active { travel, done_mm: 0.0, count, manner, ends_at_rest: true });
        }
    }

    /// Moves on for `dt_s` or to the end of the block; answers the time left over.
    pub fn advance(&mut self, dt_s: f64, conditions: &FeedConditions) -> f64 {
        let exit_mm_per_s = if conditions.stops_at_block_end { 0.0 } else { self.exit_speed(conditions) };
        let Some(active) = &mut self.active else {
            self.speed_mm_per_s = 0.0;
            self.commanded = MmPerMin(0.0);
            return 0.0;
        };
        let exit_mm_per_s = if active.ends_at_rest { 0.0 } else { exit_mm_per_s };
        let conditions = &conditions.for_manner(&active.manner);
        let wanted = speed_mm_per_s(&active.travel, conditions, self.arc_clamp.as_ref(), self.dynamics.rapid_mm_per_s);
        let feed = active.travel.speed_mm_per_s().map_or(0.0, |_| wanted / active.travel.speed_ratio);
        self.commanded = MmPerMin((feed * S_PER_MIN) as f32);
        let target = if conditions.holds { 0.0 } else { wanted };
        let left_mm = active.travel.length_mm - active.done_mm;
        let acceleration = self.dynamics.acceleration_mm_per_s2;
        let speed = self.speed_mm_per_s;
        let reached = target
            .clamp(speed - acceleration * dt_s, speed + acceleration * dt_s)
            .min(braking_speed(speed, exit_mm_per_s, left_mm, acceleration, dt_s))
            .max(0.0);
        let step_mm = 0.5 * (speed + reached) * dt_s;
        let creeps = !conditions.holds && reached < acceleration * dt_s && left_mm < acceleration * dt_s * dt_s;
        if step_mm < left_mm && !creeps {
            active.done_mm += step_mm;
            self.speed_mm_per_s = reached;
            self.position = active.travel.pose_at(active.done_mm / active.travel.length_mm);
            return 0.0;
        }
        let used_ratio = if step_mm > left_mm { left_mm / step_mm } else { 1.0 };
        self.speed_mm_per_s = speed + (reached - speed) * used_ratio;
        self.position = active.travel.segment.end;
        self.active = None;
        dt_s * (1.0 - used_ratio)
    }

    /// Where the axes are.
    pub fn position(&self) -> Pose {
        self.position
    }

    /// The active move and the count of blocks executed up to and including it.
    pub fn active(&self) -> Option<(u32, &Segment)> {
        self.active.as_ref().map(|active| (active.count, &active.travel.segment))
    }

    /// What holds for the active move.
    pub fn manner(&self) -> Option<&Manner> {
        self.active.as_ref().map(|active| &active.manner)
    }

    /// The feed of the active move with override, dry run and clamp; of a helix, along its arc in the plane.
    pub fn commanded(&self) -> MmPerMin {
        self.commanded
    }

    /// Whether no move is active.
    pub fn is_idle(&self) -> bool {
        self.active.is_none()
    }

    /// Forgets what is queued and what is active: after a reset, with the axes at rest.
    pub fn clear(&mut self) {
        self.queue.clear();
        self.active = None;
        self.speed_mm_per_s = 0.0;
    }

    /// Whether the axes are slow enough to stop with a jump that they are permitted.
    pub fn may_stop(&self) -> bool {
        self.speed_mm_per_s <= self.dynamics.corner_jump_mm_per_s
    }

    /// Speed along the path.
    pub fn speed_mm_per_s(&self) -> f64 {
        self.speed_mm_per_s
    }

    /// Whether the axes rest.
    pub fn is_at_rest(&self) -> bool {
        self.speed_mm_per_s == 0.0
    }

    /// The speed the active move may end with: from the last queued move backwards to it.
    fn exit_speed(&self, conditions: &FeedConditions) -> f64 {
        let Some(active) = &self.active else { return 0.0 };
        let flows = |queued: &&Queued| {
            matches!(queued.block.action, Action::Move(_, None) | Action::Nothing | Action::Ignore(_))
        };
        let moves = self.queue.iter().take_while(flows);
        let ahead: Vec<(&Travel, &Manner)> =
            moves.filter_map(|queued| Some((queued.travel.as_ref()?, &queued.block.manner))).collect();
        let acceleration = self.dynamics.acceleration_mm_per_s2;
        let mut speed = 0.0;
        for (index, (travel, manner)) in ahead.iter().enumerate().rev() {
            let before = index.checked_sub(1).map_or(&active.travel, |before| ahead[before].0);
            let conditions = &conditions.for_manner(manner);
            speed = libm::sqrt(speed * speed + 2.0 * acceleration * travel.length_mm)
                .min(self.corner_speed(before, travel))
                .min(speed_mm_per_s(travel, conditions, self.arc_clamp.as_ref(), self.dynamics.rapid_mm_per_s));
        }
        speed
    }

    fn corner_speed(&self, before: &Travel, after: &Travel) -> f64 {
        let jump = (after.direction_in() - before.direction_out()).amax();
        if jump > 0.0 { self.dynamics.corner_jump_mm_per_s / jump } else { f64::INFINITY }
    }
}

/// The speed to have in `dt_s` so that constant braking from there ends with `exit` at the end of the way:
/// `reached^2 = exit^2 + 2 a (left - (speed + reached) dt / 2)`.
fn braking_speed(speed: f64, exit: f64, left_mm: f64, acceleration: f64, dt_s: f64) -> f64 {
    let half = 0.5 * acceleration * dt_s;
    let square = half * half + exit * exit + acceleration * (2.0 * left_mm - speed * dt_s);
    if square > 0.0 { (libm::sqrt(square) - half).max(0.0) } else { 0.0 }
}
