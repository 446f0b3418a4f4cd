//! From a program and a job to the feeds to send: which law governs which block, what it wants, and the F words that
//! make 100 % safe.

pub mod range;

pub mod rewrite;

use arcfeed_firmware::law::SegmentLaw;
use arcfeed_shared::cut;
use arcfeed_shared::job::{FeedPolicy, Job};
use arcfeed_shared::machine::LimitedBy;
use arcfeed_shared::nc::modal::Feed;
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{LengthUnit, Nm, PERCENT};

use crate::program::{Program, ProgramLine};
use range::WishRange;
use rewrite::FeedRewriter;

/// What becomes of a program.
#[derive(Clone, Debug)]
pub struct Adapted {
    /// Every block with a move, in order.
    pub blocks: Vec<PlannedBlock>,
    /// The program to send.
    pub text: Vec<u8>,
}

/// One block with a move.
#[derive(Clone, Debug)]
pub struct PlannedBlock {
    /// Line in the program, counted from 1.
    pub line: usize,
    /// Its move.
    pub segment: Segment,
    /// Index of the cut rule that speaks of it.
    pub rule: Option<usize>,
    /// What the law wants along it.
    pub wish: Option<WishRange>,
    /// The feed it is sent with, per minute.
    pub sent: Option<Nm>,
    /// Why.
    pub reason: PlanReason,
}

/// Why a block is sent with the feed it is sent with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanReason {
    /// The law governs it.
    Law,
    /// The law governs it; on part of it it has no wish, there the block runs at 100 %.
    LawInPart,
    /// The law governs it, but the override ends below what it wants.
    Ceiling,
    /// The law governs it, but the override ends above what it wants: the chip exceeds its target.
    Floor,
    /// The law governs it, but an axis cannot follow it everywhere.
    Axis,
    /// The law governs it, but the control clamps the feed on an arc of this radius.
    ArcClamp,
    /// A cut rule speaks of it, but the law has no wish anywhere on it.
    NoWish,
    /// No cut rule speaks of it.
    NoRule,
    /// Positioning.
    Rapid,
    /// Inverse time: F is no feed.
    InverseTime,
}

impl PlanReason {
    /// As written in tables and JSON.
    pub const fn label(self) -> &'static str {
        match self {
            PlanReason::Law => "law",
            PlanReason::LawInPart => "law-in-part",
            PlanReason::Ceiling => "ceiling",
            PlanReason::Floor => "floor",
            PlanReason::Axis => "axis",
            PlanReason::ArcClamp => "arc-clamp",
            PlanReason::NoWish => "no-wish",
            PlanReason::NoRule => "no-rule",
            PlanReason::Rapid => "rapid",
            PlanReason::InverseTime => "inverse-time",
        }
    }
}

/// Plans the feeds of a program without errors.
pub fn adapt(program: &Program, job: &Job) -> Adapted {
    let mut rewriter = FeedRewriter::default();
    let mut adapted = Adapted { blocks: Vec::new(), text: Vec::new() };
    let mut unit = job.unit;
    for (index, line) in program.lines.iter().enumerate() {
        unit = unit_after(line, unit);
        let planned = line.meaning.as_ref().and_then(|meaning| meaning.segment).map(|segment| {
            let planned = plan_block(index + 1, segment, job, unit);
            adapted.blocks.push(planned.clone());
            planned
        });
        let governed = planned.as_ref().and_then(|block| block.sent.filter(|_| block.wish.is_some()));
        adapted.text.extend(rewriter.rewrite(line, planned.map(|block| block.segment), governed, unit));
        adapted.text.extend(&line.ending);
    }
    adapted
}

impl PlannedBlock {
    /// Its own feed, per minute.
    pub fn programmed(&self) -> Option<Nm> {
        match self.segment.feed {
            Feed::PerMinute(feed) => Some(feed),
            Feed::InverseTime(_) | Feed::Missing => None,
        }
    }

    /// As written in tables and JSON.
    pub fn kind(&self) -> &'static str {
        match self.segment.path {
            Path::Rapid => "rapid",
            Path::Line => "line",
            Path::Arc(_) if self.segment.rise() != Nm(0) => "helix",
            Path::Arc(_) => "arc",
        }
    }
}

fn plan_block(line: usize, segment: Segment, job: &Job, unit: LengthUnit) -> PlannedBlock {
    let mut block = PlannedBlock { line, segment, rule: None, wish: None, sent: None, reason: PlanReason::NoRule };
    block.sent = block.programmed();
    match (&segment.path, segment.feed) {
        (Path::Rapid, _) => block.reason = PlanReason::Rapid,
        (_, Feed::InverseTime(_)) => block.reason = PlanReason::InverseTime,
        (Path::Line | Path::Arc(_), _) => govern(&mut block, job, unit),
    }
    block
}

fn govern(block: &mut PlannedBlock, job: &Job, unit: LengthUnit) {
    let Some((index, rule)) = cut::find(&job.rules, &block.segment, &job.tool) else { return };
    block.rule = Some(index);
    let law = SegmentLaw::for_segment(&block.segment, Some(rule), job);
    let teeth_per_min = f64::from(job.spindle.0) * f64::from(job.tool.active_teeth());
    let Some(wish) = range::along(&law, &block.segment, teeth_per_min) else {
        block.reason = PlanReason::NoWish;
        return;
    };
    block.wish = Some(wish);
    let limit = job.machine.feed_limit(&block.segment);
    let limit_mm_per_min = limit.map_or(f64::INFINITY, |limit| f64::from(limit.feed.0));
    if job.policy == FeedPolicy::SafeBase {
        block.sent = Some(rewrite::round_down(wish.safe_mm_per_min.min(limit_mm_per_min), unit));
    }
    let factor = |feed_mm_per_min: f64| block.sent.map(|sent| feed_mm_per_min / sent.to_mm() * f64::from(PERCENT));
    block.reason = match (factor(wish.feed_min_mm_per_min), factor(wish.feed_max_mm_per_min)) {
        (Some(least), _) if least < f64::from(job.limits.min_percent) => PlanReason::Floor,
        (_, Some(most)) if most > f64::from(job.limits.max_percent) => PlanReason::Ceiling,
        _ if wish.feed_max_mm_per_min > limit_mm_per_min => match limit.map(|limit| limit.by) {
            Some(LimitedBy::ArcClamp) => PlanReason::ArcClamp,
            _ => PlanReason::Axis,
        },
        _ if wish.covers_all => PlanReason::Law,
        _ => PlanReason::LawInPart,
    };
}

/// The unit in force after a line: what F words are written in.
fn unit_after(line: &ProgramLine, unit: LengthUnit) -> LengthUnit {
    use arcfeed_shared::nc::block::Line;
    let Some(Line::Block(block)) = line.meaning.as_ref().map(|meaning| &meaning.parsed.line) else { return unit };
    block.words.iter().filter(|word| word.letter == b'G').fold(unit, |unit, word| match word.number.as_whole() {
        Some(20) => LengthUnit::Inch,
        Some(21) => LengthUnit::Mm,
        _ => unit,
    })
}
