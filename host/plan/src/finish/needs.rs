//! Requirements on finishing passes.

use super::axis::AxisProgram;
use super::passes::{Course, Sampling};
use super::reach::Margins;
use super::rows::Spacing;

/// Requirements on a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishNeeds {
    /// Distances to keep.
    pub margins: Margins,
    /// Distances between points.
    pub sampling: Sampling,
    /// Height of the scallops between passes, mm.
    pub scallop_mm: f64,
    /// Lowest and highest row, as places between hub (0) and tip (1); the lowest row that clears the hub unless given.
    pub span: [Option<f64>; 2],
    /// Spacing of the passes.
    pub spacing: Spacing,
    /// Course of the passes.
    pub course: Course,
    /// Climb milling; otherwise conventional.
    pub is_climb: bool,
    /// Height above the blank at which the mill enters and leaves, mm.
    pub clearance_mm: f64,
    /// Tool axes; `None`: the smoothest admissible course.
    pub axes: Option<AxisProgram>,
    /// Least and greatest angle of that course from the normals.
    pub tilt_rad: [f64; 2],
}
