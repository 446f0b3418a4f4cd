//! Counts of moves.

use arcfeed_nc::modal::{Motion, MotionKind};
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::series::SeriesAction;

/// Counts of moves; those of canned cycles and reference returns count one by one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MoveCounts {
    /// Arcs, helices among them.
    pub arcs: usize,
    /// Arcs that also move across their plane.
    pub helices: usize,
    /// Straight cutting moves.
    pub linear: usize,
    /// Rapid moves.
    pub rapids: usize,
    /// Moves of any kind in which a rotary axis turns.
    pub rotary: usize,
}

impl MoveCounts {
    /// Counts the moves of one more block.
    pub fn add(&mut self, block: &InterpretedLine) {
        if let (Some(motion), Some(_)) = (&block.step.motion, &block.segment) {
            self.add_move(motion);
        }
        let Some(series) = &block.step.series else { return };
        for act in series.actions() {
            if let SeriesAction::Move(motion) = act {
                self.add_move(&motion);
            }
        }
    }

    fn add_move(&mut self, motion: &Motion) {
        let Motion { kind, plane, start, end, .. } = motion;
        let (.., normal) = plane.axes();
        match kind {
            MotionKind::Arc(_) => {
                self.arcs += 1;
                self.helices += usize::from(start.linear[normal] != end.linear[normal]);
            }
            MotionKind::Line => self.linear += 1,
            MotionKind::Rapid => self.rapids += 1,
        }
        self.rotary += usize::from(start.rotary != end.rotary);
    }
}
