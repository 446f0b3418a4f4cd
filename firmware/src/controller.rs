//! Position of the tool along its segment, from the measured position.

use arcfeed_nc::modal::Pose;
use arcfeed_units::{MmPerMin, RevPerMin, Span};

use crate::active::ActiveSegment;
use crate::progress::{PositionFilter, Progress};

/// Computes the progress of the tool along its segment from measured positions. Holds only settings; the state is a
/// [`ControllerState`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    filter: PositionFilter,
}

/// Progress of the tool on the segment in execution, and the segment's sent feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControllerState {
    progress: Progress,
    feed_sent: Option<MmPerMin>,
    feed_change_ratio: f32,
}

/// Position, spindle speed and time that a board has measured at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Position of the tool's centre in the program's coordinates; `None` if there is no new one since the last tick.
    pub position: Option<Pose>,
    /// Measured spindle speed; 0 if unknown.
    pub spindle: RevPerMin,
    /// Time since the last tick.
    pub dt: Span,
}

/// Position from which the progress along a segment is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionSample<'a> {
    /// Position of the tool's centre; `None` if there is no new one since the last tick.
    pub position: Option<&'a Pose>,
    /// Time since the last tick, limited to the longest expected tick.
    pub dt: Span,
}

impl Default for ControllerState {
    fn default() -> Self {
        ControllerState { progress: Progress::default(), feed_sent: None, feed_change_ratio: 1.0 }
    }
}

impl ControllerState {
    /// Progress on the segment in execution; meaningless if that is a rapid.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Ratio of the sent feeds of this segment and the previous one; 1 if one of them has none.
    pub(crate) fn feed_change_ratio(&self) -> f32 {
        self.feed_change_ratio
    }

    /// Not inlined: most ticks begin no segment.
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
    /// A controller that filters positions in this way.
    pub const fn new(filter: PositionFilter) -> Self {
        Controller { filter }
    }

    /// Processes the position of one tick; `begins` is true at the first tick of a segment.
    #[inline(always)]
    pub fn follow(
        &self,
        state: &mut ControllerState,
        segment: &ActiveSegment,
        sample: &PositionSample<'_>,
        begins: bool,
    ) {
        if begins {
            state.begin(segment);
        }
        if let Some(track) = segment.track() {
            track.advance(&self.filter, &mut state.progress, sample.position, sample.dt);
        }
    }
}
