//! Sources of the feed override: interface between the simulated machine and a feed controller, in this process or on a board.
//!
//! [`controller`] is a controller in this process that is notified of each move. [`board`] is a feed board that sees only the machine's
//! signals.

pub mod controller;

pub mod board;

pub mod in_process;

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::report::Reason;
use arcfeed_firmware::supervisor::signals::Signals;
use arcfeed_law::move_table::MoveTable;
use arcfeed_link::message::codes::StateCode;
use arcfeed_model::cut::CutRule;
use arcfeed_model::machine::FeedLimit;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_units::{Micros, RevPerMin};

/// Signals of the machine at the end of a servo period, as a feed controller sees them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MachineSignals {
    /// Time of the signals.
    pub at: Micros,
    /// Position feedback, in the workpiece's coordinates.
    pub position: Pose,
    /// Speed of the spindle.
    pub spindle: RevPerMin,
    /// The operator's dial, %.
    pub operator_percent: u8,
    /// Digital signals of the control, such as feed hold or rapid.
    pub signals: Signals,
}

/// A move that the control begins, with the conditions that the feed controller needs.
#[derive(Clone, Copy, Debug)]
pub struct MoveStart<'a> {
    /// Number of the move, counted up from one move to the next.
    pub count: u32,
    /// The move, in the workpiece's coordinates.
    pub segment: &'a Segment,
    /// Cut rule of the job for the move; `None` if none governs it.
    pub rule: Option<&'a CutRule>,
    /// Table along the move: engaged arcs for a rule that expects them with each move, or feeds for a move without a rule.
    pub along: Option<&'a MoveTable>,
    /// Commanded spindle speed.
    pub spindle: RevPerMin,
    /// Largest feed on the move; `None` if the limits of the job's axes and its ceiling apply.
    pub limit: Option<FeedLimit>,
    /// Largest override at the end of the move, %, so that the next move can begin with what it needs.
    pub end_percent: u8,
}

/// State of the supervisor and reason behind an override.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// State of the supervisor, such as armed or running.
    pub state: StateCode,
    /// Reason of the override; `None` if the source does not report it.
    pub reason: Option<Reason>,
}

/// Source of the feed override, called once a servo period.
pub trait OverrideSource {
    /// Receives the move that the control begins, or `None` if no move is in execution. A source that follows the position ignores it.
    fn begin(&mut self, _begun: Option<MoveStart<'_>>) {}

    /// Decides on the override that the control reads from now on, from the machine's signals.
    fn decide(&mut self, shown: &MachineSignals) -> FeedOverride;

    /// Decision behind the last override; `None` before the first one, and from a source that reports none.
    fn decision(&self) -> Option<Decision> {
        None
    }
}
