//! What the machine reports, once a millisecond.

use crate::nc::modal::Pose;
use crate::units::{Micros, MmPerMin};

/// One report of the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When.
    pub at: Micros,
    /// Where the axes are.
    pub position: Pose,
    /// Count of executed blocks up to and including the one being executed; 0 before the first.
    pub block: u32,
    /// Programmed feed times override; zero while nothing moves or at rapid.
    pub commanded: MmPerMin,
    /// The override in effect, %.
    pub override_percent: u8,
}
