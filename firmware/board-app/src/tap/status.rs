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

/// Whether the tap follows the program that the control executes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TapState {
    /// It waits: no program has started since power-on, or the last one has ended.
    #[default]
    Listening,
    /// It reads the blocks, and the axes follow them: feeds are adapted.
    InStep,
    /// It waits for the end of moves whose path is not the programmed one: a canned cycle, a return to a reference
    /// point, a contour under G41 or G42.
    Passing,
    /// It does not know what the control does, until the next program starts.
    Lost(TapLossReason),
}

/// Reason why the tap does not know what the control does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapLossReason {
    /// A block contains a character that is not in the line's code, or could not be received.
    Damaged,
    /// A block is longer than [`super::settings::LINE_MAX`] characters.
    LongBlock,
    /// The sender is so far ahead of the machine that the tap cannot hold the characters between.
    TooFarAhead,
    /// A block would cause an alarm, or needs what the tap does not have: macros, calls, state of the switches for
    /// `/`.
    NotUnderstood(Fault),
    /// The effect of the program depends on data in the control, such as a system variable or another program.
    OutOfSight,
    /// The axes are not on the path of the move that they should execute.
    OffPath,
}

/// Counts of the tap since power-on; all wrap around.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TapCounters {
    /// Characters that have arrived from the sender.
    pub from_sender: u32,
    /// Characters that have arrived from the control.
    pub from_control: u32,
    /// DC3 (XOFF) characters that have arrived from the control.
    pub stops: u32,
    /// Blocks that were interpreted.
    pub blocks: u32,
    /// Moves that were passed to the control task.
    pub segments: u32,
    /// Moves that were passed to the control task and that a law governs.
    pub governed: u32,
    /// Programs that have started.
    pub programs: u32,
    /// Programs that started before the previous one had ended.
    pub restarts: u32,
    /// Number of times that the tap lost track of what the control does.
    pub losses: u32,
    /// Blocks that were not interpreted, because the tap did not follow the program when it reached them.
    pub passed_over: u32,
}
