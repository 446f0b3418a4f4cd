//! State and counters of the tap, for telemetry.
//!
//! ```text
//!             label with %        a stretch it cannot follow
//!   Listening -------------> InStep --------------------------> Passing
//!      ^  ^                  |    ^                               |  |
//!      |  |     M02, M30     |    +-------------------------------+  |
//!      |  +------------------+      the axes stand where it ends     |
//!      |                     | not to be relied on any more          |
//!      |                     v                                       |
//!      |                   Lost(why) <-------------------------------+
//!      +----------------------+   label with %
//! ```
//! Segments are emitted only in [`TapState::InStep`]. In all other states no segment is in execution, and the override
//! is 100 %.

use arcfeed_nc::alarm::Fault;

/// State of the adaptation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TapState {
    /// No program has started since power-on, or the last one has ended.
    #[default]
    Listening,
    /// Blocks are read and the axes follow them.
    InStep,
    /// Moves whose path is not the programmed one: a cycle, a reference point, a contour under G41 or G42.
    Passing,
    /// The behaviour of the control is unknown, until the next program starts.
    Lost(TapLossReason),
}

/// Reason why the behaviour of the control is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapLossReason {
    /// A block contains a character that is not in its code or could not be received.
    Damaged,
    /// A block is longer than the tap's line.
    LongBlock,
    /// The sender is further ahead of the machine than the tap has room for.
    TooFarAhead,
    /// A block is an alarm for the control, or needs data that the tap does not have: macros, calls, skips.
    NotUnderstood(Fault),
    /// The effect of the program depends on data in the control: a system variable, another program.
    OutOfSight,
    /// The axes have left the path.
    OffPath,
}

/// Counters since power-on; they wrap around.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TapCounters {
    /// Characters from the sender.
    pub from_sender: u32,
    /// Characters from the control.
    pub from_control: u32,
    /// DC3 (XOFF) characters of the control.
    pub stops: u32,
    /// Blocks read.
    pub blocks: u32,
    /// Emitted segments.
    pub segments: u32,
    /// Emitted segments with a cut rule.
    pub governed: u32,
    /// Started programs.
    pub programs: u32,
    /// Programs that started before the previous one had ended.
    pub restarts: u32,
    /// Number of times the tap was lost.
    pub losses: u32,
    /// Blocks received while it was lost.
    pub passed_over: u32,
}
