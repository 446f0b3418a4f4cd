//! From a program and a job to the feeds to send: which law governs which block, what it wants, and the F words that
//! make 100 % safe, or that do without an override.

pub mod profile;

pub mod range;

pub mod lead;

pub mod pieces;

pub mod points;

pub mod modes;

pub mod limit;

pub mod reason;

pub mod rewrite;

pub mod spelling;

pub mod split;

use arcfeed_firmware::law::SegmentLaw;
use arcfeed_shared::cut::{self, CutRule, Work};
use arcfeed_shared::engaged::EngagedTable;
use arcfeed_shared::job::{FeedPolicy, Job};
use arcfeed_shared::kinematics::machine::Machine;
use arcfeed_shared::machine::LimitedBy;
use arcfeed_shared::nc::alarm::NotModelled;
use arcfeed_shared::nc::modal::Feed;
use arcfeed_shared::reader::Reader;
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::stock::Stock;
use arcfeed_shared::units::{LengthUnit, Nm, PERCENT};

use crate::engagement::{EngagementMap, Lookup};
use crate::job::JobFile;
use crate::program::{Diagnostic, Program, ProgramLine};
use lead::Falling;
use limit::{MoveLimit, is_tip_line};
use modes::Modes;
use profile::Profile;
use range::WishRange;
pub use reason::PlanReason;
use rewrite::FeedRewriter;
use split::{ChipError, Governed, SentPiece, Whole};

/// What becomes of a program.
#[derive(Clone, Debug)]
pub struct Adapted {
    /// Every block with a move, in order.
    pub blocks: Vec<PlannedBlock>,
    /// The program to send.
    pub text: Vec<u8>,
    /// Where in it the text of each of the program's lines ends.
    pub line_ends: Vec<usize>,
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
    /// Where the tool's circles are engaged along it, where its rule leaves that to be told with each move.
    pub along: Option<EngagedTable>,
    /// What the law wants along it.
    pub wish: Option<WishRange>,
    /// The feed it is sent with, per minute; the least where it is sent in pieces.
    pub sent: Option<Nm>,
    /// Why.
    pub reason: PlanReason,
    /// Its pieces, where the law governs it and there is no override to vary its feed.
    pub pieces: Vec<SentPiece>,
    /// Why it is whole although the law wants pieces.
    pub whole: Option<Whole>,
    /// What its pieces make of the chip.
    pub chip_error: Option<ChipError>,
    /// F words in its text as sent.
    pub f_words: usize,
    /// Why no law can look at it by itself.
    pub under: Option<NotModelled>,
    /// The fastest feed that machine and control can follow on it, and what sets it; nothing for rapids.
    pub limit: Option<MoveLimit>,
}

/// What is known beside program and job.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known<'a> {
    /// The machine: laws also govern straight moves under G43.4, within what all of its axes can follow.
    pub machine: Option<&'a Machine>,
    /// Where the tool's circles are engaged, for rules that leave it to be told with each move.
    pub map: Option<&'a EngagementMap>,
}

impl<'a> Known<'a> {
    /// All that a job's files tell.
    pub fn of(file: &'a JobFile) -> Self {
        Known { machine: file.machine.as_ref().map(|named| &named.machine), map: file.map.as_ref() }
    }
}

/// Plans the feeds of a program without errors.
pub fn adapt(program: &Program, job: &Job) -> Adapted {
    adapt_with(program, job, Known::default())
}

/// The same with all that is known.
pub fn adapt_with(program: &Program, job: &Job, known: Known<'_>) -> Adapted {
    let mut writer = Writer::new(program, job, known);
    for (index, line) in program.lines.iter().enumerate() {
        writer.take(index + 1, line);
    }
    writer.adapted
}

impl Adapted {
    /// Moves that a cut rule speaks of and that keep their own feed all the same, as warnings of their program.
    pub fn left_alone(&self, program: &Program) -> Vec<Diagnostic> {
        let special = self.blocks.iter().filter(|block| block.reason == PlanReason::Special && block.rule.is_some());
        let warning = |block: &PlannedBlock| {
            Some(Diagnostic::of_feed_kept(block.line, program.lines.get(block.line - 1)?, block.under?))
        };
        special.filter_map(warning).collect()
    }
}

/// The program to send, as far as it is written.
struct Writer<'a> {
    job: &'a Job,
    machine: Option<&'a Machine>,
    engaged: Option<Lookup<'a>>,
    adapted: Adapted,
    feeds: FeedRewriter,
    modes: Modes,
    /// The control behind the lines so far; only what is cut into pieces needs it.
    reader: Option<Reader>,
    /// Between the pieces of a last line, which has no end of its own.
    line_end: &'a [u8],
}

impl<'a> Writer<'a> {
    fn new(program: &'a Program, job: &'a Job, known: Known<'a>) -> Self {
        let cuts = matches!(job.policy, FeedPolicy::RewriteOnly(_));
        let line_end = program.lines.first().map_or(&b""[..], |line| &line.ending);
        Writer {
            job,
            machine: known.machine,
            engaged: known.map.map(EngagementMap::lookup),
            adapted: Adapted { blocks: Vec::new(), text: Vec::new(), line_ends: Vec::new() },
            feeds: FeedRewriter::default(),
            modes: Modes::at_power_on(job.unit),
            reader: cuts.then(|| program.control.clone()),
            line_end: if line_end.is_empty() { b"\n" } else { line_end },
        }
    }

    fn take(&mut self, number: usize, line: &ProgramLine) {
        let before = self.reader.clone();
        if let Some(reader) = &mut self.reader {
            // The program has no errors.
            let _understood = reader.read(&line.text);
        }
        self.modes = self.modes.after(line);
        let under = self.special(line);
        let planned = line.segment().map(|segment| {
            let limit = MoveLimit::of(line, &segment, self.job, self.machine);
            let along = self.told_along(&segment);
            let block = PlannedBlock { limit, along, ..PlannedBlock::new(number, segment) };
            match under {
                None => plan_block(block, self.job, self.modes.unit),
                Some(under) => (block.special(self.job, under), None),
            }
        });
        let texts = match planned {
            None => vec![self.whole(line, None)],
            Some((mut block, profile)) => {
                let texts = match (before, &profile) {
                    // Without a feed of its own it runs into an alarm, whatever we do.
                    (Some(before), Some(profile)) if block.programmed().is_some() => {
                        self.in_pieces(line, &mut block, profile, before)
                    }
                    _ => None,
                };
                let texts = texts.unwrap_or_else(|| {
                    let governed = block.sent.filter(|_| block.wish.is_some());
                    vec![self.whole(line, governed)]
                });
                block.f_words = texts.iter().filter(|text| has_feed(text)).count();
                self.adapted.blocks.push(block);
                texts
            }
        };
        let end = if line.ending.is_empty() { self.line_end } else { &line.ending };
        self.adapted.text.extend(texts.join(end));
        self.adapted.text.extend(&line.ending);
        self.adapted.line_ends.push(self.adapted.text.len());
    }

    /// Where the circles are engaged along a move, where its rule leaves that to be told.
    fn told_along(&mut self, segment: &Segment) -> Option<EngagedTable> {
        let (_, rule) = cut::find(&self.job.rules, segment, &self.job.tool)?;
        let engaged = self.engaged.as_mut().filter(|_| rule.is_told_along())?;
        engaged.next(segment).cloned()
    }

    /// Why no law can look at a line's move by itself.
    fn special(&self, line: &ProgramLine) -> Option<NotModelled> {
        let step = &line.meaning.as_ref()?.step;
        match step.beyond_plain {
            Some(_) if self.machine.is_some() && self.modes.per_minute && is_tip_line(line) => None,
            Some(under) if !step.is_plain() => return Some(under),
            _ => None,
        }
        .or(self.modes.taps.then_some(NotModelled::MoveUnder(630)))
    }

    /// The line, with its feed or another.
    fn whole(&mut self, line: &ProgramLine, governed: Option<Nm>) -> Vec<u8> {
        let edit = self.feeds.edit(line, governed, self.modes);
        rewrite::apply(&line.text, edit.as_slice())
    }

    /// The line's pieces, with what is to be told of them; nothing where the mode has none.
    fn in_pieces(
        &mut self,
        line: &ProgramLine,
        block: &mut PlannedBlock,
        profile: &Profile,
        before: Reader,
    ) -> Option<Vec<Vec<u8>>> {
        let FeedPolicy::RewriteOnly(settings) = &self.job.policy else { return None };
        let teeth_per_min = teeth_per_min(self.job);
        let most_ratio = f64::from(self.job.limits.max_percent) / f64::from(PERCENT);
        let (segment, modes, limit_mm_per_min) = (&block.segment, self.modes, block.limit_mm_per_min());
        let governed = Governed { line, segment, profile, modes, before, teeth_per_min, most_ratio, limit_mm_per_min };
        let split = governed.split(settings, &mut self.feeds)?;
        block.chip_error = ChipError::of(&split.pieces, profile, teeth_per_min);
        block.sent = split.pieces.iter().map(|piece| piece.feed).min();
        (block.pieces, block.whole) = (split.pieces, split.whole);
        Some(split.texts)
    }
}

impl PlannedBlock {
    fn new(line: usize, segment: Segment) -> Self {
        let mut block = PlannedBlock {
            line,
            segment,
            rule: None,
            along: None,
            wish: None,
            sent: None,
            reason: PlanReason::NoRule,
            pieces: Vec::new(),
            whole: None,
            chip_error: None,
            f_words: 0,
            under: None,
            limit: None,
        };
        block.sent = block.programmed();
        block
    }

    /// A move that no law can look at by itself.
    fn special(self, job: &Job, under: NotModelled) -> Self {
        let mut block = PlannedBlock { under: Some(under), ..self };
        block.rule = cut::find(&job.rules, &block.segment, &job.tool).map(|(index, _)| index);
        block.reason = if block.segment.path == Path::Rapid { PlanReason::Rapid } else { PlanReason::Special };
        block
    }

    /// Its own feed, per minute.
    pub fn programmed(&self) -> Option<Nm> {
        match self.segment.feed {
            Feed::PerMinute(feed) => Some(feed),
            Feed::InverseTime(_) | Feed::Missing => None,
        }
    }

    fn limit_mm_per_min(&self) -> f64 {
        self.limit.map_or(f64::INFINITY, |limit| limit.feed_mm_per_min)
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

/// A block's plan, and what the law says along it.
fn plan_block(mut block: PlannedBlock, job: &Job, unit: LengthUnit) -> (PlannedBlock, Option<Profile>) {
    let mut profile = None;
    match (&block.segment.path, block.segment.feed) {
        (Path::Rapid, _) => block.reason = PlanReason::Rapid,
        (_, Feed::InverseTime(_)) => block.reason = PlanReason::InverseTime,
        (Path::Line | Path::Arc(_), _) => profile = govern(&mut block, job, unit),
    }
    (block, profile)
}

fn teeth_per_min(job: &Job) -> f64 {
    f64::from(job.spindle.0) * f64::from(job.tool.active_teeth())
}

fn govern(block: &mut PlannedBlock, job: &Job, unit: LengthUnit) -> Option<Profile> {
    let (index, rule) = cut::find(&job.rules, &block.segment, &job.tool)?;
    block.rule = Some(index);
    let law = SegmentLaw::told(&block.segment, Some(rule), block.along.as_ref(), job);
    let profile = Profile::ask(&law, &block.segment, &knots_mm(rule, block.along.as_ref(), job));
    let Some(wish) = WishRange::of(&profile, teeth_per_min(job)) else {
        block.reason = PlanReason::NoWish;
        return None;
    };
    block.wish = Some(wish);
    let limit_mm_per_min = block.limit_mm_per_min();
    if job.policy != FeedPolicy::OverrideOnly {
        block.sent = Some(rewrite::round_down(wish.safe_mm_per_min.min(limit_mm_per_min), unit));
    }
    let at_percent = |percent: u8| block.sent.map(|sent| sent.to_mm() * f64::from(percent) / f64::from(PERCENT));
    let ceiling = at_percent(job.limits.max_percent).unwrap_or(f64::INFINITY);
    let floor = at_percent(job.limits.min_percent).unwrap_or(0.0);
    let by_override = block.sent.filter(|_| !matches!(job.policy, FeedPolicy::RewriteOnly(_)));
    if let (Some(arcs), Some(sent)) = (&mut block.along, by_override) {
        *arcs = Falling::on(job, sent, limit_mm_per_min).in_time(arcs, &profile, block.segment.feed_length_mm());
    }
    block.reason = match block.limit.map(|limit| limit.by) {
        _ if wish.feed_min_mm_per_min < floor => PlanReason::Floor,
        _ if wish.feed_max_mm_per_min > ceiling && ceiling < limit_mm_per_min => PlanReason::Ceiling,
        Some(LimitedBy::ArcClamp) if wish.feed_max_mm_per_min > limit_mm_per_min => PlanReason::ArcClamp,
        Some(LimitedBy::Axis) if wish.feed_max_mm_per_min > limit_mm_per_min => PlanReason::Axis,
        _ if wish.covers_all => PlanReason::Law,
        _ => PlanReason::LawInPart,
    };
    Some(profile)
}

/// Where along a move the tables of a rule have their knots.
fn knots_mm(rule: &CutRule, along: Option<&EngagedTable>, job: &Job) -> Vec<f64> {
    let feeds = rule.table.map(|range| job.knots.table(range)).unwrap_or_default();
    let engaged = match &rule.work {
        Work::Ring(_, Stock::Engaged(table)) => table.knots(),
        Work::Ring(_, Stock::Along) => along.map_or(&[][..], EngagedTable::knots),
        Work::Ring(..) | Work::Mill { .. } => &[],
    };
    let paths = feeds.iter().map(|knot| knot.0).chain(engaged.iter().map(|knot| knot.travelled));
    paths.map(|path| f64::from(path.0)).collect()
}

/// Whether a block's code, comments apart, has an F word.
fn has_feed(text: &[u8]) -> bool {
    let mut in_comment = false;
    text.iter().any(|&byte| {
        in_comment = (in_comment || byte == b'(') && byte != b')';
        !in_comment && byte == b'F'
    })
}
