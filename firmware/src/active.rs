//! A segment prepared for the tick: track, feed, limits and the ratio along it are computed once, when the block
//! arrives.

use arcfeed_model::cut::CutRule;
use arcfeed_model::job::{Job, ToolSetup};
use arcfeed_model::machine::{FeedLimit, LimitedBy};
use arcfeed_nc::modal::{Feed, Pose};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::fmath;
use arcfeed_units::{MmPerMin, MmPerTooth, PERCENT, RevPerMin};

use crate::envelope::{Envelope, Sent};
use crate::progress::Track;
use crate::ramp::FeedOverride;
use arcfeed_law::SegmentLaw;
use arcfeed_law::move_table::MoveTable;

/// One move of the program, prepared for the control ticks when its block arrives: its path, its sent feed, its
/// limits, and the largest override ratio at each place of it.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveSegment {
    /// `None` for a rapid: the machine decides its path.
    track: Option<Track>,
    /// `None` if the override has nothing to act on.
    sent: Option<SentFeed>,
    end: Pose,
    /// Ratio along the segment under its law.
    pub(crate) envelope: Envelope,
}

/// Feed as sent to the control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SentFeed {
    pub feed: MmPerMin,
    /// Feed per tooth at the centre at this feed and the commanded spindle speed.
    pub ipt_center: MmPerTooth,
    pub machine: MachineRatio,
}

/// Feed limit of the machine on a segment relative to the sent feed; infinite without a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MachineRatio {
    pub feed_ratio: f32,
    pub by: LimitedBy,
}

/// Conditions that decide about the feed of a segment besides its geometry: cut rule, engagement, spindle speed, limits.
#[derive(Clone, Copy, Debug)]
pub struct Conditions<'a> {
    /// Cut rule whose law governs the segment; `None` if no law does.
    pub rule: Option<&'a CutRule>,
    /// Table along the segment: engaged arcs for a rule that expects them with each move, or feeds for a segment without
    /// a rule; otherwise `None`.
    pub along: Option<&'a MoveTable>,
    /// Commanded spindle speed, for which the law computes the feed.
    pub spindle: RevPerMin,
    /// Largest feed on the segment by the machine's limits and, if a law governs it, by the job's; `None` for rapids
    /// and where no limit is known.
    pub limit: Option<FeedLimit>,
    /// Largest override at the end of the segment, %, above which the next move would begin too fast; 100 if the next
    /// move does not matter.
    pub end_percent: u8,
}

impl<'a> Conditions<'a> {
    /// Conditions of a move as the control received it: the spindle speed is the job's, the move's F counts as the
    /// programmed feed, and no next move is considered.
    pub fn of(segment: &Segment, rule: Option<&'a CutRule>, job: &Job) -> Self {
        Conditions::with_table(segment, (rule, None), job)
    }

    /// As [`Conditions::of`], for a move with this rule and this table.
    pub fn with_table(
        segment: &Segment,
        (rule, along): (Option<&'a CutRule>, Option<&'a MoveTable>),
        job: &Job,
    ) -> Self {
        Conditions {
            rule,
            along,
            spindle: setup(rule, job).spindle,
            limit: limit(segment, is_governed(rule, along), job),
            end_percent: FeedOverride::PROGRAMMED.percent,
        }
    }

    /// Whether a law governs the move: that of its rule, or its table of feeds.
    pub fn is_governed(&self) -> bool {
        is_governed(self.rule, self.along)
    }
}

fn is_governed(rule: Option<&CutRule>, along: Option<&MoveTable>) -> bool {
    rule.is_some() || along.and_then(MoveTable::feeds).is_some()
}

/// Tool of a move's rule; the job's first tool without a rule.
fn setup<'j>(rule: Option<&CutRule>, job: &'j Job) -> &'j ToolSetup {
    rule.map_or(job.tools.first(), |rule| job.tool_of(rule))
}

/// Feed limit of a move; the job's ceiling applies only if a law governs the move.
fn limit(segment: &Segment, is_governed: bool, job: &Job) -> Option<FeedLimit> {
    match segment.feed {
        Feed::PerMinute(feed) if is_governed && segment.path != Path::Rapid => job.feed_limit(segment, Some(feed)),
        _ => job.machine.feed_limit(segment),
    }
}

impl ActiveSegment {
    /// Prepares a move as the control received it; `rule` is the cut rule whose law governs it, `None` if no law does.
    pub fn new(segment: &Segment, rule: Option<&CutRule>, job: &Job) -> Self {
        ActiveSegment::with_conditions(segment, &Conditions::of(segment, rule, job), job)
    }

    /// Prepares a move under these conditions, with the law of their cut rule or table.
    pub fn with_conditions(segment: &Segment, conditions: &Conditions<'_>, job: &Job) -> Self {
        let law = SegmentLaw::with_table(segment, conditions.rule, conditions.along, job);
        ActiveSegment::with_law(segment, &law, conditions, job)
    }

    /// Prepares a move under this law instead of that of its cut rule.
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

    /// Length of the path, mm; of a helix, of its arc in the plane. `None` for a rapid.
    pub fn length_mm(&self) -> Option<f32> {
        self.track.as_ref().map(Track::length_mm)
    }

    /// Largest override with which the move may begin, %. Above it, the law's demand or a feed limit at its beginning
    /// would be exceeded.
    pub fn begin_percent(&self) -> u8 {
        let machine = self.sent.map_or(f32::INFINITY, |sent| sent.machine.feed_ratio);
        // The cast saturates at 255.
        self.envelope.begin_percent().min((machine * PERCENT) as u8)
    }

    /// Amount by which the override must be below 100 % at the end of this segment because of the next one, as a
    /// ratio; 0 if 100 % is allowed.
    pub fn reserve_ratio(&self) -> f32 {
        self.envelope.reserve_ratio()
    }

    /// Positions of the axes at the end of the segment.
    pub fn end(&self) -> &Pose {
        &self.end
    }

    /// Whether the feed override acts on the segment; it does not on rapids, on inverse-time feeds, or without a feed.
    pub fn takes_override(&self) -> bool {
        self.sent.is_some()
    }

    /// Feed of the machine at this override, reduced to the segment's feed limit; `None` if the override does not act
    /// on the segment.
    pub fn feed_at(&self, feed_override: FeedOverride) -> Option<MmPerMin> {
        let sent = self.sent.as_ref()?;
        let ratio = fmath::min(f32::from(feed_override.percent) / PERCENT, sent.machine.feed_ratio);
        Some(MmPerMin(sent.feed.0 * ratio))
    }

    /// Ratio of a feed per tooth at the tool's centre to the one that the sent feed gives at the commanded spindle
    /// speed; `None` if the override does not act on the segment.
    pub fn ratio_of(&self, ipt_center: MmPerTooth) -> Option<f32> {
        self.sent.as_ref().map(|sent| ipt_center.0 / sent.ipt_center.0)
    }

    /// Feed as sent to the control; `None` if the override must not act on it.
    pub(crate) fn sent(&self) -> Option<&SentFeed> {
        self.sent.as_ref()
    }

    /// Track; `None` for a rapid.
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
