//! The job and the blocks of its program, compiled in, as this board has no link to a host yet.

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_model::cut::{CutRule, Moves, RotationCircle::*, Work};
use arcfeed_model::job::{
    FeedCeiling, FeedPolicy::*, Job, LawKind, OverrideLimits, SpeedSource, ToolAxis, ToolSetup, Tools,
};
use arcfeed_model::knots::Knots;
use arcfeed_model::machine::MachineLimits;
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{CupMill, Edge::*, Tool};
use arcfeed_nc::modal::{Feed::*, Plane::*, Pose, Turn::*};
use arcfeed_nc::segment::{Arc, Path::*, Segment};
use arcfeed_units::{LengthUnit::*, MicroDeg, MmPerMin, MmPerTooth, Nm, RevPerMin};

/// A move of the program, or a rest between moves.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// First tick on the simulated machine at which it is in execution; not used here.
    pub first_tick: u32,
    /// Index of the cut rule that applies to it; `None` if none does.
    pub rule: Option<usize>,
    /// The move; `None` for a rest.
    pub segment: Option<Segment>,
}

/// The program's moves, and a recorded run of them.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// Moves of the program.
    pub blocks: &'static [Block],
    /// Positions of the simulated machine; not used here, and not in the image.
    pub ticks: &'static [u8],
}

include!("../../recorded-runs/ibr_slot.rs");

/// The moves of the compiled-in program.
pub const BLOCKS: &[Block] = ibr_slot::EXAMPLE.blocks;

/// The compiled-in job.
pub fn job() -> Job {
    ibr_slot::whole_job()
}

impl Block {
    /// Prepares the move for the controller; `None` for a rest.
    pub fn prepare(&self, job: &Job) -> Option<ActiveSegment> {
        let rule = self.rule.and_then(|index| job.rules.get(index));
        self.segment.as_ref().map(|segment| ActiveSegment::new(segment, rule, job))
    }
}
