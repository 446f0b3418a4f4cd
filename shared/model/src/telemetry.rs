//! State of the machine, reported each millisecond.

use arcfeed_nc::modal::Pose;
use arcfeed_units::{Micros, MmPerMin};

/// State of the machine at one instant: time, position, block, feed and override.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time of the sample.
    pub at: Micros,
    /// Positions of the axes, in the program's coordinates.
    pub position: Pose,
    /// Number of executed blocks, including the one in execution; 0 before the first.
    pub block: u32,
    /// Programmed feed times override, along the path; zero at standstill and on a rapid move.
    pub commanded: MmPerMin,
    /// The override in effect, %.
    pub override_percent: u8,
}
