//! Who decides the override: the seam between the machine and the feed controller, whichever it is.
//!
//! [`told`] is a controller in this process that is told which move the control executes. [`board`] is one that sees only what
//! machine shows of itself.

pub mod told;

pub mod board;

pub mod in_process;

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::signals::Signals;
use arcfeed_shared::cut::CutRule;
use arcfeed_shared::engaged::EngagedTable;
use arcfeed_shared::machine::FeedLimit;
use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::{Micros, RevPerMin};

/// What the machine shows a controller once a servo period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// When.
    pub at: Micros,
    /// Position feedback, in the workpiece's coordinates.
    pub position: Pose,
    /// Spindle speed.
    pub spindle: RevPerMin,
    /// The operator's dial, %.
    pub operator_percent: u8,
    /// What the control says.
    pub signals: Signals,
}

/// A move that the control begins.
#[derive(Clone, Copy, Debug)]
pub struct Begun<'a> {
    /// Its running count.
    pub count: u32,
    /// The move, in the workpiece's coordinates.
    pub segment: &'a Segment,
    /// The job's cut rule that speaks of it.
    pub rule: Option<&'a CutRule>,
    /// Where the tool's circles are engaged along it, where the rule leaves that to be told.
    pub along: Option<&'a EngagedTable>,
    /// Commanded spindle speed.
    pub spindle: RevPerMin,
    /// The fastest feed on it, where it is not the one of the job's axes and ceiling.
    pub limit: Option<FeedLimit>,
    /// Largest override at its end, %.
    pub end_percent: u8,
}

/// Decides the override, once a servo period.
pub trait Decider {
    /// The control begins a move, or has none in work. A controller that follows the position does not listen.
    fn begin(&mut self, _begun: Option<Begun<'_>>) {}

    /// One servo period: the override that the control reads from now on.
    fn decide(&mut self, shown: &Shown) -> FeedOverride;
}

impl<D: Decider + ?Sized> Decider for Box<D> {
    fn begin(&mut self, begun: Option<Begun<'_>>) {
        D::begin(self, begun);
    }

    fn decide(&mut self, shown: &Shown) -> FeedOverride {
        D::decide(self, shown)
    }
}
