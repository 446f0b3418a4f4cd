//! Messages of a program for a board: its moves in order, each with the line of the transmission that it belongs to.
//!
//! The moves are those of the text as it goes over the DNC line, feeds and a restart's own blocks included. Moves of
//! canned cycles and reference returns are sent one by one, without a rule: the board follows them by their ends. The
//! table along a move (engaged arcs or feeds) is sent before it: the board has a move once it has all of that.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_law::move_table::MoveTable;
use arcfeed_link::message::fixed::Q40;
use arcfeed_link::message::moves::{MoveError, encode, encode_arcs, encode_feed};
use arcfeed_link::message::{Message, table};
use arcfeed_model::job::Job;
use arcfeed_nc::modal::{Feed, Pose};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::series::SeriesAction;
use arcfeed_nc_macro::stack::SourceLine;
use arcfeed_units::{Nm, RevPerMin};

use crate::adapt::{Adapted, Known, PlannedBlock, adapt_with};
use crate::dnc::restored_state::PowerOn;
use crate::dnc::transmission::Transmission;
use crate::program::{ExecutedPlaces, Program, ProgramLine};

/// Messages that give a feed board the moves of a transmission, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BoardPlan {
    /// Messages: each move behind its table.
    messages: Vec<Message>,
    /// Number of messages up to and including each move.
    ends: Vec<usize>,
    /// Index of the line of each move.
    lines: Vec<usize>,
}

/// Limits of a move that its NC text does not show: the job's largest feed, and the largest override at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveBounds {
    /// Largest feed of a governed move that the job allows, per minute.
    max_feed: Option<Nm>,
    /// Largest override at the end of the move, %; `None`: 100 %.
    end_percent: Option<u8>,
}

impl MoveBounds {
    const NONE: MoveBounds = MoveBounds { max_feed: None, end_percent: None };

    /// Limits of the moves of an adapted program, by line number; moves without limits are left out.
    pub fn of(adapted: &Adapted) -> HashMap<usize, MoveBounds> {
        let bounds = adapted.blocks.iter().map(|block| (block.line, MoveBounds::of_block(block)));
        bounds.filter(|(_, bounds)| *bounds != MoveBounds::NONE).collect()
    }

    fn of_block(block: &PlannedBlock) -> MoveBounds {
        let limit = block.limit.filter(|_| block.demand.is_some());
        MoveBounds {
            max_feed: limit.map(|limit| Nm::from_mm(limit.feed_mm_per_min)),
            end_percent: Some(block.end_percent).filter(|percent| *percent != FeedOverride::PROGRAMMED.percent),
        }
    }
}

/// Messages that give a board one planned move with the feed that is sent: its table, then the move.
///
/// # Errors
/// A number is out of the range of its message.
pub fn planned_move(block: &PlannedBlock, job: &Job) -> Result<Vec<Message>, MoveError> {
    let feed = block.sent.map_or(block.segment.feed, Feed::PerMinute);
    encode_move(&Segment { feed, ..block.segment }, 0, MoveLaw::of(block, job), MoveBounds::of_block(block))
}

fn encode_move(
    segment: &Segment,
    number: u32,
    governed: Option<MoveLaw<'_>>,
    bounds: MoveBounds,
) -> Result<Vec<Message>, MoveError> {
    let mut messages = Vec::new();
    match governed.and_then(|governed| governed.along) {
        Some(MoveTable::Engaged(arcs)) => {
            arcs.knots().iter().try_for_each(|knot| encode_arcs(knot).map(|knot| messages.push(knot.into())))?;
        }
        Some(MoveTable::Feeds(feeds)) => {
            feeds.knots().iter().try_for_each(|knot| encode_feed(knot).map(|knot| messages.push(knot.into())))?;
        }
        None => {}
    }
    let rule = governed.and_then(|governed| u8::try_from(governed.rule?).ok());
    let speed = governed.and_then(|governed| governed.spindle);
    let message = table::Segment {
        spindle: speed.map(|speed| Q40::of(speed.0).ok_or(MoveError::Range)).transpose()?,
        max_feed: bounds.max_feed.filter(|_| governed.is_some()).map(|Nm(feed)| feed),
        end_percent: bounds.end_percent,
        ..encode(segment, number, rule)?
    };
    messages.push(message.into());
    Ok(messages)
}

/// Places, in the program's file, of the lines of a transmission.
fn places(sending: &Transmission, of_program: Option<&ExecutedPlaces>) -> ExecutedPlaces {
    let mut places = ExecutedPlaces::default();
    for line in sending.lines() {
        let in_file = SourceLine { library: None, line: line.source as u32 };
        let found = of_program.map_or((line.source > 0).then_some(in_file), |known| known.place(line.source));
        match found {
            Some(place) => places.add(place, &[], &[]),
            None => places.add_own(),
        }
    }
    places
}

/// Law that governs a move: that of a rule, or a table of feeds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MoveLaw<'a> {
    rule: Option<usize>,
    /// Spindle speed, if it differs from the tool's.
    spindle: Option<RevPerMin>,
    along: Option<&'a MoveTable>,
}

impl<'a> MoveLaw<'a> {
    /// Law that governs a planned move; `None` if none does, or only through F.
    fn of(block: &'a PlannedBlock, job: &Job) -> Option<Self> {
        let along = block.along.as_deref();
        let has_law = block.rule.is_some() || along.and_then(MoveTable::feeds).is_some();
        let cut_rule = block.rule.and_then(|rule| job.rules.get(rule));
        let of_tool = cut_rule.map_or(job.tools.first(), |rule| job.tool_of(rule)).spindle;
        let spindle = block.spindle.filter(|spindle| *spindle != of_tool);
        (has_law && block.demand.is_some()).then_some(MoveLaw { rule: block.rule, spindle, along })
    }
}

/// Error: a move cannot be sent to a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanError {
    /// Line of the program's file, counted from 1; 0 for a line that arcfeed added.
    pub source: usize,
    /// Reason why the move cannot be sent.
    pub why: MoveFault,
}

/// Reason why a move cannot be sent to a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MoveFault {
    /// A number is out of the range of its message.
    #[error("this move cannot be sent to a board: {0:?}")]
    Move(MoveError),
    /// The meaning of the block is unknown. Without its move, the board would apply every later law to the wrong move.
    #[error("this block is not understood, and a board needs every move; send without --board")]
    NotUnderstood,
}

impl BoardPlan {
    /// Plans the messages for the moves of a transmission to a control in its power-on state. `known` has the
    /// engagement map, the plunge law, the scopes of the rules, and the places of the program's blocks in its file. `bounds` are the
    /// limits that the text does not show, by line of the program's file.
    ///
    /// # Errors
    /// The first move that cannot be sent to a board, with the reason.
    pub fn new(
        sending: &Transmission,
        power_on: &PowerOn,
        job: &Job,
        known: Known<'_>,
        bounds: &HashMap<usize, MoveBounds>,
    ) -> Result<Self, PlanError> {
        // A control that reports its position does not move; the reader here does not know such blocks.
        let lines = (0..sending.lines().len()).map(|index| match sending.is_of_report(index) {
            true => b"\n",
            false => sending.line_text(index).unwrap_or_default(),
        });
        let text = lines.collect::<Vec<_>>().concat();
        let mut program = Program::parse_with(Path::new(""), &text, power_on.settings, power_on.tables);
        program.places = Some(Arc::new(places(sending, known.places)));
        let Known { map, plunge, scopes, .. } = known;
        let known = Known { map, plunge, scopes, has_sent_feeds: true, ..Known::default() };
        let adapted = adapt_with(&program, job, known);
        let mut blocks = adapted.blocks.iter().peekable();
        let mut plan = BoardPlan::default();
        for (index, line) in program.lines().enumerate() {
            let source = sending.lines().get(index).map_or(0, |line| line.source);
            if line.meaning.is_none() {
                return Err(PlanError { source, why: MoveFault::NotUnderstood });
            }
            let fault = |why| PlanError { source, why: MoveFault::Move(why) };
            if let Some(block) = blocks.next_if(|block| block.line == index + 1) {
                let governed = MoveLaw::of(block, job);
                let bounds = bounds.get(&source).copied().unwrap_or(MoveBounds::NONE);
                plan.add(index, &block.segment, governed, bounds).map_err(fault)?;
            }
            for segment in series(&line) {
                plan.add(index, &segment, None, MoveBounds::NONE).map_err(fault)?;
            }
        }
        Ok(plan)
    }

    fn add(
        &mut self,
        line: usize,
        segment: &Segment,
        governed: Option<MoveLaw<'_>>,
        bounds: MoveBounds,
    ) -> Result<(), MoveError> {
        self.messages.extend(encode_move(segment, self.moves() as u32, governed, bounds)?);
        self.ends.push(self.messages.len());
        self.lines.push(line);
        Ok(())
    }

    /// Number of moves in the program as it is sent to the control, whether a law governs them or not.
    pub fn moves(&self) -> usize {
        self.ends.len()
    }

    /// Messages of the first `moves` moves, in order.
    pub fn messages(&self, moves: usize) -> &[Message] {
        let all = self.ends.last().copied().unwrap_or(0);
        let end = moves.checked_sub(1).map_or(0, |last| self.ends.get(last).copied().unwrap_or(all));
        self.messages.get(..end).unwrap_or_default()
    }

    /// Number of moves that the first `messages` messages contain.
    fn moves_in(&self, messages: usize) -> usize {
        self.ends.partition_point(|end| *end <= messages)
    }

    /// Number of moves that have certainly ended when the control has started `blocks` blocks: all moves of the lines before the line of
    /// the block that it started last.
    pub fn over(&self, blocks: usize, sending: &Transmission) -> usize {
        let in_work = sending.line_of_block(blocks).unwrap_or(0);
        self.lines.partition_point(|line| *line < in_work)
    }

    /// Index in the transmission of the line of the move with this number, counted from 0; `None` if there are fewer moves.
    pub fn line_of(&self, count: usize) -> Option<usize> {
        self.lines.get(count).copied()
    }

    /// Offset in the transmission up to which text may be sent when the board has received `delivered` messages: the start of the line of
    /// the first move that it lacks. No limit if it has all moves.
    pub fn permitted(&self, delivered: usize, sending: &Transmission) -> usize {
        self.lines.get(self.moves_in(delivered)).map_or(usize::MAX, |line| sending.start_of(*line))
    }
}

/// Moves of a block that makes several, relative to the workpiece's origin.
fn series(line: &ProgramLine) -> Vec<Segment> {
    let Some(meaning) = &line.meaning else { return Vec::new() };
    let Some(series) = &meaning.step.series else { return Vec::new() };
    let motions = series.actions().filter_map(|act| match act {
        SeriesAction::Move(motion) => Segment::from_motion(&motion, meaning.parsed.block.sequence).ok(),
        SeriesAction::Dwell(_) | SeriesAction::Spindle(_) => None,
    });
    motions.map(|segment| segment.shifted(Pose::ORIGIN.minus(line.origin))).collect()
}

#[cfg(test)]
mod tests {
    use arcfeed_law::table::Table;
    use arcfeed_model::engaged::{EngagedInterval, EngagedKnot, EngagedTable};
    use arcfeed_nc::segment::Path;
    use arcfeed_units::{Mm, MmPerTooth};

    use super::*;

    fn governed(along: Option<&MoveTable>) -> Option<MoveLaw<'_>> {
        let rule = along.is_none_or(|along| along.engaged().is_some()).then_some(0);
        Some(MoveLaw { rule, spindle: None, along })
    }

    fn table(knots: usize) -> EngagedTable {
        let outer = EngagedInterval::from_degrees(0.0, 75.5).expect("an arc");
        let knot = |at| EngagedKnot { travelled: Mm(at as f32), outer, inner: EngagedInterval::EMPTY };
        EngagedTable::new(&(0..knots).map(knot).collect::<Vec<_>>()).expect("a table")
    }

    /// One move per line, with tables of so many knots; 0: without tables.
    fn plan(knots: &[usize]) -> BoardPlan {
        let [start, end] = [Pose::default(); 2];
        let segment = Segment { sequence: None, start, end, feed: Feed::Missing, path: Path::Line };
        let mut plan = BoardPlan::default();
        for (line, knots) in knots.iter().enumerate() {
            let along = (*knots > 0).then(|| MoveTable::Engaged(table(*knots)));
            plan.add(line, &segment, governed(along.as_ref()), MoveBounds::NONE).expect("it can be sent");
        }
        plan
    }

    #[test]
    fn the_engaged_arcs_of_a_move_come_before_it_in_their_order() {
        let plan = plan(&[0, 3, 16]);
        assert_eq!([1, 2, 3, 9].map(|moves| plan.messages(moves).len()), [1, 5, 22, 22]);
        assert!(plan.messages(0).is_empty());
        let counts: Vec<Option<u32>> = plan.messages(2).iter().map(count).collect();
        assert_eq!(counts, [Some(0), None, None, None, Some(1)]);
        let sent: Vec<Message> = table(3).knots().iter().map(|knot| encode_arcs(knot).unwrap().into()).collect();
        assert_eq!(plan.messages(2)[1..4], sent);
    }

    fn count(message: &Message) -> Option<u32> {
        if let Message::Segment(segment) = message { Some(segment.count) } else { None }
    }

    #[test]
    fn a_move_is_the_boards_only_with_its_engaged_arcs() {
        let plan = plan(&[0, 3, 16]);
        let sent: Vec<usize> = (0..=22).map(|messages| plan.moves_in(messages)).collect();
        assert_eq!(sent[..6], [0, 1, 1, 1, 1, 2]);
        assert!(sent[5..22].iter().all(|moves| *moves == 2) && sent[22] == 3, "{sent:?}");
    }

    #[test]
    fn the_feeds_of_a_plunge_come_before_it_and_it_has_no_rule() {
        let knots = [(0.0, 0.05), (4.0, 0.08)].map(|(at, feed)| (Mm(at), MmPerTooth(feed)));
        let feeds = MoveTable::Feeds(Table::new(&knots).expect("a table"));
        let [start, end] = [Pose::default(); 2];
        let segment = Segment { sequence: None, start, end, feed: Feed::Missing, path: Path::Line };
        let bounds = MoveBounds { max_feed: Some(Nm(7)), ..MoveBounds::NONE };
        let sent = encode_move(&segment, 3, governed(Some(&feeds)), bounds).expect("it can be sent");
        let expected = knots.map(|knot| Message::from(encode_feed(&knot).expect("it can be sent")));
        assert_eq!(sent[..2], expected);
        assert!(matches!(sent[2], Message::Segment(moved) if (moved.rule, moved.max_feed) == (None, Some(7))));
    }

    #[test]
    fn a_table_that_cannot_be_sent_is_refused() {
        let outer = EngagedInterval::EMPTY;
        let far = EngagedKnot { travelled: Mm(9e6), outer, inner: outer };
        let far = MoveTable::Engaged(EngagedTable::new(&[far]).expect("a table"));
        let segment = Segment {
            sequence: None,
            start: Pose::default(),
            end: Pose::default(),
            feed: Feed::Missing,
            path: Path::Line,
        };
        assert_eq!(
            BoardPlan::default().add(0, &segment, governed(Some(&far)), MoveBounds::NONE),
            Err(MoveError::Range)
        );
    }
}
