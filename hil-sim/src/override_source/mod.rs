//! Sources of the feed override: the seam between the machine and the feed controller, whichever it is.
//!
//! [`controller`] is a controller in this process that is notified of each move. [`board`] is a feed board that sees only the machine's
//! signals.

pub mod controller;

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

/// The machine's signals at a servo period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Time.
    pub at: Micros,
    /// Position feedback, in the workpiece's coordinates.
    pub position: Pose,
    /// Spindle speed.
    pub spindle: RevPerMin,
    /// The operator's dial, %.
    pub operator_percent: u8,
    /// Signals of the control.
    pub signals: Signals,
}

/// A move that the control begins, with its conditions.
#[derive(Clone, Copy, Debug)]
pub struct Begun<'a> {
    /// Its running count.
    pub count: u32,
    /// The move, in the workpiece's coordinates.
    pub segment: &'a Segment,
    /// The job's cut rule that speaks of it.
    pub rule: Option<&'a CutRule>,
    /// Engaged arcs of the tool's circles along it, for a rule that expects engagement per move.
    pub along: Option<&'a EngagedTable>,
    /// Commanded spindle speed.
    pub spindle: RevPerMin,
    /// The fastest feed on it, where it is not the one of the job's axes and ceiling.
    pub limit: Option<FeedLimit>,
    /// Largest override at its end, %.
    pub end_percent: u8,
}

/// A source of the feed override, asked once a servo period.
pub trait OverrideSource {
    /// Notes that the control begins a move, or has none in work. A controller that follows the position ignores it.
    fn begin(&mut self, _begun: Option<Begun<'_>>) {}

    /// Decides on the override that the control reads from now on.
    fn decide(&mut self, shown: &Shown) -> FeedOverride;
}

impl<D: OverrideSource + ?Sized> OverrideSource for Box<D> {
    fn begin(&mut self, begun: Option<Begun<'_>>) {
        D::begin(self, begun);
    }

    fn decide(&mut self, shown: &Shown) -> FeedOverride {
        D::decide(self, shown)
    }
}
