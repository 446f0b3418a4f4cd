//! A block with a move: what a law wants along it, the feed it is sent with, and why.

use std::borrow::Cow;

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_law::SegmentLaw;
use arcfeed_law::table::Table;
use arcfeed_model::cut::{ContourSide, CutRule, Work};
use arcfeed_model::engaged::EngagedTable;
use arcfeed_model::job::{FeedPolicy, Job, LawKind};
use arcfeed_model::machine::LimitedBy;
use arcfeed_nc::alarm::NotModelled;
use arcfeed_nc::modal::Feed;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{LengthUnit, MmPerTooth, Nm, PERCENT, RevPerMin, S_PER_MIN};

use super::asked_cells::AskedCells;
use super::limit::MoveLimit;
use super::offset_moves::ContourPlace;
use super::places::MovePlaces;
use super::profile::Profile;
use super::range::DemandRange;
use super::reason::PlanReason;
use super::rewrite;
use super::split::{ChipError, SentPiece, Whole};
use crate::program::{Diagnostic, FeedDeparture, ProgramLine};

/// Why a descending move under G93 keeps its feed.
const INVERSE_TIME: &str = "its F is an inverse time (G93), and the law needs a feed per minute";

/// A block with a move: the law's demand, the feed that is sent, and the reason.
#[derive(Clone, Debug)]
pub struct PlannedBlock {
    /// Line in the program, counted from 1.
    pub line: usize,
    /// Move of the block: beside a chamfer or rounded corner, where a law looks at it, without the part that the corner takes
    /// away; along a contour under G41 or G42 that of the tool centre, if it is known.
    pub segment: Segment,
    /// Conditions of its law there.
    pub contour: Option<ContourPlace>,
    /// Whether its move is shorter than programmed, because of a chamfer or rounded corner at one of its ends.
    pub is_cut_off: bool,
    /// Part of the programmed move along which it runs, where it ends beside chamfers, rounded corners or those of a contour.
    pub cut_off: Option<Segment>,
    /// Chamfer or rounded corner behind it, which has the feed of the same block.
    pub inserted: Option<Box<PlannedBlock>>,
    /// Index of the cut rule that fits it.
    pub rule: Option<usize>,
    /// Whether the plunge law is to govern it; it has no cut rule then.
    pub is_descent: bool,
    /// Engaged arcs of the tool's circles along it, if its rule expects engagement per move.
    pub along: Option<EngagedTable>,
    /// Demand of the law along it.
    pub demand: Option<DemandRange>,
    /// The feed it is sent with, per minute; the least where it is sent in pieces.
    pub sent: Option<Nm>,
    /// Feed of the move by itself, per minute, where a chamfer or rounded corner behind it has another.
    pub own_feed: Option<Nm>,
    /// Reason for this feed.
    pub reason: PlanReason,
    /// Pieces of the move, if the law governs it without an override.
    pub pieces: Vec<SentPiece>,
    /// Reason to send it whole although the law asks for pieces.
    pub whole: Option<Whole>,
    /// Chip error that remains with its pieces.
    pub chip_error: Option<ChipError>,
    /// F words in its text as sent.
    pub f_words: usize,
    /// Reason why no law can evaluate the move by itself.
    pub under: Option<NotModelled>,
    /// The fastest feed that machine, control and, where a law governs it, the job's ceiling allow; nothing for rapids.
    pub limit: Option<MoveLimit>,
    /// Commanded spindle speed where a law governs it.
    pub spindle: Option<RevPerMin>,
    /// Teeth that pass in a minute, at that speed.
    pub teeth_per_min: Option<f64>,
    /// Largest override at its end, %.
    pub end_percent: u8,
}

/// Law of a block.
#[derive(Clone, Debug)]
pub struct BlockLaw<'j> {
    /// Cut rule of the block, with the target of the move if the target follows the program.
    pub rule: Cow<'j, CutRule>,
    /// The move for which the law is evaluated.
    pub segment: Segment,
    /// The law.
    pub law: SegmentLaw,
}

impl PlannedBlock {
    /// A move with its programmed feed, before a rule is looked up.
    pub fn new(line: usize, segment: Segment) -> Self {
        let mut block = PlannedBlock {
            line,
            segment,
            contour: None,
            is_cut_off: false,
            cut_off: None,
            inserted: None,
            rule: None,
            is_descent: false,
            along: None,
            demand: None,
            sent: None,
            own_feed: None,
            reason: PlanReason::NoRule,
            pieces: Vec::new(),
            whole: None,
            chip_error: None,
            f_words: 0,
            under: None,
            limit: None,
            spindle: None,
            teeth_per_min: None,
            end_percent: FeedOverride::PROGRAMMED.percent,
        };
        block.sent = block.programmed();
        block
    }

    /// Cut rule of the block; under G41 and G42 with the side on which the tool runs there.
    pub fn cut_rule<'j>(&self, job: &'j Job) -> Option<Cow<'j, CutRule>> {
        let rule = job.rules.get(self.rule?)?;
        let side = self.contour.and_then(|place| place.side);
        Some(side.map_or(Cow::Borrowed(rule), |side| Cow::Owned(rule.on_side(side))))
    }

    /// Law of the block at a speed of the teeth, if a cut rule matches it.
    pub fn law<'j>(&self, job: &'j Job, teeth_per_min: f64) -> Option<BlockLaw<'j>> {
        let rule = self.cut_rule(job)?;
        let segment = self.law_segment(&rule);
        let of_block = job.tool_of(&rule).follows_program.then(|| {
            let programmed = self.programmed().map_or(0.0, Nm::to_mm) * (1.0 + F32_MARGIN);
            let feed_per_tooth = Some(MmPerTooth((programmed / teeth_per_min) as f32));
            CutRule { feed_per_tooth, ..rule.clone().into_owned() }
        });
        let rule = of_block.map_or(rule, Cow::Owned);
        let law = SegmentLaw::with_engagement(&segment, Some(&rule), self.along.as_ref(), job);
        Some(BlockLaw { rule, segment, law })
    }

    /// The move for which its law is evaluated. The moves around a corner before an outside arc are lines with the same F,
    /// so the arc gets the feed of a line.
    fn law_segment(&self, rule: &CutRule) -> Segment {
        let has_corner = self.contour.is_some_and(|place| place.has_corner);
        let is_outside = matches!(rule.work, Work::Mill { side: ContourSide::Outside, .. });
        if has_corner && is_outside { Segment { path: Path::Line, ..self.segment } } else { self.segment }
    }

    /// Feed that a law has set on the move, or on the corner behind it.
    pub fn governed_feed(&self) -> Option<Nm> {
        let is_governed = self.demand.is_some() || self.reason == PlanReason::Corner;
        self.sent.filter(|_| is_governed)
    }

    /// Adds the chamfer or rounded corner that the control inserts behind the move. Both share one F: the lower of
    /// both feeds.
    pub fn insert(&mut self, mut inserted: PlannedBlock) {
        let least = [self.sent, inserted.sent].into_iter().flatten().min();
        if least < self.sent {
            self.reason = PlanReason::Corner;
        }
        self.own_feed = self.sent;
        (self.sent, inserted.sent) = (least, least);
        self.inserted = Some(Box::new(inserted));
    }

    /// Sets F so that the control, which reduces it on this arc itself, moves with the feed that the law allows. The reduction
    /// raises no F above the programmed one, nor above the feed of a line where moves around a corner have the same F.
    fn leave_to_control(&mut self, place: &ContourPlace, line_mm_per_min: f64, unit: LengthUnit) {
        let Some(wanted) = self.demand.map(|demand| demand.safe_mm_per_min.min(self.limit_mm_per_min())) else {
            return;
        };
        let programmed = self.programmed().map_or(0.0, Nm::to_mm);
        let line = if place.has_corner { line_mm_per_min } else { f64::INFINITY };
        let most = programmed.min(line).max(wanted);
        self.sent = Some(rewrite::round_down((wanted / place.feed_ratio).min(most), unit));
        if matches!(self.reason, PlanReason::Law | PlanReason::LawInPart | PlanReason::LawFloor) {
            self.reason = PlanReason::ControlReduces;
        }
    }

    /// Programmed feed, per minute.
    pub fn programmed(&self) -> Option<Nm> {
        match self.segment.feed {
            Feed::PerMinute(feed) => Some(feed),
            Feed::InverseTime(_) | Feed::Missing => None,
        }
    }

    /// Target feed per tooth of its move, for a tool whose target is the programmed feed.
    pub fn target(&self, job: &Job) -> Option<MmPerTooth> {
        let setup = self.rule.and_then(|rule| job.rules.get(rule)).map(|rule| job.tool_of(rule))?;
        setup.target_of(self.programmed()?, self.spindle?).filter(|_| setup.follows_program)
    }

    /// Fastest feed that machine and control allow; infinite if nothing limits the move.
    pub fn limit_mm_per_min(&self) -> f64 {
        self.limit.map_or(f64::INFINITY, |limit| limit.feed_mm_per_min)
    }

    /// Whether the contour law asks for a lower feed on an arc that is shorter than the braking distance of the axes. The caller then keeps
    /// the programmed feed. This is safe, because the chip is never thicker than the centre's feed per tooth.
    pub fn is_too_short_to_slow_down(&self, job: &Job, accelerations_mm_per_s2: &[f64; 3]) -> bool {
        let law = self.rule.and_then(|rule| job.rules.get(rule)).map(|rule| job.tool_of(rule).law);
        let (Some(LawKind::Contour { .. }), Some(arc), Some(sent), Some(programmed)) =
            (law, self.segment.arc(), self.sent, self.programmed())
        else {
            return false;
        };
        let (first, second, _) = arc.plane.axes();
        let acceleration_mm_per_s2 = accelerations_mm_per_s2[first].min(accelerations_mm_per_s2[second]);
        let [from, to] = [programmed, sent].map(|feed| feed.to_mm() / S_PER_MIN);
        sent < programmed && self.segment.length_mm() < (from * from - to * to) / (2.0 * acceleration_mm_per_s2)
    }

    /// Warning for a move that a rule of the job selects and that keeps its programmed feed, or has the lowest feed of its law;
    /// `None` for other moves.
    pub fn departure(&self, line: &ProgramLine) -> Option<Diagnostic> {
        if self.rule.is_none() && !self.is_descent {
            return None;
        }
        let why = match (self.reason, self.under) {
            (PlanReason::Special, Some(under)) => FeedDeparture::Under(under),
            (PlanReason::LawFloor, _) => FeedDeparture::AtFloor,
            (PlanReason::InverseTime, _) if self.is_descent => FeedDeparture::Because(INVERSE_TIME),
            (reason, _) => FeedDeparture::Because(reason.keeps_feed()?),
        };
        Some(Diagnostic::of_feed_departure(self.line, line, why))
    }

    /// Name of the kind of move in tables and JSON.
    pub fn kind(&self) -> &'static str {
        match self.segment.path {
            Path::Rapid => "rapid",
            Path::Line => "line",
            Path::Arc(_) if self.segment.rise() != Nm(0) => "helix",
            Path::Arc(_) => "arc",
        }
    }
}

/// Raise of a target that is the programmed F: the law counts in f32, and a factor of one must not round F down.
const F32_MARGIN: f64 = 3e-7;

/// Sets the feed of a descending move, with its reason, by the table of the plunge law. Returns the law's answers in
/// all cells.
pub fn govern_descent(
    block: &mut PlannedBlock,
    table: &Table,
    job: &Job,
    (spindle, unit): (RevPerMin, LengthUnit),
) -> Option<Profile> {
    let mut knots_mm = Vec::new();
    table.knots_mm(&mut |mm| knots_mm.push(f64::from(mm)));
    let profile = Profile::ask(table, &MovePlaces::of(&block.segment), &knots_mm, &AskedCells::all());
    let teeth_per_min = f64::from(spindle.0) * f64::from(job.tools.first().tool.active_teeth());
    plan_feed(block, &profile, job, (spindle, teeth_per_min, unit)).map(|_| profile)
}

/// Evaluates the law of the block's rule along its move, and sets the block's feed and reason. Returns the answers in
/// all cells if the move may be divided into pieces.
pub fn govern(block: &mut PlannedBlock, job: &Job, spindle: RevPerMin, unit: LengthUnit) -> Option<Profile> {
    let setup = job.tool_of(job.rules.get(block.rule?)?);
    let teeth_per_min = f64::from(spindle.0) * f64::from(setup.tool.active_teeth());
    let BlockLaw { rule, segment, law } = block.law(job, teeth_per_min)?;
    let mut knots_mm = Vec::new();
    law.knots_mm(&mut |mm| knots_mm.push(f64::from(mm)));
    let places = MovePlaces::of(&segment);
    let has_pieces = matches!(job.policy, FeedPolicy::RewriteOnly(_));
    let cells = if has_pieces { AskedCells::all() } else { AskedCells::deciding(&law, &places, &knots_mm) };
    let profile = Profile::ask(&law, &places, &knots_mm, &cells);
    let demand = plan_feed(block, &profile, job, (spindle, teeth_per_min, unit))?;
    if matches!(block.reason, PlanReason::Law | PlanReason::LawInPart)
        && is_at_floor(setup.law, job.feed_per_tooth_of(&rule), &demand)
    {
        block.reason = PlanReason::LawFloor;
    }
    if let Some(place) = block.contour.filter(|place| place.feed_ratio < 1.0) {
        let line_mm_per_min = f64::from(job.feed_per_tooth_of(&rule).0) * teeth_per_min;
        block.leave_to_control(&place, line_mm_per_min, unit);
    }
    has_pieces.then_some(profile)
}

/// Sets the feed of a block by the answers of its law, and the reason for that.
fn plan_feed(
    block: &mut PlannedBlock,
    profile: &Profile,
    job: &Job,
    (spindle, teeth_per_min, unit): (RevPerMin, f64, LengthUnit),
) -> Option<DemandRange> {
    let Some(demand) = DemandRange::of(profile, teeth_per_min) else {
        block.reason = PlanReason::NoDemand;
        return None;
    };
    (block.demand, block.spindle, block.teeth_per_min) = (Some(demand), Some(spindle), Some(teeth_per_min));
    block.limit = MoveLimit::under(block.limit, job.ceiling.feed_mm_per_min(block.programmed()));
    let limit_mm_per_min = block.limit_mm_per_min();
    let is_limited = demand.feed_max_mm_per_min > limit_mm_per_min * (1.0 + 2.0 * F32_MARGIN);
    if job.policy != FeedPolicy::OverrideOnly {
        block.sent = Some(rewrite::round_down(demand.safe_mm_per_min.min(limit_mm_per_min), unit));
    }
    let at_percent = |percent: u8| block.sent.map(|sent| sent.to_mm() * f64::from(percent) / f64::from(PERCENT));
    let ceiling = at_percent(job.limits.max_percent).unwrap_or(f64::INFINITY);
    let floor = at_percent(job.limits.min_percent).unwrap_or(0.0);
    block.reason = match block.limit.map(|limit| limit.by) {
        _ if demand.feed_min_mm_per_min < floor => PlanReason::Floor,
        _ if demand.feed_max_mm_per_min > ceiling && ceiling < limit_mm_per_min => PlanReason::Ceiling,
        Some(LimitedBy::ArcClamp) if is_limited => PlanReason::ArcClamp,
        Some(LimitedBy::Axis) if is_limited => PlanReason::Axis,
        Some(LimitedBy::Ceiling) if is_limited => PlanReason::FeedCeiling,
        _ if demand.covers_all => PlanReason::Law,
        _ => PlanReason::LawInPart,
    };
    Some(demand)
}

/// Whether the floor of the contour law decides. Its demand is then this share of the target, to the last bit.
fn is_at_floor(law: LawKind, target: MmPerTooth, demand: &DemandRange) -> bool {
    let LawKind::Contour { floor_ratio, .. } = law else { return false };
    floor_ratio < 1.0 && demand.ipt_mm_per_tooth[0] == f64::from(target.0 * floor_ratio)
}
