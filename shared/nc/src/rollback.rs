//! Rollback: copy of the modal state before a block, restored if the block is rejected.
//!
//! Most blocks are G0 to G3 with axes and a feed. For them only the few fields that they can change are copied, which
//! costs a fraction of a copy of the whole state. Any other block copies the whole state.

use super::block::{Block, letters};
use super::modal::{Modal, MotionKind, Pose};
use arcfeed_units::Nm;

/// Letters of a plain block.
const PLAIN_LETTERS: u32 = letters(b"ABCFGIJKXYZ");

/// Saved state.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and the large one is the rare one")]
pub(crate) enum Rollback {
    /// The fields that a plain block can change.
    Plain { motion: MotionKind, feed: Option<Nm>, position: Pose, program: Pose },
    /// The whole state.
    Whole(Modal),
}

impl Rollback {
    /// Saves the modal state before a block whose G codes have not been applied yet.
    #[inline]
    pub fn new(modal: &Modal, block: &Block) -> Self {
        let is_pending = modal.starts_up || modal.rotation_pending || modal.ends_in_corner;
        let is_plain = modal.cycle.is_none() && modal.polar.is_none() && !is_pending;
        if !is_plain || block.may_have(!PLAIN_LETTERS) {
            return Rollback::Whole(*modal);
        }
        let Modal { motion, feed, position, program, .. } = *modal;
        Rollback::Plain { motion, feed, position, program }
    }

    /// Extends the copy to the whole state, before a G code other than G0 to G3 is applied. Only G0 to G3 may have
    /// changed `modal` so far.
    #[inline(never)]
    pub fn keep_whole(&mut self, modal: &Modal) {
        if let Rollback::Plain { motion, .. } = *self {
            *self = Rollback::Whole(Modal { motion, ..*modal });
        }
    }

    /// Restores the saved modal state.
    #[cold]
    pub fn restore(self, modal: &mut Modal) {
        *modal = match self {
            Rollback::Plain { motion, feed, position, program } => Modal { motion, feed, position, program, ..*modal },
            Rollback::Whole(whole) => whole,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::block::{Reading, parse_line};
    use super::super::modal::Step;
    use super::super::settings::{Preset, Settings, Tables};
    use super::*;
    use arcfeed_units::LengthUnit;

    const WORDS: &[&str] = &[
        "G0", "G1", "G2", "G3", "G4", "G10", "G16", "G15", "G17", "G18", "G20", "G28", "G40", "G41", "G43", "G43.4",
        "G49", "G51", "G51.1", "G50.1", "G52", "G53", "G54", "G55", "G68", "G69", "G80", "G81", "G83", "G90", "G91",
        "G92", "G93", "G94", "G95", "G99", "G300", "X1.5", "Y-2.", "Z3", "A10.", "I1.", "J-1.5", "R2.", "R-1.",
        "F100.", "F-1.", "S500", "M3", "M30", "M98", "H1", "D1", "L2", "P1", "Q.5", ",C1.", ",R.5",
    ];

    #[test]
    fn from_any_state_every_block_can_be_taken_back() {
        let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
        let (tables, mut step, mut seed) = (Tables::default(), Step::default(), 1_u32);
        let mut modal = Modal::at_power_on(LengthUnit::Mm);
        let mut refused = 0;
        for _ in 0..200_000 {
            let mut line = String::new();
            let mut next = |below: usize| {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (seed >> 16) as usize % below
            };
            for _ in 0..1 + next(4) {
                line += WORDS[next(WORDS.len())];
            }
            let block = parse_line(line.as_bytes(), Reading::Lenient).unwrap().block;
            let (state, mut rollback) = (modal, Rollback::new(&modal, &block));
            let result = modal.advance(&block, (&settings, &tables), &mut step, &mut rollback);
            let after = modal;
            rollback.restore(&mut modal);
            assert_eq!(modal, state, "{line}: {result:?}");
            match result {
                Ok(()) => modal = after,
                Err(_) => refused += 1,
            }
        }
        assert!((20_000..180_000).contains(&refused), "{refused}");
    }
}
