//! Detection of the segment in execution from the position alone, for boards that know the program and the axes but
//! not the control's block number.
//!
//! The board has a queue of segments ahead of the control. The segment in execution ends when the progress reaches its
//! end; a rapid, whose path the machine decides, ends when the axes are at its end. Only ends are checked, so a
//! program that runs back over its own path (D - base - E) causes no confusion.
//!
//! This module has its own progress. The supervisor's progress stops while samples are stale, or on a segment whose
//! beginning it has not seen; the queue must pass such a segment so that the next one can begin.

use arcfeed_nc::modal::Pose;
use arcfeed_units::Nm;

use crate::active::ActiveSegment;
use crate::controller::{Controller, ControllerState, Measurement, PositionSample};
use crate::supervisor::input::Work;

/// Tolerance of a segment's end: a few times the noise of the position.
const END_TOLERANCE_MM: f32 = 0.01;
/// Tolerance of every axis at the end of a rapid.
const REST_TOLERANCE: Nm = Nm(20_000);

/// Finds out, from the position alone, which of the queued segments is in execution and when it ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Follower {
    progress: ControllerState,
    is_entered: bool,
    count: u32,
}

impl Follower {
    /// The segment in execution, which is the first one of the queue, with its number. The number is unique, also
    /// across restarts. `None` if the queue is empty.
    pub fn in_work<'s>(&self, front: Option<&'s ActiveSegment>) -> Work<'s> {
        front.map(|segment| (self.count, segment))
    }

    /// Processes the position of a tick; `front` is the first segment of the queue. Returns whether that segment has
    /// ended and must leave the queue.
    pub fn follow(&mut self, controller: &Controller, front: &ActiveSegment, measured: &Measurement) -> bool {
        let sample = PositionSample { position: measured.position.as_ref(), dt: measured.dt };
        controller.follow(&mut self.progress, front, &sample, !self.is_entered);
        self.is_entered = true;
        let is_done = is_done(front, &self.progress, measured.position.as_ref());
        if is_done {
            self.next_segment();
        }
        is_done
    }

    /// Starts anew after the queue was emptied.
    pub fn restart(&mut self) {
        self.progress = ControllerState::default();
        self.next_segment();
    }

    fn next_segment(&mut self) {
        self.is_entered = false;
        self.count = self.count.wrapping_add(1);
    }
}

fn is_done(segment: &ActiveSegment, state: &ControllerState, position: Option<&Pose>) -> bool {
    match segment.length_mm() {
        Some(length_mm) => state.progress().travelled_mm() >= length_mm - END_TOLERANCE_MM,
        None => position.is_some_and(|position| {
            let axes = position.linear.iter().zip(&segment.end().linear);
            axes.map(|(at, end)| at.0.abs_diff(end.0)).all(|distance| distance <= REST_TOLERANCE.0.unsigned_abs())
        }),
    }
}
