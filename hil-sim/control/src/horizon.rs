//! Path spans ahead, as far as the axes travel before they can rest, kept from step to step.
//!
//! Positions count from the beginning of the move in execution, so they stay the same while the axes move. The safe
//! speeds, which cost roots, depend only on differences of positions. Spans that the axes have reached are removed at
//! the front. The rest is computed anew when the feed conditions change, and when the axes need more distance to rest
//! than the horizon has: it then reaches some periods further, for the following steps. A horizon is safe if the axes
//! can rest within it, because its end counts as a stop.

use std::collections::VecDeque;

use crate::drives::brake::{Brake, Motion, surely_fits};
use crate::drives::limits::PathLimits;
use crate::drives::profile::{Ahead, secure};

use super::feeds::FeedConditions;
use super::path_spans::{PathSpan, walk};
use super::prepared_move::{ActiveMove, QueuedBlock};

/// Remaining distance, mm, below which a path counts as completed, far below a nanometre.
pub const DONE: f64 = 1e-10;
/// Periods at the present speed that a new horizon reaches beyond the needed distance.
const SPARE_PERIODS: f64 = 24.0;

/// Planned part of the path: the span in which the axes are, and the spans ahead, as far as the axes need to come to rest.
#[derive(Clone, Debug)]
pub struct Horizon {
    here: PathSpan,
    ahead: Vec<Ahead>,
    /// Conditions for which the wanted speeds hold; `None` if the horizon must be computed anew.
    conditions: Option<FeedConditions>,
}

impl Horizon {
    /// Empty horizon, which the next update computes.
    pub fn new() -> Self {
        let here = PathSpan { at_mm: 0.0, limits: PathLimits::NONE, wanted_mm_per_s: f64::INFINITY };
        Horizon { here, ahead: Vec::new(), conditions: None }
    }

    /// The span that the axes are on.
    pub fn here(&self) -> &PathSpan {
        &self.here
    }

    /// Spans ahead that may slow the axes, with their safe speeds.
    pub(crate) fn ahead(&self) -> &[Ahead] {
        &self.ahead
    }

    /// Makes the next update compute the horizon anew, because the moves have changed.
    pub fn invalidate(&mut self) {
        self.conditions = None;
    }

    /// Whether the horizon is valid and does not end with a stop, so that it ends before a move added to the queue now.
    pub fn ends_before_queue(&self) -> bool {
        self.conditions.is_some() && self.ahead.last().is_some_and(|last| last.limits.speed > 0.0)
    }

    /// Shifts all positions so that they count from the end of `active`, which is over.
    pub fn rebase(&mut self, active: &ActiveMove) {
        for ahead in &mut self.ahead {
            ahead.at -= active.prepared.travel.length_mm;
        }
    }

    /// Sets the wanted speed of the present span to that of the move just begun; in the corner before it may have been lower.
    pub fn enter(&mut self, active: &ActiveMove, conditions: &FeedConditions) {
        self.here.wanted_mm_per_s = active.prepared.wanted(&active.context, conditions);
    }

    /// Updates the horizon for the present position and motion of the axes, and for the distance they may travel within `dt_s`.
    pub fn update(
        &mut self,
        dt_s: f64,
        motion: Motion,
        (active, queue): (&ActiveMove, &VecDeque<QueuedBlock>),
        conditions: &FeedConditions,
    ) {
        if self.conditions == Some(*conditions) {
            self.drop_reached(active.done_mm);
            if self.reaches_far_enough(dt_s, &motion, active.done_mm) {
                return;
            }
        }
        self.recompute(dt_s, &motion, (active, queue), conditions);
    }

    /// Removes the spans that the axes have reached. A stop stays ahead until the axes rest.
    fn drop_reached(&mut self, done_mm: f64) {
        let is_reached = |ahead: &&Ahead| ahead.at - done_mm <= DONE && ahead.limits.speed > 0.0;
        let reached = self.ahead.iter().take_while(is_reached).count();
        let Some(last) = self.ahead.drain(..reached).next_back() else { return };
        self.here = PathSpan { at_mm: last.at, limits: last.limits, wanted_mm_per_s: last.speed };
        let mut limits_before = self.here.limits;
        for ahead in &mut self.ahead {
            if ahead.is_commanded_feed {
                limits_before = limits_before.and(&ahead.limits);
            }
            ahead.limits_before = limits_before;
            limits_before = limits_before.and(&ahead.limits);
        }
    }

    /// Whether the axes can rest before the end of the horizon, or the queue holds no move behind it.
    fn reaches_far_enough(&self, dt_s: f64, motion: &Motion, done_mm: f64) -> bool {
        self.ahead.last().is_some_and(|last| {
            let motion_bound = self.motion_bound(dt_s, motion);
            let room = last.at - done_mm - motion_bound.speed * dt_s;
            last.limits.speed == 0.0 || rests_within(room, &motion_bound, &last.limits_before.and(&last.limits))
        })
    }

    /// Upper bound of the motion within `dt_s`.
    fn motion_bound(&self, dt_s: f64, motion: &Motion) -> Motion {
        let Motion { speed, acceleration } = *motion;
        let speed = speed + (acceleration.abs() + self.here.limits.jerk * dt_s) * dt_s;
        Motion { speed, acceleration: acceleration.max(0.0) }
    }

    /// Computes the horizon anew, with some periods in reserve.
    fn recompute(
        &mut self,
        dt_s: f64,
        motion: &Motion,
        (active, queue): (&ActiveMove, &VecDeque<QueuedBlock>),
        conditions: &FeedConditions,
    ) {
        self.ahead.clear();
        self.here = PathSpan { at_mm: 0.0, limits: PathLimits::NONE, wanted_mm_per_s: f64::INFINITY };
        let mut limits_before = PathLimits::NONE;
        walk(active, queue, conditions, |span| {
            let PathSpan { at_mm: at, limits, wanted_mm_per_s: wanted } = span;
            let left = at - active.done_mm;
            if left <= DONE && limits.speed > 0.0 {
                (self.here, limits_before) = (span, limits);
                return true;
            }
            self.ahead.push(Ahead {
                at,
                speed: limits.speed,
                is_commanded_feed: false,
                safe: [0.0; 2],
                limits,
                limits_before,
            });
            limits_before = limits_before.and(&limits);
            if wanted < limits.speed {
                self.ahead.push(Ahead {
                    at,
                    speed: wanted,
                    is_commanded_feed: true,
                    safe: [0.0; 2],
                    limits,
                    limits_before,
                });
            }
            let motion_bound = self.motion_bound(dt_s, motion);
            !rests_within(left - (1.0 + SPARE_PERIODS) * motion_bound.speed * dt_s, &motion_bound, &limits_before)
        });
        secure(&mut self.ahead);
        self.conditions = Some(*conditions);
    }
}

/// Whether a motion comes to rest within less than `room`.
fn rests_within(room: f64, from: &Motion, limits: &PathLimits) -> bool {
    let exactly = || Brake::to(0.0, *from, limits).is_none_or(|brake| brake.distance() < room);
    surely_fits(0.0, from, limits, room).unwrap_or_else(exactly)
}
