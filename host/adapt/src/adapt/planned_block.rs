//! Plan of one block with a move: the feed that a law demands along it, the feed that is sent, and the reason for that feed.

use std::borrow::Cow;

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_law::SegmentLaw;
use arcfeed_law::move_table::MoveTable;
use arcfeed_law::table::Table;
use arcfeed_model::cut::{ContourSide, CutRule, Work};
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
    /// Move for which the feed is planned. Next to a chamfer or rounded corner that a law evaluates, it lacks the part that the corner
    /// takes away; under G41 or G42 it is the move of the tool centre, if that is known.
    pub segment: Segment,
    /// Conditions under G41 or G42 that the segment does not contain; `None` without a compensated contour.
    pub contour: Option<ContourPlace>,
    /// Whether its move is shorter than programmed, because of a chamfer or rounded corner at one of its ends.
    pub is_cut_off: bool,
    /// The part of the programmed move that remains between chamfers, rounded corners or the corners of a compensated contour; `None` if
    /// no corner shortens it.
    pub cut_off: Option<Box<Segment>>,
    /// Chamfer or rounded corner after the move, planned by itself; it has the F of the same block.
    pub inserted: Option<Box<PlannedBlock>>,
    /// Index of the cut rule that selects the block; `None` if there is none.
    pub rule: Option<usize>,
    /// The plunge law is to govern the block; then no cut rule does.
    pub is_descent: bool,
    /// Table that a controller of the override needs for the move: engaged arcs, if its rule expects them with each move and the map
    /// has the move; feeds, if the plunge law governs it and the job's mode has an override.
    pub along: Option<Box<MoveTable>>,
    /// Range of the law's demand along the move; `None` if no law governs it.
    pub demand: Option<DemandRange>,
    /// Feed per minute with which the block is sent; for a move in pieces the smallest of their feeds. `None`: the programmed F stays.
    pub sent: Option<Nm>,
    /// Feed per minute that the move would have without the chamfer or rounded corner after it; `None` without such a corner.
    pub own_feed: Option<Nm>,
    /// Reason for this feed.
    pub reason: PlanReason,
    /// Pieces with feeds of their own, if the move is divided (mode `rewrite-only`); otherwise empty.
    pub pieces: Vec<SentPiece>,
    /// Reason why the move is sent as one block although its law would have it divided.
    pub whole: Option<Whole>,
    /// Error of the chip that remains with the feeds of the pieces.
    pub chip_error: Option<ChipError>,
    /// Number of F words in the block's text as sent.
    pub f_words: usize,
    /// Function of the control (G43.4, G95 and the like) because of which no law can evaluate the move by itself.
    pub under: Option<NotModelled>,
    /// Fastest feed that the machine and the control allow and, for a governed move, the job's ceiling; `None` for rapids and without a
    /// limit.
    pub limit: Option<MoveLimit>,
    /// Commanded spindle speed, for a governed move.
    pub spindle: Option<RevPerMin>,
    /// Number of teeth that pass in a minute at that speed.
    pub teeth_per_min: Option<f64>,
    /// Largest override allowed at the end of the move, %, so that the next move can begin.
    pub end_percent: u8,
}

/// Law that governs a block, with the rule and the move to which it applies.
#[derive(Clone, Debug)]
pub struct BlockLaw<'j> {
    /// Cut rule of the block; if the tool's target is the programmed feed, with the target of this move.
    pub rule: Cow<'j, CutRule>,
    /// The move for which the law is evaluated.
    pub segment: Segment,
    /// Feed law of this move.
    pub law: SegmentLaw,
}

impl PlannedBlock {
    /// Plan of a move that keeps its programmed feed; nothing has been decided about it yet.
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

    /// Cut rule of the block; under G41 and G42 with the side of the contour on which the tool runs there. `None` without a rule.
    pub fn cut_rule<'j>(&self, job: &'j Job) -> Option<Cow<'j, CutRule>> {
        let rule = job.rules.get(self.rule?)?;
        let side = self.contour.and_then(|place| place.side);
        Some(side.map_or(Cow::Borrowed(rule), |side| Cow::Owned(rule.on_side(side))))
    }

    /// Law of the block if `teeth_per_min` teeth pass in a minute; `None` if no cut rule selects the block.
    pub fn law<'j>(&self, job: &'j Job, teeth_per_min: f64) -> Option<BlockLaw<'j>> {
        let rule = self.cut_rule(job)?;
        let segment = self.law_segment(&rule);
        let of_block = job.tool_of(&rule).follows_program.then(|| {
            let programmed = self.programmed().map_or(0.0, Nm::to_mm) * (1.0 + F32_MARGIN);
            let feed_per_tooth = Some(MmPerTooth((programmed / teeth_per_min) as f32));
            CutRule { feed_per_tooth, ..rule.clone().into_owned() }
        });
        let rule = of_block.map_or(rule, Cow::Owned);
        let law = SegmentLaw::with_table(&segment, Some(&rule), self.along.as_deref(), job);
        Some(BlockLaw { rule, segment, law })
    }

    /// The move for which its law is evaluated. The moves around a corner before an outside arc are lines with the same F,
    /// so the arc gets the feed of a line.
    fn law_segment(&self, rule: &CutRule) -> Segment {
        let has_corner = self.contour.is_some_and(|place| place.has_corner);
        let is_outside = matches!(rule.work, Work::Mill { side: ContourSide::Outside, .. });
        if has_corner && is_outside { Segment { path: Path::Line, ..self.segment } } else { self.segment }
    }

    /// Feed per minute that a law has set on the move or on the corner after it; `None` if the programmed feed stays.
    pub fn governed_feed(&self) -> Option<Nm> {
        let is_governed = self.demand.is_some() || self.reason == PlanReason::Corner;
        self.sent.filter(|_| is_governed)
    }

    /// Adds the chamfer or rounded corner that the control inserts after the move. Move and corner have one F, therefore both get the
    /// lower of their feeds.
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

    /// Programmed feed per minute; `None` under G93 (inverse time) or before the first F.
    pub fn programmed(&self) -> Option<Nm> {
        match self.segment.feed {
            Feed::PerMinute(feed) => Some(feed),
            Feed::InverseTime(_) | Feed::Missing => None,
        }
    }

    /// Target feed per tooth of the move, for a tool whose target is the programmed feed; `None` for other tools, or without feed or
    /// speed.
    pub fn target(&self, job: &Job) -> Option<MmPerTooth> {
        let setup = self.rule.and_then(|rule| job.rules.get(rule)).map(|rule| job.tool_of(rule))?;
        setup.target_of(self.programmed()?, self.spindle?).filter(|_| setup.follows_program)
    }

    /// Fastest feed that machine, control and job allow, mm/min; infinite if nothing limits the move.
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

/// Sets feed and reason of a descending move by `table`, the plunge law's permitted path per tooth. Returns the law's demand in all cells;
/// `None` if the law has no demand.
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

/// Evaluates the law of the block's rule along its move and sets the block's feed and reason. Returns the demand in all cells if the mode
/// may divide the move into pieces; otherwise, and without a demand, `None`.
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
