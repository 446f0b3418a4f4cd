//! Positions of the edges of a cutter at one time, before deflections.

use nalgebra::Vector2;

use super::edge_element::EdgeElement;
use super::edges::EdgePiece;
use super::end::{Descent, EdgePose};
use super::partial_heights::DepthBand;

/// Position of the cutter in the coordinates of the workpiece's layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolPose {
    /// Position of the spindle's axis in the plane of the layers.
    pub axis_mm: Vector2<f64>,
    /// Height of the tool's tip, in the height coordinate of the layers.
    pub tip_mm: f64,
    /// Angle by which M3 has turned the spindle.
    pub turned_rad: f64,
}

/// Positions of all edges of a cutter at one time, before deflection.
#[derive(Clone, Debug)]
pub struct EdgePoses {
    pub(super) pose: ToolPose,
    pub(super) descent: Descent,
    /// For each edge, the unit vector from the spindle's axis to it.
    pub(super) towards: Vec<Vector2<f64>>,
    /// Layers of the slices of the cutter.
    pub(super) placed: Vec<Option<Placed>>,
    /// For each edge, whether no material is near it.
    pub(super) is_apart: Vec<bool>,
}

/// A slice of the cutter in its layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// Index in the list of layers.
    pub(super) index: usize,
    pub(super) depth_band: DepthBand,
    /// Fraction of the layer up to which edges are evaluated.
    pub(super) reach_ratio: f64,
}

impl EdgePoses {
    /// Marks an edge, by its number, as far from material: it gets no chip and removes nothing at these positions.
    pub fn set_apart(&mut self, edge: usize) {
        self.is_apart[edge] = true;
    }

    /// An edge, bent.
    pub(super) fn edge_pose(&self, edge: usize, bent_mm: Vector2<f64>) -> EdgePose {
        EdgePose { center_mm: self.pose.axis_mm + bent_mm, towards: self.towards[edge] }
    }
}

/// Direction from the spindle's axis to a piece.
pub(super) fn towards(piece: &EdgePiece, pose: &ToolPose) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(piece.angle_at_rad(pose.turned_rad));
    Vector2::new(cos, sin)
}

/// A piece as an elementary edge in its layer.
pub(super) fn element(piece: &EdgePiece, depth_mm: f64, edge_pose: EdgePose, depth_band: &DepthBand) -> EdgeElement {
    let EdgePose { center_mm, towards } = edge_pose;
    let (radius_mm, side) = (piece.radius_mm, piece.side);
    EdgeElement { center_mm, towards, radius_mm, side, turn_ratio: -1.0, depth_mm, depth_band: *depth_band }
}
