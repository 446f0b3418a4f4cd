//! The example jobs and their runs, as `tests/board/recorded_runs.rs` records them.

use core::ops::RangeFrom;
use core::slice::{ChunksExact, Iter};

use arcfeed_model::cut::{ContourSide::*, CutRule, Moves, RotationCircle::*, Work};
use arcfeed_model::job::{
    FeedCeiling, FeedPolicy::*, Job, LawKind, OverrideLimits, SpeedSource, ToolAxis, ToolSetup, Tools,
};
use arcfeed_model::knots::Knots;
use arcfeed_model::machine::MachineLimits;
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{CupMill, Edge::*, EndMill, Tool};
use arcfeed_nc::modal::{Feed::*, Plane::*, Pose, Turn::*};
use arcfeed_nc::segment::{Arc, Path::*, Segment};
use arcfeed_units::{LengthUnit::*, MicroDeg, MmPerMin, MmPerTooth, Nm, RevPerMin, Span};

/// A move of the recorded run, or a rest between moves.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// First tick at which it is in execution.
    pub first_tick: u32,
    /// Index of the cut rule that applies to it; `None` if none does.
    pub rule: Option<usize>,
    /// The move; `None` for a rest.
    pub segment: Option<Segment>,
}

/// A recorded run of an example job: its blocks, and the position at each tick.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// The blocks of the run.
    pub blocks: &'static [Block],
    ticks: &'static [u8],
}

include!("../../recorded-runs/ibr_slot.rs");

include!("../../recorded-runs/pocket_contour.rs");

include!("../../recorded-runs/pocket_engagement.rs");

/// Time between two ticks of a recorded run.
pub const TICK: Span = Span::from_ms(1);

const NM_PER_UM: i64 = 1_000;
const BYTES_PER_TICK: usize = 6;

impl Block {
    /// Cut rule that applies to the move; `None` if none does.
    pub fn cut<'j>(&self, job: &'j Job) -> Option<&'j CutRule> {
        self.rule.and_then(|index| job.rules.get(index))
    }
}

/// Iterator over the recorded run, tick by tick: the position and, when a new block begins, the block with its count.
#[derive(Debug)]
pub struct Run {
    tick: u32,
    ticks: ChunksExact<'static, u8>,
    blocks: core::iter::Peekable<core::iter::Zip<RangeFrom<u32>, Iter<'static, Block>>>,
    linear: [Nm; 3],
}

impl Example {
    /// Iterator over the ticks of the run, from its start.
    pub fn run(self) -> Run {
        let blocks = (1..).zip(self.blocks.iter()).peekable();
        Run { tick: 0, ticks: self.ticks.chunks_exact(BYTES_PER_TICK), blocks, linear: [Nm(0); 3] }
    }
}

impl Iterator for Run {
    type Item = (Pose, Option<(u32, &'static Block)>);

    fn next(&mut self) -> Option<Self::Item> {
        let change = self.ticks.next()?;
        for (axis, bytes) in self.linear.iter_mut().zip(change.chunks_exact(2)) {
            let um = bytes.iter().rev().fold(0, |high, low| high << 8 | i32::from(*low)) as u16 as i16;
            axis.0 += i64::from(um) * NM_PER_UM;
        }
        let new = self.blocks.next_if(|(_, block)| block.first_tick <= self.tick);
        self.tick += 1;
        Some((Pose { linear: self.linear, ..Pose::default() }, new))
    }
}
