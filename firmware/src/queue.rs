//! Which segment is in work, from the position alone: for boards that see the program and the axes, but not the
//! control's block number.
//!
//! Segments queue up ahead of the control, in whatever queue the board has. The one in work gives way to the next when the
//! place reached lies at its end; a rapid, whose way is the machine's, when the axes stand at its end. Only ends are
//! looked at, so a program that runs back over its own path (D - base - E) cannot fool it.
//!
//! The way along the segment is this module's own: the supervisor's stands still, at what it was on a segment before, while
//! samples are stale or the segment in work is one whose beginning it did not see; and the queue must get past that one
//! for the next to begin.

use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::units::Nm;

use crate::active::ActiveSegment;
use crate::controller::{Controller, Input, Sample, State};
use crate::supervisor::input::Work;

/// How near its end a segment counts as done: a few times the noise of the position.
const END_TOLERANCE_MM: f32 = 0.01;
/// How near every axis must stand to a rapid's end.
const REST_TOLERANCE: Nm = Nm(20_000);

/// Follows the position through the segments ahead; state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Follower {
    way: State,
    is_entered: bool,
    count: u32,
}

impl Follower {
    /// The queue's front as the segment in work. Its count tells it from all others, of runs before too.
    pub fn in_work<'s>(&self, front: Option<&'s ActiveSegment>) -> Work<'s> {
        front.map(|segment| (self.count, segment))
    }

    /// Moves along the segment in work; true where it is done and must leave the queue.
    pub fn follow(&mut self, controller: &Controller, front: &ActiveSegment, measured: &Input) -> bool {
        let sample = Sample { position: measured.position.as_ref(), dt: measured.dt };
        controller.follow(&mut self.way, front, &sample, !self.is_entered);
        self.is_entered = true;
        let is_done = is_done(front, &self.way, measured.position.as_ref());
        if is_done {
            self.go_on();
        }
        is_done
    }

    /// The front is another one than expected: the queue was emptied.
    pub fn restart(&mut self) {
        self.way = State::default();
        self.go_on();
    }

    fn go_on(&mut self) {
        self.is_entered = false;
        self.count = self.count.wrapping_add(1);
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
