//! One trapezoid along the path, also of a helix, where the feed counts in the plane of its arc: acceleration without a limit
//! of jerk, and corners passed with a jump of speed.
//!
//! The speed at a corner is such that no axis jumps by more than the permitted speed difference, and low enough for
//! everything that is queued behind it to be stopped in time. What is not queued yet counts as a stop.
//!
//! Source: the corner rule is that of the 16i's look-ahead control (permissible speed difference, parameter 1783).

use std::collections::VecDeque;

use super::dynamics::Dynamics;
use super::leg::{Active, Advance, Conditions, Queued, flowing};
use super::path::Travel;

/// The speed of the moment, under limits along the path.
#[derive(Clone, Copy, Debug)]
pub struct Trapezoid {
    /// What limits it.
    pub dynamics: Dynamics,
    /// Along the path.
    pub speed_mm_per_s: f64,
}

impl Trapezoid {
    /// Moves on for `dt_s` or to the end of the move.
    pub fn advance(
        &mut self,
        dt_s: f64,
        active: &Active,
        queue: &VecDeque<Queued>,
        conditions: &Conditions<'_>,
    ) -> Advance {
        let stops = conditions.feed.stops_at_block_end || active.ends_at_rest;
        let exit = if stops { 0.0 } else { self.exit_speed(active, queue, conditions) };
        let feed = conditions.feed.for_manner(&active.manner);
        let target = if feed.holds { 0.0 } else { active.leg.wanted(&active.manner, conditions) };
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

    /// Whether the axes are slow enough to stop with a jump that they are permitted.
    pub fn may_stop(&self) -> bool {
        self.speed_mm_per_s <= self.dynamics.corner_jump_mm_per_s
    }

    /// The speed the active move may end with: from the last queued move backwards to it.
    fn exit_speed(&self, active: &Active, queue: &VecDeque<Queued>, conditions: &Conditions<'_>) -> f64 {
        let ahead: Vec<_> = flowing(queue).collect();
        let acceleration = self.dynamics.acceleration_mm_per_s2;
        let mut speed = 0.0;
        for (index, (leg, manner)) in ahead.iter().enumerate().rev() {
            let before = index.checked_sub(1).map_or(&active.leg, |before| ahead[before].0);
            speed = libm::sqrt(speed * speed + 2.0 * acceleration * leg.travel.length_mm)
                .min(self.corner_speed(&before.travel, &leg.travel))
                .min(leg.wanted(manner, conditions));
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
