//! Numbers of a program's moves by kind.

use arcfeed_nc::modal::{Motion, MotionKind};
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::series::SeriesAction;

/// Numbers of moves by kind; the moves of canned cycles and reference returns count one by one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MoveCounts {
    /// Number of arcs, including helices.
    pub arcs: usize,
    /// Number of arcs that also move along the axis square to their plane.
    pub helices: usize,
    /// Number of straight cutting moves.
    pub linear: usize,
    /// Number of rapid moves.
    pub rapids: usize,
    /// Number of moves of any kind in which a rotary axis moves.
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
