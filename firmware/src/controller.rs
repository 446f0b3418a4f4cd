//! Where on its segment the tool is: what is measured, and the way along the segment that follows from it.

use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::units::{MmPerMin, RevPerMin, Span};

use crate::active::ActiveSegment;
use crate::progress::{PositionFilter, Progress};

/// Follows the position along segments; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    filter: PositionFilter,
}

/// The way along the segment in work, and its feed as sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    progress: Progress,
    feed_sent: Option<MmPerMin>,
    feed_change_ratio: f32,
}

/// What is measured at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Where the tool's centre is; `None` if there is no new sample since the last tick.
    pub position: Option<Pose>,
    /// Spindle speed.
    pub spindle: RevPerMin,
    /// Time since the last tick.
    pub dt: Span,
}

/// What the way along the segment follows from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<'a> {
    /// As of [`Input::position`].
    pub position: Option<&'a Pose>,
    /// Time since the last tick, as far as it counts.
    pub dt: Span,
}

impl Default for State {
    fn default() -> Self {
        State { progress: Progress::default(), feed_sent: None, feed_change_ratio: 1.0 }
    }
}

impl State {
    /// How far the segment in work is; of no meaning on rapids.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// The feed as sent on the segment in work over that on the one before; 1 where one of them has none.
    pub(crate) fn feed_change_ratio(&self) -> f32 {
        self.feed_change_ratio
    }

    /// Never inline: most ticks begin nothing.
    #[inline(never)]
    fn begin(&mut self, segment: &ActiveSegment) {
        let feed_sent = segment.sent().map(|sent| sent.feed);
        self.feed_change_ratio = match (self.feed_sent, feed_sent) {
            (Some(before), Some(now)) => now.0 / before.0,
            _ => 1.0,
        };
        self.feed_sent = feed_sent;
        self.progress = segment.track().map_or(Progress::default(), |track| track.begin(&self.progress));
    }
}

impl Controller {
    /// A controller for positions that are noisy, late or now and then missing, or for such that are not.
    pub const fn new(filter: PositionFilter) -> Self {
        Controller { filter }
    }

    /// A tick on a segment, which `begins` at the first one.
    #[inline(always)]
    pub fn follow(&self, state: &mut State, segment: &ActiveSegment, sample: &Sample<'_>, begins: bool) {
        if begins {
            state.begin(segment);
        }
        if let Some(track) = segment.track() {
            track.advance(&self.filter, &mut state.progress, sample.position, sample.dt);
        }
    }
}
