//! The tick: (segment, position, spindle) -> override, feed per tooth at the centre, reason.

use arcfeed_shared::fmath;
use arcfeed_shared::job::{Job, OverrideLimits};
use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::units::{MmPerMin, MmPerTooth, RevPerMin, Span};

use crate::active::{ActiveSegment, Way};
use crate::law::{FeedLaw, NoWish, Wish};
use crate::progress::{PositionFilter, Progress, Track};
use crate::ramp::{Bound, FeedOverride, LimitsError, Ramp, RampState};

/// The controller of one machine; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    ramp: Ramp,
    filter: PositionFilter,
}

/// What the controller remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    ramp: RampState,
    progress: Progress,
    feed_sent: Option<MmPerMin>,
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

/// A wish that no bound stands in the way of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UsualWish {
    /// Wanted feed over the feed as sent.
    pub wanted_ratio: f32,
    /// The feed per tooth at the centre, along the path.
    pub ipt_center: MmPerTooth,
}

/// What the law wants at a tick, before any bound.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    ratio: f32,
    ipt_center: Option<MmPerTooth>,
    reason: Reason,
}

impl State {
    /// The ratio of wanted to sent feed in effect, before rounding.
    pub fn ratio(&self) -> f32 {
        self.ramp.ratio()
    }

    /// How far the segment in work is; of no meaning on rapids.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Takes up the feed of the next segment; that feed over the one before.
    fn take_feed(&mut self, feed_sent: Option<MmPerMin>) -> f32 {
        let change = match (self.feed_sent, feed_sent) {
            (Some(before), Some(now)) => now.0 / before.0,
            _ => 1.0,
        };
        self.feed_sent = feed_sent;
        change
    }

    /// Goes on from `ratio`: what was put out while something else had the override.
    pub fn force_ratio(&mut self, ratio: f32) {
        self.ramp.force(ratio);
    }
}

impl Controller {
    /// A controller for a job.
    ///
    /// # Errors
    /// Bounds of the override that make no sense.
    pub fn new(job: &Job) -> Result<Self, LimitsError> {
        Controller::within(&job.limits)
    }

    /// A controller for every job with these bounds.
    ///
    /// # Errors
    /// As of [`Controller::new`].
    pub fn within(limits: &OverrideLimits) -> Result<Self, LimitsError> {
        let ramp = Ramp::new(limits)?;
        Ok(Controller { ramp, filter: PositionFilter::Exact })
    }

    /// The same controller for positions that are noisy, late or now and then missing.
    #[must_use]
    pub fn with_filter(self, filter: PositionFilter) -> Self {
        Controller { filter, ..self }
    }

    /// The first tick on a segment that becomes active.
    pub fn begin(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> Output {
        if let Some(wish) = self.begin_usual(state, segment, input) {
            return self.put_out(state, &wish, input.dt);
        }
        state.progress = segment.way.begin(state.progress.speed_mm_per_s());
        let feed_change = state.take_feed(segment.feed_sent());
        let wanted = self.wanted(state, segment, input);
        let (ratio, _) = wanted.followed(segment, state, input);
        self.ramp.enter_block(&mut state.ramp, ratio, feed_change);
        self.obey_ramp(state, segment, &wanted, input)
    }

    /// The same where the segment is of the commonest kind and no bound stands in the law's way: everything but the tick of
    /// the ramp. If `None`, nothing is done yet.
    #[inline(always)]
    pub(crate) fn begin_usual(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> Option<UsualWish> {
        let Way::Rotation { track, feed, .. } = &segment.way else { return None };
        let before = state.progress;
        state.progress = track.begin(before.speed_mm_per_s());
        let Some(wish) = self.usual_wish(state, segment, input) else {
            state.progress = before;
            return None;
        };
        let feed_change = state.take_feed(Some(feed.feed));
        state.ramp.enter_block(wish.wanted_ratio, feed_change);
        Some(wish)
    }

    #[inline(always)]
    fn put_out(&self, state: &mut State, wish: &UsualWish, dt: Span) -> Output {
        let arrives = self.ramp.approach(&mut state.ramp, wish.wanted_ratio, dt);
        Output {
            feed_override: self.ramp.round_down(&state.ramp),
            ipt_center: Some(wish.ipt_center),
            wanted_ratio: wish.wanted_ratio,
            reason: if arrives { Reason::Law } else { Reason::Bounded(Bound::Slew) },
        }
    }

    /// Any other tick on the active segment.
    pub fn tick(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> Output {
        let Some(wish) = self.usual_wish(state, segment, input) else {
            return self.tick_otherwise(state, segment, input);
        };
        self.put_out(state, &wish, input.dt)
    }

    /// Moves on along the commonest kind of segment; the law's wish there, if no bound stands in its way. If `None`, the tick
    /// is to be done as any other.
    #[inline(always)]
    pub(crate) fn usual_wish(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> Option<UsualWish> {
        let (Way::Rotation { track, law, feed }, PositionFilter::Exact, Some(position)) =
            (&segment.way, &self.filter, &input.position)
        else {
            return None;
        };
        let [x, y, _] = position.linear;
        let path = law.path_mm_per_tooth(track.follow(&mut state.progress, [x, y]));
        let wanted = input.spindle.0 * path * feed.teeth_min_per_mm;
        let allowed = segment.envelope.ratio_at(state.progress.travelled_mm(), input.spindle);
        let ratio = if wanted > allowed { allowed } else { wanted };
        // What is not a number is not held: neither a refusal of the law nor a spindle without speed.
        let is_held = feed.range.contains(wanted) && feed.range.contains(ratio);
        is_held.then_some(UsualWish { wanted_ratio: ratio, ipt_center: MmPerTooth(path) })
    }

    /// [`Controller::tick`] where [`Controller::usual_wish`] is none.
    #[inline(never)]
    pub(crate) fn tick_otherwise(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> Output {
        let wanted = self.wanted(state, segment, input);
        self.obey_ramp(state, segment, &wanted, input)
    }

    fn obey_ramp(&self, state: &mut State, segment: &ActiveSegment, wanted: &Wanted, input: &Input) -> Output {
        let (ratio, followed) = wanted.followed(segment, state, input);
        let (feed_override, bound) = self.ramp.step(&mut state.ramp, ratio, input.dt);
        let bound = if bound == Bound::Free { followed } else { bound };
        Output {
            feed_override,
            ipt_center: wanted.ipt_center,
            wanted_ratio: wanted.ratio,
            reason: if bound == Bound::Free { wanted.reason } else { Reason::Bounded(bound) },
        }
    }

    #[inline(never)]
    fn wanted(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> Wanted {
        let progress = &mut state.progress;
        let mut advance = |track: &Track| {
            track.advance(&self.filter, progress, input.position.as_ref(), input.dt);
            track.place(progress)
        };
        let (wish, feed) = match &segment.way {
            Way::Rotation { track, law, feed } => (law.wish(&advance(&Track::Arc(*track))), feed),
            Way::Cut { track, law, feed: Some(feed) } => (law.wish(&advance(track)), feed),
            Way::Cut { track, feed: None, .. } => {
                advance(track);
                return as_programmed(Reason::Inhibited);
            }
            Way::Rapid => return as_programmed(Reason::Inhibited),
        };
        match wish {
            Err(NoWish::NoLaw) => as_programmed(Reason::NoWish(NoWish::NoLaw)),
            _ if !fmath::is_positive(input.spindle.0) => as_programmed(Reason::NoSpindle),
            Ok(Wish { path_mm_per_tooth, .. }) => {
                let ratio = input.spindle.0 * path_mm_per_tooth * feed.teeth_min_per_mm;
                Wanted { ratio, ipt_center: Some(MmPerTooth(path_mm_per_tooth)), reason: Reason::Law }
            }
            // No feed is too high for the chip: the bounds decide.
            Err(NoWish::ChipUnreachable) => {
                let reason = Reason::NoWish(NoWish::ChipUnreachable);
                Wanted { ratio: f32::INFINITY, ipt_center: None, reason }
            }
            Err(refusal) => as_programmed(Reason::NoWish(refusal)),
        }
    }
}

impl Wanted {
    /// The part that the machine can follow and that what comes further on allows; without a wish 100 % stays 100 %.
    fn followed(&self, segment: &ActiveSegment, state: &State, input: &Input) -> (f32, Bound) {
        let (ratio, bound) = match self.reason {
            Reason::Law | Reason::NoWish(NoWish::ChipUnreachable) => segment.followed(self.ratio),
            _ => (self.ratio, Bound::Free),
        };
        // A spindle at rest makes no chip.
        if self.reason == Reason::NoSpindle {
            return (ratio, bound);
        }
        let allowed = segment.envelope.ratio_at(state.progress.travelled_mm(), input.spindle);
        if ratio > allowed {
            (allowed, if self.reason == Reason::Law { Bound::Ahead } else { bound })
        } else {
            (ratio, bound)
        }
    }
}

fn as_programmed(reason: Reason) -> Wanted {
    Wanted { ratio: 1.0, ipt_center: None, reason }
}
