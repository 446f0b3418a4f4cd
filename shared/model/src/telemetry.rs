//! Reports of the machine, one each millisecond.

use arcfeed_nc::modal::Pose;
use arcfeed_units::{Micros, MmPerMin};

/// One report of the machine: time, position, block, feed, override.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time of the sample.
    pub at: Micros,
    /// Position of the axes.
    pub position: Pose,
    /// Number of executed blocks, including the one in execution; 0 before the first.
    pub block: u32,
    /// Programmed feed times override; zero at standstill and at rapid.
    pub commanded: MmPerMin,
    /// The override in effect, %.
    pub override_percent: u8,
}
