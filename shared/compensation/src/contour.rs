//! Compensation commanded by a block: the offset in force, the corner at the end of its move, and what ends a contour
//! before its time.
//!
//! Coordinates are those of the path: an offset is not scaled by G51, and a mirrored axis of the plane exchanges the
//! sides.

use arcfeed_nc::alarm::{Fault, NotModelled};
use arcfeed_nc::block::Block;
use arcfeed_nc::modal::{CompensationSide, Feed, Modal, Step};
use arcfeed_nc::motion::{Corner, Plane};
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::segment::Segment;
use arcfeed_nc::series::Series;
use arcfeed_nc::settings::Tables;
use arcfeed_units::Nm;

use crate::compensator::{CenterMoves, CompensationFault, Compensator, ContourMove};
use crate::vector::in_plane;

/// Cutter compensation that a block commands: plane and offset, and what the block means for the contour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContourCommand {
    /// Plane of compensation.
    pub plane: Plane,
    /// Distance of the tool centre from the contour, positive to its left seen in the direction of motion; 0 without
    /// compensation.
    pub offset: Nm,
    /// Reason why this block must not have an offset, or be within a contour; `None` if it may.
    pub refusal: Option<Fault>,
    /// Reason why this block must not stand between two moves of a contour, although it could stand outside of one; `None` if
    /// it may.
    pub break_of_contour: Option<Fault>,
    /// Whether moves were offset before the block. Set by the reader of the program; always false from [`Self::of`].
    pub continues: bool,
    /// Whether the control reads no further block before it has executed this one, so that the held move cannot wait
    /// for the next.
    pub stops_reading: bool,
    /// Chamfer or rounded corner (`,C`, `,R`) to be inserted at the end of the block's move.
    pub corner: Option<Corner>,
    /// Whether the block has words. A line with only a comment does not count among the blocks that the control reads
    /// ahead.
    pub has_words: bool,
}

impl Default for ContourCommand {
    fn default() -> Self {
        ContourCommand {
            plane: Plane::Xy,
            offset: Nm(0),
            refusal: None,
            break_of_contour: None,
            continues: false,
            stops_reading: false,
            corner: None,
            has_words: false,
        }
    }
}

impl ContourCommand {
    /// Compensation commanded by a block; `modal` is the modal state after the block.
    pub fn of(line: &InterpretedLine, modal: &Modal, tables: &Tables) -> Self {
        ContourCommand {
            plane: modal.plane,
            offset: offset(modal, tables),
            refusal: refusal(line, modal),
            break_of_contour: break_of_contour(line),
            continues: false,
            stops_reading: line.step.stop.is_some(),
            corner: line.step.corner,
            has_words: !line.parsed.block.words.is_empty(),
        }
    }

    /// Passes the block and its move, if it has one, to the compensator; returns the moves of the tool centre that are
    /// complete now.
    ///
    /// # Errors
    /// Those of [`Compensator::add`]; also the fault of a block that must not stand in a contour.
    pub fn apply(
        &self,
        segment: Option<&Segment>,
        compensator: &mut Compensator,
    ) -> Result<CenterMoves, CompensationFault> {
        let refusal = self.refusal.filter(|_| self.offset != Nm(0));
        let within = self.refusal.or(self.break_of_contour).filter(|_| compensator.is_active());
        if let Some(fault) = refusal.or(within) {
            return Err(CompensationFault::Given(fault));
        }
        let mut moves = match segment {
            Some(segment) => {
                let ContourCommand { plane, offset, .. } = *self;
                compensator.add(&ContourMove { segment: *segment, plane, offset })?
            }
            None if self.has_words && self.offset == Nm(0) => compensator.end_held()?,
            None if self.has_words => compensator.add_block()?,
            None => CenterMoves::new(),
        };
        if self.stops_reading {
            for center_move in compensator.end_held()? {
                let _full = moves.push(center_move);
            }
        }
        Ok(moves)
    }
}

/// Distance of the tool centre from the path: the tool radius of the offset in force (its D number), positive if the
/// tool is on the left of the path, 0 without compensation.
pub fn offset(modal: &Modal, tables: &Tables) -> Nm {
    let radius = tables.radius(modal.radius_offset);
    Nm(radius.0.saturating_mul(i64::from(side_sign(modal))))
}

/// Side of the path on which a positive radius puts the tool: 1 for the left, -1 for the right, 0 without
/// compensation. A mirror image in the plane (G51) exchanges the sides of G41 and G42.
pub fn side_sign(modal: &Modal) -> i8 {
    let (first, second, _) = modal.plane.axes();
    let is_mirrored = modal.frame.scaling().is_some_and(|scaling| {
        let is_negative = |axis: usize| scaling.thousandths.get(axis).is_some_and(|by| *by < 0);
        is_negative(first) != is_negative(second)
    });
    match modal.compensation {
        None => 0,
        Some(side) if (side == CompensationSide::Left) != is_mirrored => 1,
        Some(_) => -1,
    }
}

/// Reason why a block cannot have an offset, or end one.
fn refusal(line: &InterpretedLine, modal: &Modal) -> Option<Fault> {
    let (step, block) = (&line.step, &line.parsed.block);
    let within = |code, column| Some(Fault::not_modelled(NotModelled::InContour(code), column));
    if let Some(NotModelled::GCode(code)) = step.beyond_plain {
        // After G40 the tool may go up beside the contour before it goes back.
        let goes_up = modal.compensation.is_none() && stays_in_plane(step, modal.plane);
        return if goes_up { None } else { within(code, 0) };
    }
    let is_timed = step.motion.is_some_and(|motion| matches!(motion.feed, Feed::InverseTime(_)));
    let vector = block.words.iter().find(|word| matches!(word.letter, b'I' | b'J' | b'K'));
    match vector {
        _ if is_timed => within(930, 0),
        _ if modal.follows_tool_center && step.motion.is_some() => within(434, 0),
        Some(vector) => {
            code_of(block, |code| matches!(code, 400 | 410 | 420)).and_then(|(code, _)| within(code, vector.column))
        }
        None => None,
    }
}

/// Whether a return to a reference point, or a move in machine coordinates, does not travel in the plane.
fn stays_in_plane(step: &Step, plane: Plane) -> bool {
    match (&step.motion, &step.series) {
        (Some(motion), _) => in_plane(&motion.start, plane) == in_plane(&motion.end, plane),
        (None, Some(Series::Reference([start, between, end]))) => {
            let point = in_plane(start, plane);
            in_plane(between, plane) == point && in_plane(end, plane) == point
        }
        (None, _) => false,
    }
}

/// Reason why a block cannot stand between the moves of a contour: it changes coordinates, or repeats G41 or G42 without
/// a move, which the control takes for a vector at a right angle.
fn break_of_contour(line: &InterpretedLine) -> Option<Fault> {
    let has_move = line.segment.is_some();
    let breaks = |code| match code {
        410 | 420 => !has_move,
        _ => matches!(code, 500 | 501 | 510 | 511 | 520 | 540..=590 | 680 | 690 | 920 | 921),
    };
    let (code, column) = code_of(&line.parsed.block, breaks)?;
    Some(Fault::not_modelled(NotModelled::InContour(code), column))
}

/// First G code of a block, in tenths, of those `wanted`, and its column.
fn code_of(block: &Block, wanted: impl Fn(u16) -> bool) -> Option<(u16, u16)> {
    block.words.iter().filter(|word| word.letter == b'G').find_map(|word| {
        let tenths = u16::try_from(word.number.as_tenths()?).ok()?;
        wanted(tenths).then_some((tenths, word.column))
    })
}
