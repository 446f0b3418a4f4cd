//! Which segment is in work, from the position alone: for boards that see the program and the axes, but not the
//! control's block number.
//!
//! Segments queue up ahead of the control. The one in work gives way to the next when the place reached lies at its end;
//! a rapid, whose way is the machine's, when the axes stand at its end. Only ends are looked at, so a program that runs
//! back over its own path (D - base - E) cannot fool it.

use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::units::Nm;
use heapless::Deque;

use crate::active::ActiveSegment;
use crate::controller::State;

/// How near its end a segment counts as done: a few times the noise of the position.
const END_TOLERANCE_MM: f32 = 0.01;
/// How near every axis must stand to a rapid's end.
const REST_TOLERANCE: Nm = Nm(20_000);

/// The segments ahead, the one in work first.
#[derive(Debug, Default)]
pub struct SegmentQueue<const N: usize> {
    segments: Deque<ActiveSegment, N>,
    count: u32,
}

impl<const N: usize> SegmentQueue<N> {
    /// An empty queue.
    pub const fn new() -> Self {
        SegmentQueue { segments: Deque::new(), count: 0 }
    }

    /// Whether there is no room for another.
    pub fn is_full(&self) -> bool {
        self.segments.is_full()
    }

    /// Adds a segment behind the others; false, and nothing changed, if there is no room.
    pub fn push(&mut self, segment: ActiveSegment) -> bool {
        self.segments.push_back(segment).is_ok()
    }

    /// The segment in work, and how many were done before it.
    pub fn in_work(&self) -> Option<(u32, &ActiveSegment)> {
        self.segments.front().map(|segment| (self.count, segment))
    }

    /// Lets the segment in work go if it is done; true if it is.
    pub fn leave_if_done(&mut self, state: &State, position: Option<&Pose>) -> bool {
        let is_done = self.segments.front().is_some_and(|segment| is_done(segment, state, position));
        if is_done {
            self.segments.pop_front();
            self.count = self.count.wrapping_add(1);
        }
        is_done
    }
}

fn is_done(segment: &ActiveSegment, state: &State, position: Option<&Pose>) -> bool {
    match segment.length_mm() {
        Some(length_mm) => state.progress().travelled_mm() >= length_mm - END_TOLERANCE_MM,
        None => position.is_some_and(|position| {
            let axes = position.linear.iter().zip(&segment.end().linear);
            axes.map(|(at, end)| at.0.abs_diff(end.0)).all(|distance| distance <= REST_TOLERANCE.0.unsigned_abs())
        }),
    }
}
