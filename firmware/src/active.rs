//! A segment as the tick takes it: law, track, feed and limits worked out once, when the block arrives.

use arcfeed_shared::cut::CutRule;
use arcfeed_shared::engaged::EngagedTable;
use arcfeed_shared::fmath;
use arcfeed_shared::job::Job;
use arcfeed_shared::machine::{FeedLimit, LimitedBy};
use arcfeed_shared::nc::modal::{Feed, Plane, Pose};
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{MmPerMin, PERCENT};

use crate::law::SegmentLaw;
use crate::law::circumference::Circumference;
use crate::progress::{ArcTrack, Progress, Track};
use crate::ramp::{Bound, FeedOverride, RatioRange};

/// A segment with its law, prepared once when the block becomes active.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveSegment {
    pub(crate) way: Way,
    end: Pose,
}

/// What a segment is for the tick.
#[derive(Clone, Debug, PartialEq)]
#[repr(u32)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and few segments are prepared at a time")]
pub(crate) enum Way {
    /// The commonest move of a cup mill, which the tick is cut for: an arc in the XY plane under the circumference law.
    Rotation { track: ArcTrack, law: Circumference, feed: SentFeed },
    /// Any other cutting move; without a feed the override has nothing to act on.
    Cut { track: Track, law: SegmentLaw, feed: Option<SentFeed> },
    /// The way there is the machine's: there is no track to be on.
    Rapid,
}

/// The feed as sent to the control, and what turns revolutions per minute and a path per tooth into a ratio to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SentFeed {
    pub feed: MmPerMin,
    /// Teeth over the feed, min/mm.
    pub teeth_min_per_mm: f32,
    /// The ratios to it that no bound changes.
    pub range: RatioRange,
    /// The largest ratio to it that the machine can follow.
    machine: Option<MachineRatio>,
}

/// The fastest feed of the machine on a segment, over the feed as sent.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MachineRatio {
    ratio: f32,
    by: LimitedBy,
}

impl ActiveSegment {
    /// Prepares a segment of the program as the control received it, with the cut rule that speaks of it.
    pub fn new(segment: &Segment, rule: Option<&CutRule>, job: &Job) -> Self {
        ActiveSegment::told(segment, rule, None, job)
    }

    /// The same with the engaged arcs that were told with it, if any were.
    pub fn told(segment: &Segment, rule: Option<&CutRule>, along: Option<&EngagedTable>, job: &Job) -> Self {
        ActiveSegment::limited(segment, rule, along, job, || job.machine.feed_limit(segment))
    }

    /// The same where the fastest feed on the segment is known from elsewhere; it is only asked where the override acts.
    pub fn limited(
        segment: &Segment,
        rule: Option<&CutRule>,
        along: Option<&EngagedTable>,
        job: &Job,
        limit: impl FnOnce() -> Option<FeedLimit>,
    ) -> Self {
        let feed = match (&segment.path, segment.feed) {
            (Path::Line | Path::Arc(_), Feed::PerMinute(feed)) if feed.0 > 0 => {
                Some(SentFeed::new(MmPerMin(feed.to_mm() as f32), limit(), job))
            }
            _ => None,
        };
        let law = SegmentLaw::told(segment, rule, along, job);
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

    /// The part of a wish for this many times the feed as sent that the machine can follow, and what bounds it.
    pub(crate) fn followed(&self, wanted_ratio: f32) -> (f32, Bound) {
        match self.sent().and_then(|sent| sent.machine) {
            Some(MachineRatio { ratio, by }) if wanted_ratio > ratio => (ratio, Bound::Machine(by)),
            _ => (wanted_ratio, Bound::Free),
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
    pub(crate) fn feed_sent(&self) -> Option<MmPerMin> {
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
            teeth_min_per_mm: f32::from(job.tool.active_teeth()) / feed.0,
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

    pub fn begin(&self, speed_mm_per_s: f32) -> Progress {
        match self {
            Way::Rotation { track, .. } => track.begin(speed_mm_per_s),
            Way::Cut { track, .. } => track.begin(speed_mm_per_s),
            Way::Rapid => Progress::default(),
        }
    }
}
