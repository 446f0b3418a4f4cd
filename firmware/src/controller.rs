//! The tick: (segment, position, spindle) -> override, feed per tooth at the centre, reason.

use arcfeed_shared::cut::CutRule;
use arcfeed_shared::fmath;
use arcfeed_shared::job::Job;
use arcfeed_shared::machine::{FeedLimit, LimitedBy};
use arcfeed_shared::nc::modal::{Feed, Plane, Pose};
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{MmPerMin, MmPerTooth, PERCENT, RevPerMin, Span};

use crate::law::circumference::Circumference;
use crate::law::{FeedLaw, NoWish, SegmentLaw, Wish};
use crate::progress::{ArcTrack, PositionFilter, Progress, Track};
use crate::ramp::{Bound, FeedOverride, LimitsError, Ramp, RampState, RatioRange};

/// The controller of one machine; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    ramp: Ramp,
    filter: PositionFilter,
}

/// A segment with its law, prepared once when the block becomes active.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveSegment {
    way: Way,
    end: Pose,
}

/// What a segment is for the tick.
#[derive(Clone, Debug, PartialEq)]
#[repr(u32)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and few segments are prepared at a time")]
enum Way {
    /// The commonest move of a cup mill, which the tick is cut for: an arc in the XY plane under the circumference law.
    Rotation { track: ArcTrack, law: Circumference, feed: SentFeed },
    /// Any other cutting move; without a feed the override has nothing to act on.
    Cut { track: Track, law: SegmentLaw, feed: Option<SentFeed> },
    /// The way there is the machine's: there is no track to be on.
    Rapid,
}

/// The feed as sent to the control, and what turns revolutions per minute and a path per tooth into a ratio to it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SentFeed {
    feed: MmPerMin,
    /// Teeth over the feed, min/mm.
    teeth_per_feed: f32,
    /// The ratios to it that no bound changes.
    range: RatioRange,
    /// The largest ratio to it that the machine can follow.
    machine: Option<MachineRatio>,
}

/// The fastest feed of the machine on a segment, over the feed as sent.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MachineRatio {
    ratio: f32,
    by: LimitedBy,
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

impl ActiveSegment {
    /// Prepares a segment of the program as the control received it, with the cut rule that speaks of it.
    pub fn new(segment: &Segment, rule: Option<&CutRule>, job: &Job) -> Self {
        let feed = match (&segment.path, segment.feed) {
            (Path::Line | Path::Arc(_), Feed::PerMinute(feed)) if feed.0 > 0 => {
                Some(SentFeed::new(MmPerMin(feed.to_mm() as f32), job.machine.feed_limit(segment), job))
            }
            _ => None,
        };
        let law = SegmentLaw::for_segment(segment, rule, job);
        let way = Track::new(segment).map_or(Way::Rapid, |track| Way::new(track, law, feed));
        ActiveSegment { way, end: segment.end }
    }

    /// The same segment under another law.
    #[must_use]
    pub fn with_law(self, law: SegmentLaw) -> Self {
        let way = match self.way {
            Way::Rotation { track, feed, .. } => Way::new(Track::Arc(track), law, Some(feed)),
            Way::Cut { track, feed, .. } => Way::new(track, law, feed),
            Way::Rapid => Way::Rapid,
        };
        ActiveSegment { way, ..self }
    }

    /// Length of its path; `None` for a rapid.
    pub fn length_mm(&self) -> Option<f32> {
        match &self.way {
            Way::Rotation { track, .. } => Some(Track::Arc(*track).length_mm()),
            Way::Cut { track, .. } => Some(track.length_mm()),
            Way::Rapid => None,
        }
    }

    /// Where it ends.
    pub fn end(&self) -> &Pose {
        &self.end
    }

    /// The part of a wish that the machine can follow; without a wish 100 % stays 100 %.
    fn followed(&self, wanted: &Wanted) -> (f32, Bound) {
        let is_wish = matches!(wanted.reason, Reason::Law | Reason::NoWish(NoWish::ChipUnreachable));
        match self.sent().and_then(|sent| sent.machine) {
            Some(MachineRatio { ratio, by }) if is_wish && wanted.ratio > ratio => (ratio, Bound::Machine(by)),
            _ => (wanted.ratio, Bound::Free),
        }
    }

    /// Whether the override acts on it: not on rapids, inverse time, or without a feed.
    pub fn takes_override(&self) -> bool {
        self.feed_sent().is_some()
    }

    /// The feed that the machine makes of an override, its limits considered; `None` where the override does not act.
    pub fn feed_at(&self, feed_override: FeedOverride) -> Option<MmPerMin> {
        let sent = self.sent()?;
        let ratio = f32::from(feed_override.percent) / PERCENT;
        let ratio = sent.machine.map_or(ratio, |machine| fmath::min(ratio, machine.ratio));
        Some(MmPerMin(sent.feed.0 * ratio))
    }

    /// The feed as sent to the control; `None` where the override must not act on it.
    fn feed_sent(&self) -> Option<MmPerMin> {
        self.sent().map(|sent| sent.feed)
    }

    fn sent(&self) -> Option<&SentFeed> {
        match &self.way {
            Way::Rotation { feed, .. } => Some(feed),
            Way::Cut { feed, .. } => feed.as_ref(),
            Way::Rapid => None,
        }
    }
}

impl SentFeed {
    fn new(feed: MmPerMin, limit: Option<FeedLimit>, job: &Job) -> Self {
        let machine = limit.map(|limit| MachineRatio { ratio: limit.feed.0 / feed.0, by: limit.by });
        SentFeed {
            feed,
            teeth_per_feed: f32::from(job.tool.active_teeth()) / feed.0,
            range: RatioRange::new(&job.limits, machine.map_or(f32::INFINITY, |machine| machine.ratio)),
            machine,
        }
    }
}

impl Way {
    fn new(track: Track, law: SegmentLaw, feed: Option<SentFeed>) -> Self {
        match (track, law, feed) {
            (Track::Arc(track), SegmentLaw::Circumference(law), Some(feed)) if track.plane() == Plane::Xy => {
                Way::Rotation { track, law, feed }
            }
            (track, law, feed) => Way::Cut { track, law, feed },
        }
    }

    fn begin(&self, speed_mm_per_s: f32) -> Progress {
        match self {
            Way::Rotation { track, .. } => track.begin(speed_mm_per_s),
            Way::Cut { track, .. } => track.begin(speed_mm_per_s),
            Way::Rapid => Progress::default(),
        }
    }
}

impl Controller {
    /// A controller for a job.
    ///
    /// # Errors
    /// Bounds of the override that make no sense.
    pub fn new(job: &Job) -> Result<Self, LimitsError> {
        let ramp = Ramp::new(&job.limits)?;
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
        self.ramp.enter_block(&mut state.ramp, segment.followed(&wanted).0, feed_change);
        self.obey_ramp(state, segment, &wanted, input.dt)
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
        let ratio = input.spindle.0 * path * feed.teeth_per_feed;
        // What is not a number is not held: neither a refusal of the law nor a spindle without speed.
        feed.range.contains(ratio).then_some(UsualWish { wanted_ratio: ratio, ipt_center: MmPerTooth(path) })
    }

    /// [`Controller::tick`] where [`Controller::usual_wish`] is none.
    #[inline(never)]
    pub(crate) fn tick_otherwise(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> Output {
        let wanted = self.wanted(state, segment, input);
        self.obey_ramp(state, segment, &wanted, input.dt)
    }

    fn obey_ramp(&self, state: &mut State, segment: &ActiveSegment, wanted: &Wanted, dt: Span) -> Output {
        let (ratio, followed) = segment.followed(wanted);
        let (feed_override, bound) = self.ramp.step(&mut state.ramp, ratio, dt);
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
                let ratio = input.spindle.0 * path_mm_per_tooth * feed.teeth_per_feed;
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

fn as_programmed(reason: Reason) -> Wanted {
    Wanted { ratio: 1.0, ipt_center: None, reason }
}
