//! Division of the path ahead into spans: the rest of the move in execution, a corner, a move, up to the next stop.

use std::collections::VecDeque;
use std::iter::once;

use crate::drives::limits::PathLimits;

use super::feeds::FeedConditions;
use super::prepared_move::{ActiveMove, QueuedBlock, flowing};

/// Span: part of the path ahead with its own limits, either a corner or a move between its corners.
#[derive(Clone, Copy, Debug)]
pub struct PathSpan {
    /// Beginning of the span, as the distance from the beginning of the move in execution.
    pub at_mm: f64,
    /// Limits that the axes set on the span.
    pub limits: PathLimits,
    /// Speed on the span that the programmed feed and the override ask for.
    pub wanted_mm_per_s: f64,
}

/// Calls `visit` for each span, from that in which the axes are up to a stop, until `visit` returns false.
pub fn walk(
    active: &ActiveMove,
    queue: &VecDeque<QueuedBlock>,
    conditions: &FeedConditions,
    mut visit: impl FnMut(PathSpan) -> bool,
) {
    let flowing = flowing(queue).take_while(|(prepared, _)| prepared.entry.is_some());
    let (mut from, mut before) = (0.0, f64::INFINITY);
    for (prepared, context) in once((&active.prepared, &active.context)).chain(flowing) {
        let wanted = prepared.wanted(context, conditions);
        let half = prepared.entry.map_or(0.0, |corner| corner.junction.half_mm);
        let corner = prepared.entry.map(|corner| PathSpan {
            at_mm: from - half,
            limits: corner.limits,
            wanted_mm_per_s: wanted.min(before),
        });
        let between = PathSpan { at_mm: from + half, limits: prepared.limits, wanted_mm_per_s: wanted };
        if !corner.into_iter().chain([between]).all(&mut visit) {
            return;
        }
        (from, before) = (from + prepared.travel.length_mm, wanted);
    }
    visit(PathSpan { at_mm: from, limits: PathLimits { speed: 0.0, ..PathLimits::NONE }, wanted_mm_per_s: 0.0 });
}
