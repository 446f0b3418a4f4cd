//! The tick: (segment, position, spindle) -> override, feed per tooth at the centre, reason.

use arcfeed_shared::cut::CutRule;
use arcfeed_shared::fmath;
use arcfeed_shared::job::Job;
use arcfeed_shared::nc::modal::{Feed, Pose};
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{Micros, MmPerMin, MmPerTooth, RevPerMin};

use crate::law::{NoWish, SegmentLaw, Wish};
use crate::progress::{PositionFilter, Progress, Track};
use crate::ramp::{Bound, FeedOverride, LimitsError, Ramp, RampState};

/// The controller of one machine; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    ramp: Ramp,
    filter: PositionFilter,
    teeth: f32,
}

/// A segment with its law, prepared once when the block becomes active.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveSegment {
    law: SegmentLaw,
    track: Option<Track>,
    /// The feed as sent to the control; `None` where the override must not act on it.
    feed_sent: Option<MmPerMin>,
    end: Pose,
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
    /// Where the tool's centre is; `None` if there is no new sample since the last tick.
    pub position: Option<Pose>,
    /// Spindle speed.
    pub spindle: RevPerMin,
    /// Time since the last tick.
    pub dt: Micros,
}

/// What a tick decides.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Output {
    /// The override to put out.
    pub feed_override: FeedOverride,
    /// The feed per tooth at the centre that the law wants, along the path.
    pub ipt_center: Option<MmPerTooth>,
    /// Wanted feed over the feed as sent, before any bound.
    pub wanted_ratio: f32,
    /// Why this override.
    pub reason: Reason,
}

/// Why the override is what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reason {
    /// The law's wish, rounded to the thin side.
    Law,
    /// The law's wish, held back by a bound.
    Bounded(Bound),
    /// No law governs this segment, or it has no wish here: 100 %.
    NoWish(NoWish),
    /// Rapid, inverse time, or no programmed feed: the override has nothing to act on, 100 %.
    Inhibited,
    /// The spindle's speed is not a positive number: 100 %.
    NoSpindle,
}

impl State {
    /// The ratio of wanted to sent feed in effect, before rounding.
    pub fn ratio(&self) -> f32 {
        self.ramp.ratio()
    }

    /// How far the segment in work is; `None` before the first and on rapids.
    pub fn progress(&self) -> Option<&Progress> {
        self.progress.as_ref()
    }

    /// Goes on from `ratio`: what was put out while something else had the override.
    pub fn force_ratio(&mut self, ratio: f32) {
        self.ramp.force(ratio);
    }
}

impl ActiveSegment {
    /// Prepares a segment of the program as the control received it, with the cut rule that speaks of it.
    pub fn new(segment: &Segment, rule: Option<&CutRule>, job: &Job) -> Self {
        let feed_sent = match (&segment.path, segment.feed) {
            (Path::Line | Path::Arc(_), Feed::PerMinute(feed)) if feed.0 > 0 => Some(MmPerMin(feed.to_mm() as f32)),
            _ => None,
        };
        let law = SegmentLaw::for_segment(segment, rule, job);
        ActiveSegment { law, track: Track::new(segment), feed_sent, end: segment.end }
    }

    /// The same segment under another law.
    #[must_use]
    pub fn with_law(self, law: SegmentLaw) -> Self {
        ActiveSegment { law, ..self }
    }

    /// Length of its path; `None` for a rapid.
    pub fn length_mm(&self) -> Option<f32> {
        self.track.as_ref().map(Track::length_mm)
    }

    /// Where it ends.
    pub fn end(&self) -> &Pose {
        &self.end
    }

    /// Whether the override acts on it: not on rapids, inverse time, or without a feed.
    pub fn takes_override(&self) -> bool {
        self.feed_sent.is_some()
    }
}

impl Controller {
    /// A controller for a job.
    ///
    /// # Errors
    /// Bounds of the override that make no sense.
    pub fn new(job: &Job) -> Result<Self, LimitsError> {
        let ramp = Ramp::new(&job.limits)?;
        Ok(Controller { ramp, filter: PositionFilter::Exact, teeth: f32::from(job.tool.active_teeth()) })
    }

    /// The same controller for positions that are noisy, late or now and then missing.
    #[must_use]
    pub fn with_filter(self, filter: PositionFilter) -> Self {
        Controller { filter, ..self }
    }

    /// Takes up a segment: call once when it becomes active, before its first tick.
    pub fn enter(&self, state: &mut State, segment: &ActiveSegment) {
        let speed_mm_per_s = state.progress.map_or(0.0, |progress| progress.speed_mm_per_s());
        state.progress = segment.track.as_ref().map(|track| track.begin(speed_mm_per_s));
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
            wanted_ratio,
            reason: if bound == Bound::Free { reason } else { Reason::Bounded(bound) },
        }
    }

    /// The ratio of wanted to programmed feed, the law's wish if it has one, and the reason.
    #[inline(always)]
    fn wanted(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> (f32, Option<Wish>, Reason) {
        let as_programmed = |reason| (1.0, None, reason);
        // A rapid's way is the machine's: there is no track to be on.
        let (Some(track), Some(progress)) = (&segment.track, &mut state.progress) else {
            return as_programmed(Reason::Inhibited);
        };
        track.advance(&self.filter, progress, input.position.as_ref(), input.dt);
        let Some(feed_sent) = segment.feed_sent else {
            return as_programmed(Reason::Inhibited);
        };
        let teeth_per_min = input.spindle.0 * self.teeth;
        let turns = fmath::is_positive(teeth_per_min);
        match segment.law.wish_at(|| track.place(progress)) {
            Err(NoWish::NoLaw) => as_programmed(Reason::NoWish(NoWish::NoLaw)),
            _ if !turns => as_programmed(Reason::NoSpindle),
            Ok(wish) => (teeth_per_min * wish.path_mm_per_tooth / feed_sent.0, Some(wish), Reason::Law),
            // No feed is too high for the chip: the bounds decide.
            Err(NoWish::ChipUnreachable) => (f32::INFINITY, None, Reason::NoWish(NoWish::ChipUnreachable)),
            Err(refusal) => as_programmed(Reason::NoWish(refusal)),
        }
    }
}
