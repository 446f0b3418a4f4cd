//! The way ahead in stretches: what is left of the move in work, a corner, a move, up to the next stop.

use std::collections::VecDeque;
use std::iter::once;

use crate::drives::limits::PathLimits;

use super::feeds::FeedConditions;
use super::leg::{Active, Queued, flowing};

/// Where a stretch begins, what limits it, and the speed wanted on it.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// Its beginning, from the beginning of the move in work.
    pub at_mm: f64,
    /// What the axes allow.
    pub limits: PathLimits,
    /// What programmed feed and override ask for.
    pub wanted_mm_per_s: f64,
}

/// Shows `visit` all stretches, from the one that the axes are on to a stop, while it wants more.
pub fn walk(
    active: &Active,
    queue: &VecDeque<Queued>,
    conditions: &FeedConditions,
    mut visit: impl FnMut(Stretch) -> bool,
) {
    let flowing = flowing(queue).take_while(|(leg, _)| leg.entry.is_some());
    let (mut from, mut before) = (0.0, f64::INFINITY);
    for (leg, context) in once((&active.leg, &active.context)).chain(flowing) {
        let wanted = leg.wanted(context, conditions);
        let half = leg.entry.map_or(0.0, |corner| corner.junction.half_mm);
        let corner = leg.entry.map(|corner| Stretch {
            at_mm: from - half,
            limits: corner.limits,
            wanted_mm_per_s: wanted.min(before),
        });
        let between = Stretch { at_mm: from + half, limits: leg.limits, wanted_mm_per_s: wanted };
        if !corner.into_iter().chain([between]).all(&mut visit) {
            return;
        }
        (from, before) = (from + leg.travel.length_mm, wanted);
    }
    visit(Stretch { at_mm: from, limits: PathLimits { speed: 0.0, ..PathLimits::NONE }, wanted_mm_per_s: 0.0 });
}
