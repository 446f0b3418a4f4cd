//! Requirements on finishing passes.

use super::axis::AxisProgram;
use super::passes::{Course, Sampling};
use super::reach::Margins;
use super::rows::Spacing;

/// Requirements on a plan for finishing one blade.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishNeeds {
    /// Distances that the mill must keep from obstacles.
    pub margins: Margins,
    /// Largest distances between the points of a pass.
    pub sampling: Sampling,
    /// Height of the scallops that remain between the passes, mm.
    pub scallop_mm: f64,
    /// Lowest and highest row of the passes, as positions between hub (0) and tip (1). If the lowest is `None`, it is the first that
    /// clears the hub.
    pub span: [Option<f64>; 2],
    /// Way in which the spacing of the passes is computed.
    pub spacing: Spacing,
    /// Order of the passes: a spiral, or one side only.
    pub course: Course,
    /// Whether the mill climb mills; otherwise it mills conventionally.
    pub is_climb: bool,
    /// Height above the blank at which the mill enters and leaves, mm.
    pub clearance_mm: f64,
    /// Tool axes along the passes; `None` for the smoothest admissible ones.
    pub axes: Option<AxisProgram>,
    /// Smallest and largest angle of these smoothest axes from the surface's normals.
    pub tilt_rad: [f64; 2],
}
