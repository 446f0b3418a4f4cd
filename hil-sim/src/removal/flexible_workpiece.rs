//! A workpiece that bends under the cutting force: its modes at the edges and at the tool.
//!
//! The modes act on each edge at its own position. Chatter detection uses one point for the whole tool, where the tool
//! forms the surface beside a wall: the point of the body nearest to the tool's axis, half-way up the part of the edges
//! that is beside the body.
//!
//! Source: own; the modes: [`arcfeed_modal::flexible`].

use std::sync::Arc;

use arcfeed_kinematics::vector::Vector;
use nalgebra::Vector3;

use arcfeed_modal::flexible::{Modal, Workpiece};

/// Workpiece that bends under the cutting force, with its modes.
#[derive(Clone, Debug)]
pub struct FlexibleWorkpiece {
    workpiece: Workpiece<Arc<dyn Modal>>,
    bounds_mm: [Vector; 2],
    /// Height of the tool's edges above its tip.
    edges_mm: f64,
}

impl FlexibleWorkpiece {
    /// Workpiece within `bounds_mm` with the modes of `body`; `edges_mm` is the height above the tool's tip up to which the tool has edges.
    pub fn new(body: Arc<dyn Modal>, bounds_mm: [Vector; 2], edges_mm: f64) -> Self {
        FlexibleWorkpiece { workpiece: Workpiece::new(body), bounds_mm, edges_mm }
    }

    /// Number of modes of the workpiece.
    pub fn count(&self) -> usize {
        self.workpiece.count()
    }

    /// Mode shapes, 1/sqrt(kg), at the point of the workpiece that represents the whole tool, with its tip at this position.
    pub fn shapes(&mut self, tip_mm: &Vector) -> &[Vector3<f64>] {
        let [low_mm, high_mm] = self.bounds_mm.map(|corner_mm| corner_mm[2]);
        let [from_mm, to_mm] = [tip_mm[2], tip_mm[2] + self.edges_mm].map(|at_mm| at_mm.clamp(low_mm, high_mm));
        self.workpiece.shapes_on([tip_mm[0], tip_mm[1], (from_mm + to_mm) / 2.0])
    }

    /// The same workpiece, for mode shapes at each edge.
    pub fn workpiece_mut(&mut self) -> &mut Workpiece<Arc<dyn Modal>> {
        &mut self.workpiece
    }
}
