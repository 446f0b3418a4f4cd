//! Sources of the feed override: the seam between the machine and the feed controller, whichever it is.
//!
//! [`controller`] is a controller in this process that is notified of each move. [`board`] is a feed board that sees only the machine's
//! signals.

pub mod controller;

pub mod board;

pub mod in_process;

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::report::Reason;
use arcfeed_firmware::supervisor::signals::Signals;
use arcfeed_link::message::codes::StateCode;
use arcfeed_model::cut::CutRule;
use arcfeed_model::engaged::EngagedTable;
use arcfeed_model::machine::FeedLimit;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_units::{Micros, RevPerMin};

/// Signals of the machine in a servo period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MachineSignals {
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
pub struct MoveStart<'a> {
    /// Running count of the move.
    pub count: u32,
    /// The move, in the workpiece's coordinates.
    pub segment: &'a Segment,
    /// Cut rule of the job for the move.
    pub rule: Option<&'a CutRule>,
    /// Engaged arcs of the tool's circles along the move, for a rule that expects engagement per move.
    pub along: Option<&'a EngagedTable>,
    /// Commanded spindle speed.
    pub spindle: RevPerMin,
    /// Largest feed on the move, if it differs from that of the job's axes and ceiling.
    pub limit: Option<FeedLimit>,
    /// Largest override at the end of the move, %.
    pub end_percent: u8,
}

/// Reason and state behind an override.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// State of the supervisor.
    pub state: StateCode,
    /// Reason of the override; `None` if the source does not report it.
    pub reason: Option<Reason>,
}

/// Source of the feed override, called once a servo period.
pub trait OverrideSource {
    /// Notes that the control begins a move, or has none in work. A controller that follows the position ignores it.
    fn begin(&mut self, _begun: Option<MoveStart<'_>>) {}

    /// Decides on the override that the control reads from now on.
    fn decide(&mut self, shown: &MachineSignals) -> FeedOverride;

    /// Last decision; `None` before the first, and of a source that reports none.
    fn decision(&self) -> Option<Decision> {
        None
    }
}

impl<D: OverrideSource + ?Sized> OverrideSource for Box<D> {
    fn begin(&mut self, begun: Option<MoveStart<'_>>) {
        D::begin(self, begun);
    }

    fn decide(&mut self, shown: &MachineSignals) -> FeedOverride {
        D::decide(self, shown)
    }

    fn decision(&self) -> Option<Decision> {
        D::decision(self)
    }
}
