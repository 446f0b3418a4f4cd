//! A workpiece that gives way: its modes as a tool in it sees them.
//!
//! Each edge sees them where it is. The tool as a whole, of which it is told whether it vibrates, is where its surface is made beside a wall: at the
//! place of the body nearest to its axis, half-way up that part of the edges which is beside the body.
//!
//! Source: own; the modes: [`crate::flexible`].

use std::sync::Arc;

use arcfeed_shared::kinematics::vector::Vector;
use nalgebra::Vector3;

use crate::fe::field::Field;
use crate::flexible::Workpiece;

/// The body and its modes.
#[derive(Clone, Debug)]
pub struct FlexibleWorkpiece {
    seen: Workpiece<Arc<Field>>,
    bounds_mm: [Vector; 2],
    /// How far up from its tip the tool has edges.
    edges_mm: f64,
}

impl FlexibleWorkpiece {
    /// A body with its modes, and how far up from its tip the tool that cuts it has edges.
    pub fn new(field: Arc<Field>, edges_mm: f64) -> Self {
        FlexibleWorkpiece { bounds_mm: field.mesh().bounds_mm(), seen: Workpiece::new(field), edges_mm }
    }

    /// How many modes it has.
    pub fn count(&self) -> usize {
        self.seen.count()
    }

    /// What the modes do under a tool with its tip here, 1/sqrt(kg).
    pub fn shapes(&mut self, tip_mm: &Vector) -> &[Vector3<f64>] {
        let [low_mm, high_mm] = self.bounds_mm.map(|corner_mm| corner_mm[2]);
        let [from_mm, to_mm] = [tip_mm[2], tip_mm[2] + self.edges_mm].map(|at_mm| at_mm.clamp(low_mm, high_mm));
        self.seen.shapes_on([tip_mm[0], tip_mm[1], (from_mm + to_mm) / 2.0])
    }

    /// The workpiece as each edge sees it.
    pub fn seen(&mut self) -> &mut Workpiece<Arc<Field>> {
        &mut self.seen
    }
}
