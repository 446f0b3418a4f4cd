//! A segment as the tick takes it: track, feed, limits and the ratio along it worked out once, when the block arrives.

use arcfeed_shared::cut::CutRule;
use arcfeed_shared::engaged::EngagedTable;
use arcfeed_shared::fmath;
use arcfeed_shared::job::{Job, ToolSetup};
use arcfeed_shared::machine::{FeedLimit, LimitedBy};
use arcfeed_shared::nc::modal::{Feed, Pose};
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{MmPerMin, MmPerTooth, PERCENT, RevPerMin};

use crate::envelope::{Envelope, Sent};
use crate::law::SegmentLaw;
use crate::progress::Track;
use crate::ramp::FeedOverride;

/// A segment prepared once when the block becomes active.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveSegment {
    /// `None` for a rapid: the way there is the machine's.
    track: Option<Track>,
    /// `None` where the override has nothing to act on.
    sent: Option<SentFeed>,
    end: Pose,
    /// The ratio along it, under its law.
    pub(crate) envelope: Envelope,
}

/// The feed as sent to the control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SentFeed {
    pub feed: MmPerMin,
    /// The feed per tooth at the centre that it is at the commanded spindle speed.
    pub ipt_center: MmPerTooth,
    pub machine: MachineRatio,
}

/// The fastest feed of the machine on a segment, over the feed as sent; infinite where nothing limits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MachineRatio {
    pub feed_ratio: f32,
    pub by: LimitedBy,
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
        let law = SegmentLaw::with_engagement(segment, conditions.rule, conditions.along, job);
        ActiveSegment::with_law(segment, &law, conditions, job)
    }

    /// Prepares a segment under a law, whatever its rule says.
    pub fn with_law(segment: &Segment, law: &SegmentLaw, conditions: &Conditions<'_>, job: &Job) -> Self {
        let Conditions { spindle, limit, end_percent, .. } = *conditions;
        let (end, track) = (segment.end, Track::new(segment));
        let feed = match segment.feed {
            Feed::PerMinute(feed) if feed.0 > 0 => Some(MmPerMin(feed.to_mm() as f32)),
            _ => None,
        };
        let (Some(on), Some(feed)) = (&track, feed) else {
            return ActiveSegment { track, sent: None, end, envelope: Envelope::constant(end_percent) };
        };
        let teeth_min_per_mm = f32::from(setup(conditions.rule, job).tool.active_teeth()) / feed.0;
        let machine = limit.map_or(MachineRatio::FREE, |limit| MachineRatio::new(&limit, feed));
        let max_ratio = fmath::min(machine.feed_ratio, f32::from(job.limits.max_percent) / PERCENT);
        let demand = Sent { feed, teeth_min_per_mm, spindle, max_ratio, end_percent };
        let envelope = Envelope::new(law, on, &demand, &job.limits);
        let ipt_center = MmPerTooth(1.0 / (teeth_min_per_mm * spindle.0));
        ActiveSegment { track, sent: Some(SentFeed { feed, ipt_center, machine }), end, envelope }
    }

    /// Length of its path; `None` for a rapid.
    pub fn length_mm(&self) -> Option<f32> {
        self.track.as_ref().map(Track::length_mm)
    }

    /// The largest override with which it can begin, %: with one above it what comes first would be cut too fast.
    pub fn begin_percent(&self) -> u8 {
        let machine = self.sent.map_or(f32::INFINITY, |sent| sent.machine.feed_ratio);
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

    /// Whether the override acts on it: not on rapids, inverse time, or without a feed.
    pub fn takes_override(&self) -> bool {
        self.sent.is_some()
    }

    /// The feed that the machine makes of an override, its limits considered; `None` where the override does not act.
    pub fn feed_at(&self, feed_override: FeedOverride) -> Option<MmPerMin> {
        let sent = self.sent.as_ref()?;
        let ratio = fmath::min(f32::from(feed_override.percent) / PERCENT, sent.machine.feed_ratio);
        Some(MmPerMin(sent.feed.0 * ratio))
    }

    /// The feed as sent to the control; `None` where the override must not act on it.
    pub(crate) fn sent(&self) -> Option<&SentFeed> {
        self.sent.as_ref()
    }

    /// The track; `None` for a rapid.
    pub(crate) fn track(&self) -> Option<&Track> {
        self.track.as_ref()
    }
}

impl MachineRatio {
    pub const FREE: MachineRatio = MachineRatio { feed_ratio: f32::INFINITY, by: LimitedBy::Ceiling };

    fn new(limit: &FeedLimit, feed_sent: MmPerMin) -> Self {
        MachineRatio { feed_ratio: limit.feed.0 / feed_sent.0, by: limit.by }
    }
}
