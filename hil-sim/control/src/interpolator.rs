//! Motion of the axes from blocks: the queue of blocks read ahead, the move in execution, and the position on it.
//!
//! One of two planners sets the speed: a trapezoid along the path (`trapezoid.rs`), used without data of the drives, or
//! limits of speed, acceleration and jerk of every axis (`look_ahead.rs`). Feed hold, dry run and override change the
//! wanted speed; the planner decides how fast the axes reach it.

use std::collections::VecDeque;

use arcfeed_model::machine::ArcClamp;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_units::{MmPerMin, S_PER_MIN};

use crate::drives::limits::AXES;

use super::action::{Action, MoveContext, ReadBlock};
use super::feeds::FeedConditions;
use super::look_ahead::LookAhead;
use super::path::to_pose;
use super::prepared_move::{ActiveMove, Advance, MoveLimits, PreparedMove, QueuedBlock};
use super::settings::ControlSettings;
use super::trapezoid::Trapezoid;

/// Interpolator: moves the axes along the blocks read ahead. Keeps its state between calls.
#[derive(Debug)]
pub struct Interpolator {
    planner: SpeedPlanner,
    arc_clamp: Option<ArcClamp>,
    dry_run_mm_per_s: f64,
    queue: VecDeque<QueuedBlock>,
    active: Option<ActiveMove>,
    moves_begun: u64,
    axes: [f64; AXES],
    position: Pose,
    commanded: MmPerMin,
    limited: Vec<AxisLimited>,
}

/// Record of a block that ran slower than its feed times the override because one axis reached its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimited {
    /// Count of blocks executed up to and including it.
    pub count: u32,
    /// N of the block, if it has one.
    pub sequence: Option<i64>,
    /// Axis that reached its limit: 0 to 5 for X, Y, Z, A, B, C.
    pub axis: usize,
    /// Whether only rotary axes move; the speeds below are then in degrees per second.
    pub is_rotary: bool,
    /// Requested speed along the path, at the first time it was not allowed.
    pub wanted_mm_per_s: f64,
    /// Allowed speed along the path.
    pub allowed_mm_per_s: f64,
}

/// Planner of the speed.
#[derive(Debug)]
enum SpeedPlanner {
    Trapezoid(Trapezoid),
    LookAhead(Box<LookAhead>),
}

impl Interpolator {
    /// An interpolator at rest at the origin, with an empty queue.
    pub fn new(settings: &ControlSettings) -> Self {
        let planner = match settings.drives {
            Some(drives) => SpeedPlanner::LookAhead(Box::new(LookAhead::new(drives))),
            None => SpeedPlanner::Trapezoid(Trapezoid::new(settings.dynamics)),
        };
        Interpolator {
            planner,
            arc_clamp: settings.arc_clamp,
            dry_run_mm_per_s: f64::from(settings.dry_run_feed.0) / S_PER_MIN,
            queue: VecDeque::new(),
            active: None,
            moves_begun: 0,
            axes: [0.0; AXES],
            position: Pose::default(),
            commanded: MmPerMin(0.0),
            limited: Vec::new(),
        }
    }

    /// Number of blocks that wait in the queue, read ahead but not begun.
    pub fn queued(&self) -> usize {
        self.queue.len()
    }

    /// Adds a block at the end of the queue.
    pub fn queue(&mut self, block: ReadBlock) {
        let prepared = match &block.action {
            Action::Move(segment, _) | Action::Corner(segment) => {
                Some(self.prepare_move(*segment)).filter(|prepared| prepared.travel.length_mm > 0.0)
            }
            _ => None,
        };
        let flows = prepared.as_ref().is_some_and(|prepared| prepared.entry.is_some());
        self.queue.push_back(QueuedBlock { block, prepared });
        // The block was read too late for a rounded corner, so the corner is a stop.
        if flows
            && let (SpeedPlanner::LookAhead(look_ahead), Some(active)) = (&mut self.planner, &self.active)
            && !look_ahead.can_follow(active, &self.queue)
            && let Some(prepared) = self.queue.back_mut().and_then(|queued| queued.prepared.as_mut())
        {
            prepared.entry = None;
        }
    }

    /// Takes the next block from the queue and begins its move; `None` if a move is still in execution or the queue is empty. `count` is
    /// the number of blocks executed before it.
    pub fn take_next(&mut self, count: usize) -> Option<ReadBlock> {
        if self.active.is_some() {
            return None;
        }
        let QueuedBlock { block, prepared } = self.queue.pop_front()?;
        if let Some(prepared) = prepared {
            let count = u32::try_from(count + usize::from(!block.is_inserted())).unwrap_or(u32::MAX);
            self.activate(ActiveMove { prepared, done_mm: 0.0, count, context: block.context, ends_at_rest: false });
        }
        Some(block)
    }

    /// Begins one move of a block that makes several; it ends at rest. `count` is the number of blocks executed, this one included.
    pub fn begin(&mut self, segment: Segment, context: MoveContext, count: usize) {
        let prepared = PreparedMove::new(segment, &self.limits());
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        if prepared.travel.length_mm > 0.0 {
            self.activate(ActiveMove { prepared, done_mm: 0.0, count, context, ends_at_rest: true });
        }
    }

    fn activate(&mut self, active: ActiveMove) {
        self.active = Some(active);
        self.moves_begun += 1;
    }

    /// Moves the axes for `dt_s`, at most to the end of the present move; returns the time left over, s.
    pub fn advance(&mut self, dt_s: f64, conditions: &FeedConditions) -> f64 {
        let Some(active) = &mut self.active else {
            self.planner.rest();
            self.commanded = MmPerMin(0.0);
            return 0.0;
        };
        let travel = &active.prepared.travel;
        let asked = active.prepared.wanted(&active.context, conditions);
        let wanted = asked.min(active.prepared.limits.speed);
        let feed = travel.programmed_mm_per_s.map_or(0.0, |_| wanted / travel.speed_ratio);
        if asked > wanted && feed > 0.0 && self.limited.last().is_none_or(|limited| limited.count != active.count) {
            self.limited.push(AxisLimited {
                count: active.count,
                sequence: travel.segment.sequence,
                axis: active.prepared.limits.axis.unwrap_or_default(),
                is_rotary: travel.is_rotary(),
                wanted_mm_per_s: asked,
                allowed_mm_per_s: wanted,
            });
        }
        self.commanded = MmPerMin((feed * S_PER_MIN) as f32);
        let advance = match &mut self.planner {
            SpeedPlanner::Trapezoid(trapezoid) => trapezoid.advance(dt_s, active, &self.queue, conditions),
            SpeedPlanner::LookAhead(look_ahead) => look_ahead.advance(dt_s, active, &mut self.queue, conditions),
        };
        match advance {
            Advance::To(done_mm, left_s) => {
                active.done_mm = done_mm;
                self.axes = active.axes(&self.queue);
                self.position = to_pose(&self.axes);
                left_s
            }
            Advance::Over(left_s) => {
                self.axes = active.prepared.travel.axes_at(1.0);
                self.position = travel.segment.end;
                self.active = None;
                left_s
            }
        }
    }

    /// Commanded position of the axes, in whole nanometres and microdegrees.
    pub fn position(&self) -> Pose {
        self.position
    }

    /// Commanded position, unrounded: X, Y, Z in mm, A, B, C in degrees.
    pub fn axes(&self) -> &[f64; AXES] {
        &self.axes
    }

    /// Blocks that ran slower than programmed because an axis reached its limit.
    pub fn limited(&self) -> &[AxisLimited] {
        &self.limited
    }

    /// The move in execution, after the count of executed blocks up to and including its own; `None` between moves.
    pub fn active(&self) -> Option<(u32, &Segment)> {
        self.active.as_ref().map(|active| (active.count, &active.prepared.travel.segment))
    }

    /// Number of moves begun since power-on; one block may make several.
    pub fn moves_begun(&self) -> u64 {
        self.moves_begun
    }

    /// Context of the move in execution.
    pub fn context(&self) -> Option<&MoveContext> {
        self.active.as_ref().map(|active| &active.context)
    }

    /// Feed that the control commands on the move in execution, after override, dry run and clamp; on a helix, along the arc in its plane.
    pub fn commanded(&self) -> MmPerMin {
        self.commanded
    }

    /// Whether no move is in execution.
    pub fn is_idle(&self) -> bool {
        self.active.is_none()
    }

    /// Whether the axes have travelled beyond the end of a move in the last step, but the next move has not been taken from the queue.
    pub fn is_between(&self) -> bool {
        matches!(&self.planner, SpeedPlanner::LookAhead(look_ahead) if look_ahead.is_between())
    }

    /// Empties the queue and drops the move in execution; for a reset, with the axes at rest.
    pub fn clear(&mut self) {
        self.queue.clear();
        self.active = None;
        self.planner.rest();
    }

    /// Whether the axes can stop at once: they rest or, with the trapezoid planner, are slow enough for a permitted step of speed.
    pub fn may_stop(&self) -> bool {
        match &self.planner {
            SpeedPlanner::Trapezoid(trapezoid) => trapezoid.may_stop(),
            SpeedPlanner::LookAhead(_) => self.is_at_rest(),
        }
    }

    /// Commanded speed along the path.
    pub fn speed_mm_per_s(&self) -> f64 {
        match &self.planner {
            SpeedPlanner::Trapezoid(trapezoid) => trapezoid.speed_mm_per_s,
            SpeedPlanner::LookAhead(look_ahead) => look_ahead.speed_mm_per_s(),
        }
    }

    /// Whether the axes rest.
    pub fn is_at_rest(&self) -> bool {
        self.speed_mm_per_s() == 0.0
    }

    /// Prepares a move, with the rounded corner to the move before if the two flow and there is still time to round it.
    fn prepare_move(&self, segment: Segment) -> PreparedMove {
        let mut prepared = PreparedMove::new(segment, &self.limits());
        let Some((before, left_mm)) = self.last_flowing() else { return prepared };
        match &self.planner {
            SpeedPlanner::Trapezoid(trapezoid) => {
                prepared.corner_mm_per_s = trapezoid.corner_mm_per_s(&before.travel, &prepared.travel);
            }
            SpeedPlanner::LookAhead(look_ahead) => {
                prepared.join(before, &look_ahead.drives);
                prepared.entry = prepared.entry.filter(|corner| corner.junction.half_mm < left_mm);
            }
        }
        prepared
    }

    /// Last move that flows into the next one, and its remaining distance.
    fn last_flowing(&self) -> Option<(&PreparedMove, f64)> {
        let mut flowing = self.queue.iter().rev().take_while(|queued| queued.flows());
        if let Some(prepared) = flowing.find_map(|queued| queued.prepared.as_ref()) {
            return Some((prepared, prepared.travel.length_mm));
        }
        let active = self.active.as_ref().filter(|active| !active.ends_at_rest)?;
        self.queue.iter().all(QueuedBlock::flows).then(|| (&active.prepared, active.left_mm()))
    }

    /// Limits that the settings put on every move. Data of the drives, if known, set the speed at G0.
    fn limits(&self) -> MoveLimits<'_> {
        let (drives, rapid_mm_per_s) = match &self.planner {
            SpeedPlanner::Trapezoid(trapezoid) => (None, trapezoid.dynamics.rapid_mm_per_s),
            SpeedPlanner::LookAhead(look_ahead) => (Some(&look_ahead.drives), f64::INFINITY),
        };
        let (arc_clamp, dry_run_mm_per_s) = (self.arc_clamp.as_ref(), self.dry_run_mm_per_s);
        MoveLimits { drives, arc_clamp, rapid_mm_per_s, dry_run_mm_per_s }
    }
}

impl SpeedPlanner {
    fn rest(&mut self) {
        match self {
            SpeedPlanner::Trapezoid(trapezoid) => trapezoid.speed_mm_per_s = 0.0,
            SpeedPlanner::LookAhead(look_ahead) => look_ahead.rest(),
        }
    }
}
