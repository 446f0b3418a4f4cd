//! The tick: (segment, position, spindle) -> override, feed per tooth at the centre, reason.

use arcfeed_shared::cut::CutRule;
use arcfeed_shared::fmath;
use arcfeed_shared::job::Job;
use arcfeed_shared::nc::modal::{Feed, Pose};
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{Micros, MmPerMin, MmPerTooth, RevPerMin};

use crate::law::circumference::Circumference;
use crate::law::{FeedLaw, NoWish, SegmentLaw, Wish};
use crate::progress::{ArcTrack, Progress};
use crate::ramp::{Bound, FeedOverride, LimitsError, Ramp, RampState};

/// The controller of one machine; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    ramp: Ramp,
    teeth: f32,
}

/// A segment with its law, prepared once when the block becomes active.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveSegment {
    governed: Option<Governed>,
    /// The feed as sent to the control; `None` where the override must not act on it.
    feed_sent: Option<MmPerMin>,
}

/// What the tick needs of a segment that a law governs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Governed {
    law: Circumference,
    track: ArcTrack,
    feed_sent: MmPerMin,
}

/// What the controller remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    ramp: RampState,
    progress: Option<Progress>,
    feed_sent: Option<MmPerMin>,
    /// The segment's feed over the one before, until its first tick.
    feed_change: Option<f32>,
}

/// What is measured at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Where the tool's centre is.
    pub position: Pose,
    /// Spindle speed.
    pub spindle: RevPerMin,
    /// Time since the last tick.
    pub dt: Micros,
}

/// What a tick decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// The override to put out.
    pub feed_override: FeedOverride,
    /// The feed per tooth at the centre that the law wants, along the path.
    pub ipt_center: Option<MmPerTooth>,
    /// Why this override.
    pub reason: Reason,
}

/// Why the override is what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reason {
    /// The law's wish, rounded to the thin side.
    Law,
    /// The law's wish, held back by a bound.
    Bounded(Bound),
    /// The law has no wish here: 100 %.
    NoWish(NoWish),
    /// No law governs this segment: 100 %.
    NoLaw,
    /// Rapid, inverse time, or no programmed feed: the override has nothing to act on, 100 %.
    Inhibited,
    /// The spindle's speed is not a positive number: 100 %.
    NoSpindle,
}

impl ActiveSegment {
    /// Prepares a segment of the program as the control received it, with the cut rule that speaks of it.
    pub fn new(segment: &Segment, rule: Option<&CutRule>, job: &Job) -> Self {
        let feed_sent = match (&segment.path, segment.feed) {
            (Path::Line | Path::Arc(_), Feed::PerMinute(feed)) if feed.0 > 0 => Some(MmPerMin(feed.to_mm() as f32)),
            _ => None,
        };
        let governed = match (SegmentLaw::for_segment(segment, rule, job), segment.arc(), feed_sent) {
            (SegmentLaw::Circumference(law), Some(arc), Some(feed_sent)) => {
                Some(Governed { law, track: ArcTrack::new(arc), feed_sent })
            }
            _ => None,
        };
        ActiveSegment { governed, feed_sent }
    }
}

impl Controller {
    /// A controller for a job.
    ///
    /// # Errors
    /// Bounds of the override that make no sense.
    pub fn new(job: &Job) -> Result<Self, LimitsError> {
        Ok(Controller { ramp: Ramp::new(&job.limits)?, teeth: f32::from(job.tool.active_teeth) })
    }

    /// Takes up a segment: call once when it becomes active, before its first tick.
    pub fn enter(&self, state: &mut State, segment: &ActiveSegment) {
        state.progress = segment.governed.as_ref().map(|governed| governed.track.begin());
        state.feed_change = Some(match (state.feed_sent, segment.feed_sent) {
            (Some(before), Some(now)) => now.0 / before.0,
            _ => 1.0,
        });
        state.feed_sent = segment.feed_sent;
    }

    /// One tick on the active segment.
    pub fn tick(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> Output {
        let (wanted_ratio, wish, reason) = self.wanted(state, segment, input);
        if let Some(feed_change) = state.feed_change.take() {
            self.ramp.enter_block(&mut state.ramp, wanted_ratio, feed_change);
        }
        let (feed_override, bound) = self.ramp.step(&mut state.ramp, wanted_ratio, input.dt);
        Output {
            feed_override,
            ipt_center: wish.map(|wish| MmPerTooth(wish.path_mm_per_tooth)),
            reason: if bound == Bound::Free { reason } else { Reason::Bounded(bound) },
        }
    }

    /// The ratio of wanted to programmed feed, the law's wish if it has one, and the reason.
    #[inline(always)]
    fn wanted(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> (f32, Option<Wish>, Reason) {
        let as_programmed = |reason| (1.0, None, reason);
        let (Some(Governed { law, track, feed_sent }), Some(progress)) = (&segment.governed, &mut state.progress)
        else {
            return as_programmed(if segment.feed_sent.is_some() { Reason::NoLaw } else { Reason::Inhibited });
        };
        let teeth_per_min = input.spindle.0 * self.teeth;
        if !fmath::is_positive(teeth_per_min) {
            return as_programmed(Reason::NoSpindle);
        }
        match law.wish(track.advance(progress, &input.position)) {
            Ok(wish) => (teeth_per_min * wish.path_mm_per_tooth / feed_sent.0, Some(wish), Reason::Law),
            // No feed is too high for the chip: the bounds decide.
            Err(NoWish::ChipUnreachable) => (f32::INFINITY, None, Reason::NoWish(NoWish::ChipUnreachable)),
            Err(refusal) => as_programmed(Reason::NoWish(refusal)),
        }
    }
}
