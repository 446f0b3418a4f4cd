//! What the tap knows and does, for telemetry.
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
//! Only in [`TapState::InStep`] are segments handed out. In all others nothing is in work, and the override is 100 %.

use arcfeed_shared::nc::alarm::Fault;

/// Whether blocks are adapted, and why not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TapState {
    /// No program has begun since power-on, or the last one is over.
    #[default]
    Listening,
    /// The blocks are read and the axes follow them.
    InStep,
    /// A stretch whose ways are not the program's: a cycle, a reference point, a contour under G41 or G42.
    Passing,
    /// What the control does is not known. Until the next program begins.
    Lost(Why),
}

/// Why the tap does not know what the control does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// A block came with a character that its code does not have, or that the receiver could not read.
    Damaged,
    /// A block is longer than the tap's line.
    LongBlock,
    /// The sender is further ahead of the machine than the tap has room for.
    TooFarAhead,
    /// The control would stop at a block, or knows what the tap does not: macros, calls, skips.
    NotUnderstood(Fault),
    /// What stands in the control decides what the program does: a system variable, another program.
    OutOfSight,
    /// The axes went elsewhere.
    OffPath,
}

/// What has happened since power-on; counts wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TapCounters {
    /// Characters from the sender.
    pub from_sender: u32,
    /// Characters from the control.
    pub from_control: u32,
    /// DC3 (XOFF) of the control.
    pub stops: u32,
    /// Blocks read.
    pub blocks: u32,
    /// Segments handed out.
    pub segments: u32,
    /// Of those, with a cut rule.
    pub governed: u32,
    /// Programs begun.
    pub programs: u32,
    /// Of those, while another was not over.
    pub restarts: u32,
    /// Times the tap was lost.
    pub losses: u32,
    /// Blocks that came while it was lost.
    pub passed_over: u32,
}
