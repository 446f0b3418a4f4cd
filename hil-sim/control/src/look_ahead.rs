//! Fastest speed that all axes can follow, including on blocks read ahead.
//!
//! Each span ahead ([`walk`]) begins with the speed that its axes allow, and with the speed wanted there. [`SpeedProfile`]
//! keeps to both; [`Horizon`] holds the spans from step to step. The end of the queue counts as a stop. A stop at the
//! end of a block (single block) that is requested too late for this block is made at the end of the next.

use std::collections::VecDeque;

use crate::drives::brake::{Brake, Motion};
use crate::drives::limits::DriveLimits;
use crate::drives::profile::SpeedProfile;

use super::feeds::FeedConditions;
use super::horizon::{DONE, Horizon};
use super::prepared_move::{ActiveMove, Advance, QueuedBlock, flowing};

/// Speed planner under the acceleration and jerk limits of each axis. Keeps the present motion between calls.
#[derive(Clone, Debug)]
pub struct LookAhead {
    /// Limits of the drives, and the tolerance of corners.
    pub drives: DriveLimits,
    motion: Motion,
    /// Distance travelled beyond the end of a move, until the next move takes it over.
    overrun: Option<f64>,
    horizon: Horizon,
}

impl LookAhead {
    /// A planner at rest.
    pub fn new(drives: DriveLimits) -> Self {
        LookAhead { drives, motion: Motion::default(), overrun: None, horizon: Horizon::new() }
    }

    /// Commanded speed along the path.
    pub fn speed_mm_per_s(&self) -> f64 {
        self.motion.speed
    }

    /// Whether the axes have travelled beyond the end of the last move, a distance that belongs to the next one.
    pub fn is_between(&self) -> bool {
        self.overrun.is_some()
    }

    /// Sets the motion to rest: no move is in execution.
    pub fn rest(&mut self) {
        (self.motion, self.overrun) = (Motion::default(), None);
        self.horizon.invalidate();
    }

    /// Whether the axes can keep to the limits of the corners between these moves. They may not, if a corner was read while the axes
    /// were already braking to a stop behind it.
    pub fn can_follow(&mut self, active: &ActiveMove, queue: &VecDeque<QueuedBlock>) -> bool {
        if self.horizon.ends_before_queue() {
            return true;
        }
        self.horizon.invalidate();
        self.horizon.update(0.0, self.motion, (active, queue), &FeedConditions::PROGRAMMED);
        let can_follow = self.profile(0.0, active).can_keep_limits(self.motion);
        if !can_follow {
            self.horizon.invalidate();
        }
        can_follow
    }

    /// Moves the axes for `dt_s`, at most to the end of the move in execution.
    pub fn advance(
        &mut self,
        dt_s: f64,
        active: &ActiveMove,
        queue: &mut VecDeque<QueuedBlock>,
        conditions: &FeedConditions,
    ) -> Advance {
        if let Some(overrun) = self.overrun.take() {
            self.horizon.enter(active, conditions);
            return self.advanced_to(active.done_mm + overrun, active, dt_s);
        }
        if conditions.stops_at_block_end {
            self.stop_at_block_end(active, queue);
        }
        self.horizon.update(dt_s, self.motion, (active, queue), conditions);
        let holds = conditions.for_context(&active.context).holds;
        let here = self.horizon.here();
        let wanted = if holds { 0.0 } else { here.wanted_mm_per_s.min(here.limits.speed) };
        let step = self.profile(dt_s, active).step(self.motion, wanted);
        self.motion = step.motion;
        let stops = flowing(queue).next().is_none_or(|(prepared, _)| prepared.entry.is_none());
        if !stops || active.left_mm() - step.distance > DONE {
            return self.advanced_to(active.done_mm + step.distance, active, step.left_s);
        }
        if !step.is_over() {
            // Braking takes longer than the remaining distance suggests.
            return Advance::To(active.prepared.travel.length_mm.next_down(), 0.0);
        }
        self.rest();
        Advance::Over(step.left_s)
    }

    /// Profile of one period from the position of the axes.
    fn profile(&self, period_s: f64, active: &ActiveMove) -> SpeedProfile<'_> {
        SpeedProfile { period_s, at: active.done_mm, here: self.horizon.here().limits, ahead: self.horizon.ahead() }
    }

    /// Advances to a distance in this move, or beyond its end into the next one.
    fn advanced_to(&mut self, done_mm: f64, active: &ActiveMove, left_s: f64) -> Advance {
        let overrun = done_mm - active.prepared.travel.length_mm;
        if overrun < 0.0 {
            return Advance::To(done_mm, left_s);
        }
        self.horizon.rebase(active);
        self.overrun = Some(overrun);
        Advance::Over(left_s)
    }

    /// Makes the first move that can still stop at its end stop there.
    fn stop_at_block_end(&mut self, active: &ActiveMove, queue: &mut VecDeque<QueuedBlock>) {
        let mut limits =
            active.prepared.entry.map_or(active.prepared.limits, |entry| entry.limits.and(&active.prepared.limits));
        let mut left = active.left_mm();
        for queued in queue.iter_mut() {
            let Some(prepared) = &mut queued.prepared else { continue };
            let Some(entry) = prepared.entry else { return };
            let distance = Brake::to(0.0, self.motion, &limits).map_or(0.0, |brake| brake.distance());
            if distance <= left && left > entry.junction.half_mm {
                prepared.entry = None;
                self.horizon.invalidate();
                return;
            }
            left += prepared.travel.length_mm;
            limits = limits.and(&entry.limits).and(&prepared.limits);
        }
    }
}
