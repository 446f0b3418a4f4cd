//! Chamfers and rounded corners (`,C` and `,R`): the blocks between which one may stand.
//!
//! The control joins both moves with a chamfer or an arc. Here each block is interpreted up to the point of the corner;
//! who executes the moves inserts the corner. Source: numbers and texts of the alarms of the 16i; which blocks may stand
//! behind a corner is an assumption where no alarm says it.

use super::alarm::{Alarm, Fault, NotModelled};
use super::block::Block;
use super::modal::{Corner, Feed, Modal, Motion, MotionKind, Step};
use super::settings::Decimals;
use super::word::{CHAMFER, ROUNDING, Word};
use arcfeed_units::Nm;

/// G codes, in tenths, that may stand in the block behind a corner.
const BEHIND: [i64; 14] = [0, 10, 20, 30, 90, 400, 410, 420, 610, 640, 900, 910, 940, 950];

impl Modal {
    /// Interprets the corner that a block ends in, and checks a block behind one.
    #[cold]
    pub(super) fn apply_corner(
        &mut self,
        block: &Block,
        decimals: Decimals,
        is_start_up: bool,
        step: &mut Step,
    ) -> Result<(), Fault> {
        let is_behind = self.ends_in_corner && !block.words.is_empty();
        if is_behind {
            self.check_behind(block, step)?;
            self.ends_in_corner = false;
        }
        let mut words = block.words.iter().filter(|word| matches!(word.letter, CHAMFER | ROUNDING));
        if let Some(word) = words.next() {
            if let Some(second) = words.next() {
                return Err(Fault::alarm(Alarm::TwoCorners, second.column));
            }
            if is_start_up || !self.allows_corner(step) {
                return Err(Fault::not_modelled(NotModelled::Corner, word.column));
            }
            step.corner = self.corner(word, decimals)?;
            self.ends_in_corner = step.corner.is_some();
        }
        if (is_behind || step.corner.is_some()) && step.is_plain() {
            step.beyond_plain = Some(NotModelled::Corner);
        }
        Ok(())
    }

    /// Corner of a word; `None` for one of no size.
    fn corner(&self, word: &Word, decimals: Decimals) -> Result<Option<Corner>, Fault> {
        if word.number.is_negative() {
            return Err(Fault::alarm(Alarm::MinusSign, word.column));
        }
        let size = Nm(self.length(word.number, decimals));
        let corner = if word.letter == CHAMFER { Corner::Chamfer(size) } else { Corner::Rounding(size) };
        Ok((size.0 != 0).then_some(corner))
    }

    fn check_behind(&self, block: &Block, step: &Step) -> Result<(), Fault> {
        let is_other =
            |word: &&Word| word.letter == b'G' && word.number.as_tenths().is_none_or(|g| !BEHIND.contains(&g));
        if let Some(word) = block.words.iter().find(is_other) {
            return Err(Fault::not_modelled(NotModelled::Corner, word.column));
        }
        match &step.motion {
            Some(motion) if motion.kind == MotionKind::Rapid => Err(Fault::alarm(Alarm::NoCutBehindCorner, 0)),
            Some(motion) if stays_in_plane(motion) => Ok(()),
            Some(_) | None => Err(Fault::alarm(Alarm::NoMoveBehindCorner, 0)),
        }
    }

    /// Whether the move of a block may end in a corner: a cutting move in the plane whose F is a speed, with lengths that
    /// G51 does not change, and without a stop behind it.
    fn allows_corner(&self, step: &Step) -> bool {
        let is_scaled =
            || self.frame.scaling().is_some_and(|scaling| scaling.thousandths.iter().any(|by| by.abs() != 1_000));
        let is_cut = |motion: &Motion| motion.kind != MotionKind::Rapid && !matches!(motion.feed, Feed::InverseTime(_));
        let is_plain = !self.follows_tool_center && step.stop.is_none() && !is_scaled();
        step.motion.is_some_and(|motion| is_cut(&motion) && stays_in_plane(&motion)) && is_plain
    }
}

/// Whether a move travels in the plane and nowhere else.
fn stays_in_plane(motion: &Motion) -> bool {
    let (first, second, normal) = motion.plane.axes();
    let moves = |axis: usize| motion.start.linear.get(axis) != motion.end.linear.get(axis);
    let is_arc = matches!(motion.kind, MotionKind::Arc(_));
    (is_arc || moves(first) || moves(second)) && !moves(normal) && motion.start.rotary == motion.end.rotary
}
