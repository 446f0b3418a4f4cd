//! Planning and writing of one line at a time: the demand of a law on its move, and the text that is sent for it.

use arcfeed_kinematics::machine::Machine;
use arcfeed_law::move_table::MoveTable;
use arcfeed_model::job::{FeedPolicy, Job};
use arcfeed_nc::alarm::NotModelled;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::modal::{Feed, Pose};
use arcfeed_nc::reader::Reader;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{Nm, PERCENT};

use super::corner_line::{CornerLine, TwoBlocks, governs_corners};
use super::descents::{Descending, Descents};
use super::held_feeds;
use super::known::{KeptLines, Known};
use super::limit::{MoveLimit, is_tip_line};
use super::modes::Modes;
use super::offset_moves::{CenterPath, InsertedMove, OffsetMove, OffsetMoves};
use super::planned_block::{PlannedBlock, govern};
use super::profile::Profile;
use super::reason::PlanReason;
use super::rewrite::{self, FeedRewriter, Leak};
use super::rule_match::match_move;
use super::split::{ChipError, Governed, SentPiece};
use crate::engagement::{EngagementMap, Lookup};
use crate::job::rule_scope::{self, RuleScope};
use crate::program::{CornerMove, ExecutedPlaces, ProgramLine};

/// Acceleration of a fast machining centre, for jobs without the drives of their machine.
const FAST_MACHINE_MM_PER_S2: f64 = 5_000.0;

/// A line as it is sent, with the plan of its move.
#[derive(Clone, Debug)]
pub struct PlannedLine {
    /// Plan of the line's move; `None` if the line has no move.
    pub block: Option<PlannedBlock>,
    /// Text of the line, without line end; several lines for a move in pieces.
    pub text: Vec<u8>,
}

/// The state behind the lines that are planned.
pub(super) struct Writer<'a> {
    job: &'a Job,
    machine: Option<&'a Machine>,
    scopes: &'a [RuleScope],
    places: Option<&'a ExecutedPlaces>,
    accelerations_mm_per_s2: [f64; 3],
    engaged: Option<Lookup<'a>>,
    descents: Option<Descents<'a>>,
    has_sent_feeds: bool,
    /// Lines so far.
    count: usize,
    feeds: FeedRewriter,
    modes: Modes,
    /// The control behind the lines so far; only what is cut into pieces needs it.
    reader: Option<Reader>,
    /// The moves of the tool centre, in a program with contours that is to be rewritten.
    contours: Option<OffsetMoves<'a>>,
    /// The last move does not depend on a block-delete switch.
    is_start_certain: bool,
    kept: &'a KeptLines,
    /// The last line that a law governs.
    pub last_governed: Option<usize>,
    /// Between the pieces of a last line, which has no end of its own.
    line_end: &'a [u8],
}

impl<'a> Writer<'a> {
    /// Planner before the first line of a program, whose lines end with `line_end`. Lines in `kept` keep their
    /// programmed feed.
    pub fn new(control: &Reader, line_end: &'a [u8], job: &'a Job, known: Known<'a>, kept: &'a KeptLines) -> Self {
        let cuts = matches!(job.policy, FeedPolicy::RewriteOnly(_));
        Writer {
            job,
            machine: known.machine,
            scopes: known.scopes,
            places: known.places,
            accelerations_mm_per_s2: known.accelerations_mm_per_s2.unwrap_or([FAST_MACHINE_MM_PER_S2; 3]),
            engaged: known.map.map(EngagementMap::lookup),
            descents: Descents::of(known.plunge, known.map),
            has_sent_feeds: known.has_sent_feeds,
            count: 0,
            feeds: FeedRewriter::default(),
            modes: Modes::at_power_on(job.unit),
            reader: cuts.then(|| control.clone()),
            contours: None,
            is_start_certain: true,
            kept,
            last_governed: None,
            line_end: if line_end.is_empty() { b"\n" } else { line_end },
        }
    }

    /// Enables laws for moves under G41 and G42, if the job's mode permits it; `lines` are all lines of the program,
    /// which are read ahead.
    pub fn read_contours(&mut self, control: &Reader, lines: impl Iterator<Item = &'a [u8]> + 'a) {
        self.contours = self.reader.is_some().then(|| OffsetMoves::new(control.clone(), lines));
    }

    /// Plans the next line. Fails if the feed of an earlier line would stay in force for it.
    pub fn take(&mut self, line: &ProgramLine) -> Result<PlannedLine, Leak> {
        self.count += 1;
        let path = self.contours.as_mut().map_or(CenterPath::None, OffsetMoves::take);
        self.modes = self.modes.after(line);
        let planned = self.plan_line(self.count, line, &path);
        if let Some(reader) = &mut self.reader {
            // The program has no errors.
            let _understood = reader.read(&line.text);
        }
        planned
    }

    fn plan_line(&mut self, number: usize, line: &ProgramLine, path: &CenterPath) -> Result<PlannedLine, Leak> {
        let is_certain = line.skipping.is_none_or(|skipping| skipping.is_harmless);
        let Some(segment) = line.segment() else {
            self.is_start_certain &= is_certain;
            return Ok(PlannedLine { block: None, text: self.whole(line, None)? });
        };
        let (mut block, profile) = self.plan(number, line, segment, path);
        self.is_start_certain = is_certain;
        let texts = match &profile {
            _ if block.is_cut_off => self.beside_corner(line, &mut block, profile.as_ref()),
            _ if block.contour.is_some() => self.beside_corner(line, &mut block, profile.as_ref()),
            Some(profile) => self.in_pieces(line, &mut block, profile),
            None => None,
        };
        let governed = block.governed_feed();
        if governed.is_some() {
            self.last_governed = Some(number);
        }
        let texts = match texts {
            Some(texts) => texts,
            None => vec![self.whole(line, governed)?],
        };
        block.f_words = texts.iter().filter(|text| rewrite::has_feed(text)).count();
        let end = if line.ending.is_empty() { self.line_end } else { &line.ending };
        Ok(PlannedLine { block: Some(block), text: texts.join(end) })
    }

    /// Plan of a line's move with the corner behind it, and the answers of the law along the move.
    fn plan(
        &mut self,
        number: usize,
        line: &ProgramLine,
        segment: Segment,
        path: &CenterPath,
    ) -> (PlannedBlock, Option<Profile>) {
        let under = self.special(line);
        let (offset, corner) = (self.offset_move(path, line, under), self.corner_move(path, line, under));
        let under = under.filter(|_| offset.is_none() && corner.is_none());
        let executed = offset.map(|offset| offset.segment).or(corner.map(|corner| corner.segment));
        let in_program = |segment: Segment| segment.shifted(Pose::ORIGIN.minus(line.origin));
        let mut new = PlannedBlock::new(number, executed.map_or(segment, in_program));
        (new.contour, new.is_cut_off, new.under) = (offset.map(|offset| offset.place), corner.is_some(), under);
        new.along = self.engagement_along(if corner.is_some() { &segment } else { &new.segment }, line.machining.tool);
        let (mut block, profile) = self.plan_move(line, new, path);
        if let Some(inserted) = corner.and_then(|corner| corner.inserted) {
            let new = PlannedBlock { is_cut_off: true, ..PlannedBlock::new(number, in_program(inserted)) };
            block.insert(self.plan_move(line, new, path).0);
        }
        if let Some(InsertedMove { segment, place }) = offset.and_then(|offset| offset.inserted) {
            let new = PlannedBlock { contour: Some(place), ..PlannedBlock::new(number, in_program(segment)) };
            block.insert(self.plan_move(line, new, path).0);
        }
        let cut_off = offset.map(|offset| in_program(offset.beside_contour()));
        block.cut_off = cut_off.or(block.is_cut_off.then_some(block.segment)).map(Box::new);
        (block, profile)
    }

    /// Plan of one move of a line, which is `new` so far.
    fn plan_move(
        &mut self,
        line: &ProgramLine,
        new: PlannedBlock,
        path: &CenterPath,
    ) -> (PlannedBlock, Option<Profile>) {
        let (number, segment, under) = (new.line, new.segment, new.under);
        let mut block = PlannedBlock { under: None, ..new.clone() };
        block.limit = MoveLimit::of(line, &segment, self.job, self.machine);
        let place = self.places.map_or(Some(number), |places| places.own_line(number));
        let admits = |rule: usize| rule_scope::admits(self.scopes, rule, place, &segment);
        let matched = match_move(self.job, self.machine, line, &segment, admits);
        let descent = self.descents.as_mut().and_then(|descents| descents.next(&segment, &matched));
        if let Some(descent) = descent.filter(|_| under.is_none() && !block.is_cut_off && !line.follows_tip) {
            return self.plan_descent(line, block, descent);
        }
        let reason = match matched {
            _ if segment.path == Path::Rapid => PlanReason::Rapid,
            _ if matches!(segment.feed, Feed::InverseTime(_)) => PlanReason::InverseTime,
            // Under G43.4 rotary axes turn as a matter of course.
            Err(PlanReason::Rotary) if under.is_some() => PlanReason::Special,
            // The radius of D is missing whatever the tool is.
            Err(PlanReason::OtherTool) if is_along_contour(under) && *path == CenterPath::NoRadius => {
                PlanReason::NoRadius
            }
            Err(reason) => reason,
            Ok(_) if needs_rewriting(under) && self.reader.is_none() => PlanReason::NeedsRewriting,
            Ok(_) if is_along_contour(under) && *path == CenterPath::NoRadius => PlanReason::NoRadius,
            Ok(_) if under.is_some() => PlanReason::Special,
            Ok((index, _)) if let Some(reason) = block.contour.and_then(|place| place.fault(self.job, index)) => reason,
            Ok((index, _)) if block.is_cut_off && !governs_corners(self.job, index) => PlanReason::Special,
            Ok(_) if line.skipping.is_some() => PlanReason::BlockDelete,
            Ok(_) if self.kept.contains(number) => PlanReason::FeedLeak,
            Ok(_) if line.meaning.as_ref().is_some_and(|meaning| meaning.starts_unknown) => PlanReason::StartUnknown,
            Ok((index, spindle)) => {
                block.rule = Some(index);
                let profile = govern(&mut block, self.job, spindle, self.modes.unit);
                if block.is_too_short_to_slow_down(self.job, &self.accelerations_mm_per_s2) {
                    let (rule, reason) = (block.rule, PlanReason::Short);
                    return (PlannedBlock { rule, reason, ..new }, None);
                }
                return (block, profile);
            }
        };
        block.reason = reason;
        if reason != PlanReason::Rapid {
            block.rule = self.job.rule_among(&segment, line.machining.tool, admits).map(|(index, _)| index);
            block.under = under;
        }
        (block, None)
    }

    /// Plan of a descending move that no cut rule governs.
    fn plan_descent(
        &self,
        line: &ProgramLine,
        mut block: PlannedBlock,
        descent: Descending<'_>,
    ) -> (PlannedBlock, Option<Profile>) {
        let setup = self.job.tools.first();
        block.is_descent = true;
        block.reason = match setup.speed(line.machining.spindle) {
            _ if matches!(block.segment.feed, Feed::InverseTime(_)) => PlanReason::InverseTime,
            _ if self.job.tool_in(line.machining.tool).is_none() => PlanReason::OtherTool,
            _ if line.skipping.is_some() => PlanReason::BlockDelete,
            _ if self.kept.contains(block.line) => PlanReason::FeedLeak,
            _ if line.meaning.as_ref().is_some_and(|meaning| meaning.starts_unknown) => PlanReason::StartUnknown,
            None => PlanReason::Spindle,
            Some(_) if descent.mapped.is_none() => PlanReason::Unmapped,
            Some(spindle) => {
                let (law, conditions) = (descent.table(setup, spindle), (spindle, self.modes.unit));
                let known = (self.job, self.has_sent_feeds);
                match law.and_then(|law| held_feeds::govern(&block, &law, known, conditions)) {
                    Some((governed, profile)) => return (governed, Some(profile)),
                    None => PlanReason::Overload,
                }
            }
        };
        (block, None)
    }

    /// Engaged arcs along a move, if its rule expects engagement per move.
    fn engagement_along(&mut self, segment: &Segment, tool: ToolInSpindle) -> Option<Box<MoveTable>> {
        let (_, rule) = self.job.rule_for(segment, tool)?;
        let engaged = self.engaged.as_mut().filter(|_| rule.expects_engagement_per_move())?;
        engaged.next(segment).cloned().map(MoveTable::Engaged).map(Box::new)
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

    /// Path of the tool centre for a move along a contour, where a law may look at it.
    fn offset_move(&self, path: &CenterPath, line: &ProgramLine, under: Option<NotModelled>) -> Option<OffsetMove> {
        let CenterPath::Known(offset) = path else { return None };
        let is_plain = self.modes.per_minute && !self.modes.taps && !line.follows_tip;
        (is_along_contour(under) && is_plain && self.is_start_certain).then_some(**offset)
    }

    /// Move beside a chamfer or rounded corner, where a law may look at it.
    fn corner_move(&self, path: &CenterPath, line: &ProgramLine, under: Option<NotModelled>) -> Option<CornerMove> {
        let CenterPath::Corner(corner) = path else { return None };
        let is_plain = self.modes.per_minute && !self.modes.taps && !line.follows_tip;
        (under == Some(NotModelled::Corner) && is_plain && self.is_start_certain).then_some(**corner)
    }

    /// One F for a move along a contour.
    fn in_one_piece(&self, block: &mut PlannedBlock, profile: &Profile) {
        let (Some(feed), Some(teeth_per_min)) = (block.sent, block.teeth_per_min) else { return };
        let feed_ratio = block.contour.map_or(1.0, |place| place.feed_ratio);
        let feed = Nm::from_mm(feed.to_mm() * feed_ratio);
        block.pieces = vec![SentPiece { until_ratio: 1.0, feed }];
        block.chip_error = ChipError::of(&block.pieces, profile, teeth_per_min);
    }

    /// Texts of a line that ends in a slower corner, in two blocks; `None` where one F does for the block, or must do.
    fn beside_corner(
        &mut self,
        line: &ProgramLine,
        block: &mut PlannedBlock,
        profile: Option<&Profile>,
    ) -> Option<Vec<Vec<u8>>> {
        profile.into_iter().for_each(|profile| self.in_one_piece(block, profile));
        let is_slower = block.segment.path == Path::Line && block.reason == PlanReason::Corner;
        let (FeedPolicy::RewriteOnly(settings), Some(before), true) = (&self.job.policy, &self.reader, is_slower)
        else {
            return None;
        };
        let programmed = line.segment().filter(|segment| segment.path == Path::Line)?;
        let governed = block.own_feed.filter(|_| block.demand.is_some());
        let (own, corner, cut_off) = (governed.or(block.programmed())?, block.sent?, *block.cut_off.as_deref()?);
        let least_mm = settings.least_length.to_mm();
        let whole = CornerLine { line, cut_off, programmed, modes: self.modes, before, least_mm };
        let written = whole.write((governed, corner), &mut self.feeds);
        block.whole = written.as_ref().err().copied();
        let TwoBlocks { texts, until_ratio } = written.ok()?;
        block.pieces =
            [(until_ratio, own), (1.0, corner)].map(|(until_ratio, feed)| SentPiece { until_ratio, feed }).into();
        if let Some((profile, teeth_per_min)) = profile.zip(block.teeth_per_min) {
            block.chip_error = ChipError::of(&block.pieces, profile, teeth_per_min);
        }
        Some(texts)
    }

    /// The line, with its feed or another.
    fn whole(&mut self, line: &ProgramLine, governed: Option<Nm>) -> Result<Vec<u8>, Leak> {
        let edit = self.feeds.edit(line, governed, self.modes)?;
        Ok(rewrite::apply(&line.text, edit.as_slice()))
    }

    /// Texts of the pieces of a line's move; `None` in modes without pieces, or if the law has no finite demand.
    fn in_pieces(&mut self, line: &ProgramLine, block: &mut PlannedBlock, profile: &Profile) -> Option<Vec<Vec<u8>>> {
        let (FeedPolicy::RewriteOnly(settings), Some(before)) = (&self.job.policy, &self.reader) else { return None };
        let teeth_per_min = block.teeth_per_min?;
        let most_ratio = f64::from(self.job.limits.max_percent) / f64::from(PERCENT);
        let (segment, modes, limit_mm_per_min) = (&block.segment, self.modes, block.limit_mm_per_min());
        let is_descent = block.is_descent;
        let governed =
            Governed { line, segment, is_descent, profile, modes, before, teeth_per_min, most_ratio, limit_mm_per_min };
        let split = governed.split(settings, &mut self.feeds)?;
        block.chip_error = ChipError::of(&split.pieces, profile, teeth_per_min);
        block.sent = split.pieces.iter().map(|piece| piece.feed).min();
        (block.pieces, block.whole) = (split.pieces, split.whole);
        Some(split.texts)
    }
}

/// Whether a move is under G41 or G42.
fn is_along_contour(under: Option<NotModelled>) -> bool {
    matches!(under, Some(NotModelled::MoveUnder(410 | 420)))
}

/// Whether a law governs a move through F words only.
fn needs_rewriting(under: Option<NotModelled>) -> bool {
    is_along_contour(under) || under == Some(NotModelled::Corner)
}
