//! Moves with a chamfer or rounded corner (`,C`, `,R`) at one of their ends, as a control executes them.
//!
//! The corner depends on the move behind it. A block-delete switch (`/`) may take that move away, so a corner beside such a
//! block is not known.

use arcfeed_compensation::insertion::InsertedCorner;
use arcfeed_nc::modal::{Corner, Plane};
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::segment::Segment;

/// Move next to a chamfer or rounded corner, in path coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerMove {
    /// Move without the parts that the corners at its ends take away.
    pub segment: Segment,
    /// Chamfer or arc after the move, which has the F of the same block; `None` without one.
    pub inserted: Option<Segment>,
}

/// Inserter of chamfers and rounded corners into a program's moves, block by block.
#[derive(Clone, Copy, Debug, Default)]
pub struct CornerMoves {
    held: Option<HeldMove>,
}

/// Move that ends in a corner.
#[derive(Clone, Copy, Debug)]
struct HeldMove {
    /// Number of its line.
    line: usize,
    segment: Segment,
    plane: Plane,
    corner: Corner,
}

impl CornerMoves {
    /// Whether the move of this line waits for the next move, which determines its corner.
    pub fn holds(&self, line: usize) -> bool {
        self.held.is_some_and(|held| held.line == line)
    }

    /// Processes the block of a line; returns the moves that have become known, with their lines.
    pub fn pass(&mut self, line: usize, block: &InterpretedLine) -> [Option<(usize, CornerMove)>; 2] {
        let is_blank = block.parsed.block.words.is_empty();
        let (Some(segment), Some(motion)) = (block.segment, &block.step.motion) else {
            self.held = self.held.filter(|_| is_blank);
            return [None; 2];
        };
        let held = self.held.take();
        if block.parsed.block.delete.is_some() {
            return [None; 2];
        }
        let corner = block.step.corner;
        let inserted = held.map(|held| InsertedCorner::new(&held.segment, &segment, held.plane, held.corner));
        let inserted = match inserted.transpose() {
            Ok(inserted) => inserted,
            Err(_) => return [None; 2],
        };
        let own = inserted.map_or(segment, |inserted| inserted.second);
        self.held = corner.map(|corner| HeldMove { line, segment: own, plane: motion.plane, corner });
        let before = held.zip(inserted).map(|(held, inserted)| {
            let InsertedCorner { first, between, .. } = inserted;
            (held.line, CornerMove { segment: first, inserted: between })
        });
        let is_last = before.is_some() && corner.is_none();
        [before, is_last.then_some((line, CornerMove { segment: own, inserted: None }))]
    }
}
