//! The fastest speed that all axes can follow, also on what is read ahead.
//!
//! Each stretch ahead ([`walk`]) begins with the speed that its axes allow, and with the one that is wanted there; [`Profile`]
//! keeps to both. What is not queued yet counts as a stop. A stop at the end of a block (single block) that is asked for too
//! late for this one is made at the end of the next.

use std::collections::VecDeque;

use crate::drives::brake::{Brake, Motion, surely_fits};
use crate::drives::limits::{DriveLimits, PathLimits};
use crate::drives::profile::{Ahead, Profile, secure};

use super::feeds::FeedConditions;
use super::leg::{Active, Advance, Queued, flowing};
use super::stretches::{Stretch, walk};

/// What is left of a way when it counts as done, far below a nanometre.
const DONE: f64 = 1e-10;

/// The speed of the moment, under limits of all axes.
#[derive(Clone, Debug)]
pub struct LookAhead {
    /// What limits it.
    pub drives: DriveLimits,
    motion: Motion,
    /// The way that was covered beyond the end of a move, until the next one takes it.
    over: Option<f64>,
    ahead: Vec<Ahead>,
}

impl LookAhead {
    /// At rest.
    pub fn new(drives: DriveLimits) -> Self {
        LookAhead { drives, motion: Motion::default(), over: None, ahead: Vec::new() }
    }

    /// Speed along the path.
    pub fn speed_mm_per_s(&self) -> f64 {
        self.motion.speed
    }

    /// Whether a way is covered already that belongs to the next move.
    pub fn is_between(&self) -> bool {
        self.over.is_some()
    }

    /// No move is in work.
    pub fn rest(&mut self) {
        (self.motion, self.over) = (Motion::default(), None);
    }

    /// Whether the axes can keep to the corners of these moves. A corner that is read when they are on their way to a stop
    /// behind it may come too late.
    pub fn can_follow(&mut self, active: &Active, queue: &VecDeque<Queued>) -> bool {
        let here = self.look(0.0, active, queue, &FeedConditions::PROGRAMMED).limits;
        Profile { period_s: 0.0, here, ahead: &self.ahead }.can_go_on(self.motion)
    }

    /// Moves on for `dt_s` or to the end of the move.
    pub fn advance(
        &mut self,
        dt_s: f64,
        active: &Active,
        queue: &mut VecDeque<Queued>,
        conditions: &FeedConditions,
    ) -> Advance {
        if let Some(over) = self.over.take() {
            return self.carried(active.done_mm + over, active, dt_s);
        }
        if conditions.stops_at_block_end {
            self.stop_at_block_end(active, queue);
        }
        let now = self.look(dt_s, active, queue, conditions);
        let holds = conditions.for_context(&active.context).holds;
        let wanted = if holds { 0.0 } else { now.wanted_mm_per_s.min(now.limits.speed) };
        let profile = Profile { period_s: dt_s, here: now.limits, ahead: &self.ahead };
        let step = profile.step(self.motion, wanted);
        self.motion = step.motion;
        let stops = flowing(queue).next().is_none_or(|(leg, _)| leg.entry.is_none());
        if !stops || active.left_mm() - step.way > DONE {
            return self.carried(active.done_mm + step.way, active, step.left_s);
        }
        if !step.is_over() {
            // What is left of the way down takes longer than its way would tell.
            return Advance::To(active.leg.travel.length_mm.next_down(), 0.0);
        }
        self.rest();
        Advance::Over(step.left_s)
    }

    /// So far in this move, or beyond its end into the next one.
    fn carried(&mut self, done_mm: f64, active: &Active, left_s: f64) -> Advance {
        let over = done_mm - active.leg.travel.length_mm;
        if over < 0.0 {
            return Advance::To(done_mm, left_s);
        }
        self.over = Some(over);
        Advance::Over(left_s)
    }

    /// Lets the first move that can still be stopped at its end stop there.
    fn stop_at_block_end(&self, active: &Active, queue: &mut VecDeque<Queued>) {
        let mut limits = active.leg.entry.map_or(active.leg.limits, |entry| entry.limits.and(&active.leg.limits));
        let mut left = active.left_mm();
        for queued in queue.iter_mut() {
            let Some(leg) = &mut queued.leg else { continue };
            let Some(entry) = leg.entry else { return };
            let way = Brake::to(0.0, self.motion, &limits).map_or(0.0, |brake| brake.way());
            if way <= left && left > entry.junction.half_mm {
                leg.entry = None;
                return;
            }
            left += leg.travel.length_mm;
            limits = limits.and(&entry.limits).and(&leg.limits);
        }
    }

    /// Sets the stretches ahead, as far as the axes get before they can rest; answers the one that they are on.
    fn look(&mut self, dt_s: f64, active: &Active, queue: &VecDeque<Queued>, conditions: &FeedConditions) -> Stretch {
        let Motion { speed, acceleration } = self.motion;
        let ahead = &mut self.ahead;
        ahead.clear();
        let mut here = Stretch { at_mm: 0.0, limits: PathLimits::NONE, wanted_mm_per_s: f64::INFINITY };
        let mut on_the_way = PathLimits::NONE;
        walk(active, queue, conditions, |stretch| {
            let Stretch { at_mm: at, limits, wanted_mm_per_s: wanted } = stretch;
            // A stop is ahead until the axes rest.
            if at <= DONE && limits.speed > 0.0 {
                (here, on_the_way) = (stretch, limits);
                return true;
            }
            ahead.push(Ahead { at, speed: limits.speed, is_commanded_feed: false, safe: [0.0; 2], limits, on_the_way });
            let soon = speed + (acceleration.abs() + here.limits.jerk * dt_s) * dt_s;
            on_the_way = on_the_way.and(&limits);
            if wanted < limits.speed {
                ahead.push(Ahead { at, speed: wanted, is_commanded_feed: true, safe: [0.0; 2], limits, on_the_way });
            }
            let from = Motion { speed: soon, acceleration: acceleration.max(0.0) };
            let exactly = || {
                let brake = Brake::to(0.0, from, &on_the_way);
                brake.is_none_or(|brake| brake.way() + soon * dt_s < at)
            };
            !surely_fits(0.0, &from, &on_the_way, at - soon * dt_s).unwrap_or_else(exactly)
        });
        secure(ahead);
        here
    }
}
