//! A segment as the tick takes it: law, track, feed and limits worked out once, when the block arrives.

use arcfeed_shared::cut::CutRule;
use arcfeed_shared::engaged::EngagedTable;
use arcfeed_shared::fmath;
use arcfeed_shared::job::{Job, OverrideLimits, ToolSetup};
use arcfeed_shared::machine::{FeedLimit, LimitedBy};
use arcfeed_shared::nc::modal::{Feed, Plane, Pose};
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{MmPerMin, PERCENT, RevPerMin};

use crate::envelope::{Envelope, Sent};
use crate::law::SegmentLaw;
use crate::law::circumference::Circumference;
use crate::progress::{ArcTrack, Progress, Track};
use crate::ramp::{Bound, FeedOverride, RatioRange};

/// A segment with its law, prepared once when the block becomes active.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveSegment {
    pub(crate) way: Way,
    end: Pose,
    /// How high the override may be along it.
    pub(crate) envelope: Envelope,
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

/// What holds for a segment beside its geometry.
#[derive(Clone, Copy, Debug)]
pub struct Conditions<'a> {
    /// The cut rule whose law governs it.
    pub rule: Option<&'a CutRule>,
    /// Where the tool's circles are engaged along it, for a rule that leaves that to each move.
    pub along: Option<&'a EngagedTable>,
    /// Commanded spindle speed.
    pub spindle: RevPerMin,
    /// The fastest feed on it; rapids have none.
    pub limit: Option<FeedLimit>,
    /// Largest override at its end, %: what the move behind it begins with.
    pub end_percent: u8,
}

impl<'a> Conditions<'a> {
    /// Those of a move of the program as the control received it: its own F counts as the programmed one.
    pub fn of(segment: &Segment, rule: Option<&'a CutRule>, job: &Job) -> Self {
        Conditions {
            rule,
            along: None,
            spindle: setup(rule, job).spindle,
            limit: limit(segment, rule.is_some(), job),
            end_percent: FeedOverride::PROGRAMMED.percent,
        }
    }
}

/// The tool of a move's rule; the job's first one where it has none.
fn setup<'j>(rule: Option<&CutRule>, job: &'j Job) -> &'j ToolSetup {
    rule.map_or(job.tools.first(), |rule| job.tool_of(rule))
}

/// The fastest feed on a move; the job's ceiling holds where a law governs it.
fn limit(segment: &Segment, is_governed: bool, job: &Job) -> Option<FeedLimit> {
    match segment.feed {
        Feed::PerMinute(feed) if is_governed && segment.path != Path::Rapid => job.feed_limit(segment, Some(feed)),
        _ => job.machine.feed_limit(segment),
    }
}

impl ActiveSegment {
    /// Prepares a segment of the program as the control received it, with the cut rule whose law governs it.
    pub fn new(segment: &Segment, rule: Option<&CutRule>, job: &Job) -> Self {
        ActiveSegment::under(segment, &Conditions::of(segment, rule, job), job)
    }

    /// Prepares a segment under these conditions.
    pub fn under(segment: &Segment, conditions: &Conditions<'_>, job: &Job) -> Self {
        let Conditions { rule, along, spindle, limit, end_percent } = *conditions;
        let feed = match (&segment.path, segment.feed) {
            (Path::Line | Path::Arc(_), Feed::PerMinute(feed)) if feed.0 > 0 => {
                Some(SentFeed::new(MmPerMin(feed.to_mm() as f32), setup(rule, job), limit, &job.limits))
            }
            _ => None,
        };
        let law = SegmentLaw::told(segment, rule, along, job);
        let track = Track::new(segment);
        let envelope = match (&track, &feed) {
            (Some(track), Some(feed)) => {
                let SentFeed { feed, teeth_min_per_mm, machine, .. } = *feed;
                let most = f32::from(job.limits.max_percent) / PERCENT;
                let max_ratio = machine.map_or(most, |machine| fmath::min(machine.ratio, most));
                let sent = Sent { feed, teeth_min_per_mm, spindle, max_ratio, end_percent };
                Envelope::new(&law, track, &sent, &job.limits)
            }
            _ => Envelope::constant(end_percent),
        };
        let way = track.map_or(Way::Rapid, |track| Way::new(track, law, feed));
        ActiveSegment { way, end: segment.end, envelope }
    }

    /// The same segment under another law, for tests of the law alone: nothing lowers the override in time.
    #[must_use]
    pub fn with_law(self, law: SegmentLaw) -> Self {
        let way = match self.way {
            Way::Rotation { track, feed, .. } => Way::new(Track::Arc(track), law, Some(feed)),
            Way::Cut { track, feed, .. } => Way::new(track, law, feed),
            Way::Rapid => Way::Rapid,
        };
        ActiveSegment { way, envelope: Envelope::FREE, ..self }
    }

    /// Length of its path; `None` for a rapid.
    pub fn length_mm(&self) -> Option<f32> {
        match &self.way {
            Way::Rotation { track, .. } => Some(Track::Arc(*track).length_mm()),
            Way::Cut { track, .. } => Some(track.length_mm()),
            Way::Rapid => None,
        }
    }

    /// The largest override with which it can begin, %: with one above it what comes first would be cut too fast.
    pub fn begin_percent(&self) -> u8 {
        let machine = self.sent().and_then(|sent| sent.machine).map_or(f32::INFINITY, |machine| machine.ratio);
        // A float beyond 255 becomes 255.
        self.envelope.begin_percent().min((machine * PERCENT) as u8)
    }

    /// How far below 1 the ratio must be behind its end.
    pub fn reserve_ratio(&self) -> f32 {
        self.envelope.reserve_ratio()
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
    fn new(feed: MmPerMin, setup: &ToolSetup, limit: Option<FeedLimit>, limits: &OverrideLimits) -> Self {
        let machine = limit.map(|limit| MachineRatio { ratio: limit.feed.0 / feed.0, by: limit.by });
        SentFeed {
            feed,
            teeth_min_per_mm: f32::from(setup.tool.active_teeth()) / feed.0,
            range: RatioRange::new(limits, machine.map_or(f32::INFINITY, |machine| machine.ratio)),
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
