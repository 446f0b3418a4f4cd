//! One trapezoid along the path, also of a helix, where the feed counts in the plane of its arc: acceleration without a limit
//! of jerk, and corners passed with a jump of speed.
//!
//! The speed at a corner is such that no axis jumps by more than the permitted speed difference, and low enough to stop
//! for everything queued behind it. The end of the queue counts as a stop.
//!
//! Source: the corner rule is that of the 16i's look-ahead control (permissible speed difference, parameter 1783).

use std::collections::VecDeque;

use super::dynamics::Dynamics;
use super::feeds::FeedConditions;
use super::path::Travel;
use super::prepared_move::{ActiveMove, Advance, QueuedBlock, flowing};

/// Fraction of a length that counts when deciding whether the moves in view suffice: less than all, so that rounding
/// does not decide it.
const SURE_RATIO: f64 = 1.0 - 1e-6;

/// Speed planner with a limit of the acceleration along the path only. Keeps the present speed between calls.
#[derive(Clone, Debug)]
pub struct Trapezoid {
    /// Limits along the path.
    pub dynamics: Dynamics,
    /// Present speed along the path.
    pub speed_mm_per_s: f64,
    ahead: Vec<Ahead>,
}

/// A move ahead.
#[derive(Clone, Copy, Debug)]
struct Ahead {
    length_mm: f64,
    /// Largest speed at its beginning.
    speed_max_mm_per_s: f64,
}

impl Trapezoid {
    /// A planner at rest.
    pub fn new(dynamics: Dynamics) -> Self {
        Trapezoid { dynamics, speed_mm_per_s: 0.0, ahead: Vec::new() }
    }

    /// Moves the axes for `dt_s`, at most to the end of the move in execution.
    pub fn advance(
        &mut self,
        dt_s: f64,
        active: &ActiveMove,
        queue: &VecDeque<QueuedBlock>,
        conditions: &FeedConditions,
    ) -> Advance {
        let stops = conditions.stops_at_block_end || active.ends_at_rest;
        let exit = if stops { 0.0 } else { self.exit_speed(queue, conditions) };
        let feed = conditions.for_context(&active.context);
        let target = if feed.holds { 0.0 } else { active.prepared.wanted(&active.context, conditions) };
        let left_mm = active.left_mm();
        let acceleration = self.dynamics.acceleration_mm_per_s2;
        let speed = self.speed_mm_per_s;
        let reached = target
            .clamp(speed - acceleration * dt_s, speed + acceleration * dt_s)
            .min(braking_speed(speed, exit, left_mm, acceleration, dt_s))
            .max(0.0);
        let step_mm = 0.5 * (speed + reached) * dt_s;
        let creeps = !feed.holds && reached < acceleration * dt_s && left_mm < acceleration * dt_s * dt_s;
        if step_mm < left_mm && !creeps {
            self.speed_mm_per_s = reached;
            return Advance::To(active.done_mm + step_mm, 0.0);
        }
        let used_ratio = if step_mm > left_mm { left_mm / step_mm } else { 1.0 };
        self.speed_mm_per_s = speed + (reached - speed) * used_ratio;
        Advance::Over(dt_s * (1.0 - used_ratio))
    }

    /// Whether the axes are slow enough to stop with a permitted jump of speed.
    pub fn may_stop(&self) -> bool {
        self.speed_mm_per_s <= self.dynamics.corner_jump_mm_per_s
    }

    /// Speed that the active move may end with, from the last move in view backwards to it.
    fn exit_speed(&mut self, queue: &VecDeque<QueuedBlock>, conditions: &FeedConditions) -> f64 {
        let behind = self.collect_ahead(queue, conditions);
        let acceleration = self.dynamics.acceleration_mm_per_s2;
        self.ahead.iter().rev().fold(behind, |speed, ahead| {
            libm::sqrt(speed * speed + 2.0 * acceleration * ahead.length_mm).min(ahead.speed_max_mm_per_s)
        })
    }

    /// Collects the moves ahead; returns the speed behind the last of them. If a stop further on leaves one of them at
    /// its limit in any case, that one is the last, and the speed behind it does not count.
    fn collect_ahead(&mut self, queue: &VecDeque<QueuedBlock>, conditions: &FeedConditions) -> f64 {
        let acceleration = self.dynamics.acceleration_mm_per_s2;
        self.ahead.clear();
        // Remaining square of the speed before a stop, and the count of moves up to where it was least.
        let (mut square, mut count) = (f64::INFINITY, 0);
        for (prepared, context) in flowing(queue) {
            let length_mm = prepared.travel.length_mm;
            let speed_max_mm_per_s = prepared.corner_mm_per_s.min(prepared.wanted(context, conditions));
            self.ahead.push(Ahead { length_mm, speed_max_mm_per_s });
            if speed_max_mm_per_s * speed_max_mm_per_s <= square {
                (square, count) = (speed_max_mm_per_s * speed_max_mm_per_s, self.ahead.len());
            }
            square -= SURE_RATIO * 2.0 * acceleration * length_mm;
            if square < 0.0 {
                self.ahead.truncate(count);
                return f64::INFINITY;
            }
        }
        0.0
    }

    /// Largest speed along the path at the corner between two moves, so that no axis steps in speed by more than permitted.
    pub fn corner_mm_per_s(&self, before: &Travel, after: &Travel) -> f64 {
        let jump = (after.direction_in() - before.direction_out()).amax();
        if jump > 0.0 { self.dynamics.corner_jump_mm_per_s / jump } else { f64::INFINITY }
    }
}

/// Speed after `dt_s` from which constant braking ends with `exit` at the end of the path: `reached^2 = exit^2 + 2 a
/// (left - (speed + reached) dt / 2)`.
fn braking_speed(speed: f64, exit: f64, left_mm: f64, acceleration: f64, dt_s: f64) -> f64 {
    let half = 0.5 * acceleration * dt_s;
    let square = half * half + exit * exit + acceleration * (2.0 * left_mm - speed * dt_s);
    if square > 0.0 { (libm::sqrt(square) - half).max(0.0) } else { 0.0 }
}
