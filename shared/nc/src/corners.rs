//! Chamfers and rounded corners (`,C` and `,R`): the blocks between which one may stand.
//!
//! The control joins both moves with a chamfer or an arc. Here each block is interpreted up to the point of the corner;
//! who executes the moves inserts the corner. Source: numbers and texts of the alarms of the 16i; which blocks may stand
//! behind a corner is an assumption where no alarm says it.

use super::alarm::{Alarm, Fault, NotModelled};
use super::block::Block;
use super::modal::{Corner, Feed, Modal, Motion, MotionKind, Step};
use super::settings::Decimals;
use super::word::{CHAMFER, ROUNDING};
use arcfeed_units::Nm;

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
        let motion = step.motion.as_ref().filter(|motion| stays_in_plane(motion));
        let mut corner = None;
        for word in &block.words {
            // G codes that may stand behind a corner.
            let is_other =
                || !matches!(word.number.as_whole(), Some(0..=3 | 9 | 40..=42 | 61 | 64 | 90 | 91 | 94 | 95));
            match word.letter {
                CHAMFER | ROUNDING if corner.is_some() => return Err(Fault::alarm(Alarm::TwoCorners, word.column)),
                CHAMFER | ROUNDING => corner = Some(word),
                b'G' if is_behind && is_other() => return Err(Fault::not_modelled(NotModelled::Corner, word.column)),
                _ => {}
            }
        }
        let is_cut = motion.is_some_and(|motion| motion.kind != MotionKind::Rapid);
        if is_behind && !is_cut {
            let is_rapid = motion.is_some();
            let alarm = if is_rapid { Alarm::NoCutBehindCorner } else { Alarm::NoMoveBehindCorner };
            return Err(Fault::alarm(alarm, 0));
        }
        if let Some(word) = corner {
            let is_timed = motion.is_some_and(|motion| matches!(motion.feed, Feed::InverseTime(_)));
            let is_other = is_start_up || is_timed || self.follows_tool_center || self.frame.scaling().is_some();
            if !is_cut || is_other || step.stop.is_some() {
                return Err(Fault::not_modelled(NotModelled::Corner, word.column));
            }
            if word.number.is_negative() {
                return Err(Fault::alarm(Alarm::MinusSign, word.column));
            }
            let size = Nm(self.length(word.number, decimals));
            let corner = if word.letter == CHAMFER { Corner::Chamfer(size) } else { Corner::Rounding(size) };
            step.corner = Some(corner).filter(|_| size.0 != 0);
        }
        if !block.words.is_empty() {
            self.ends_in_corner = step.corner.is_some();
        }
        if (is_behind || step.corner.is_some()) && step.is_plain() {
            step.beyond_plain = Some(NotModelled::Corner);
        }
        Ok(())
    }
}

/// Whether a move travels in the plane and nowhere else.
fn stays_in_plane(motion: &Motion) -> bool {
    let (.., normal) = motion.plane.axes();
    let (start, end) = (&motion.start, &motion.end);
    let axes = start.linear.iter().zip(&end.linear).enumerate();
    let moved = axes.fold(0, |moved, (axis, (from, to))| moved | usize::from(from != to) << axis);
    let is_in_plane = moved != 0 || matches!(motion.kind, MotionKind::Arc(_));
    is_in_plane && moved >> normal & 1 == 0 && start.rotary == end.rotary
}
