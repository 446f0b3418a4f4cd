//! A workpiece that gives way: its modes as seen from where the tool is nearest to it.
//!
//! The place is that of the body nearest to the tool's axis, half-way up that part of the edges which is beside it: where a tool beside a
//! wall makes its surface. All edges see the workpiece from there.
//!
//! Source: own; the modes: [`crate::flexible`].

use std::sync::Arc;

use arcfeed_shared::kinematics::vector::{Vector, scaled, sum};
use nalgebra::Vector3;

use crate::dynamics::modal::Mode;
use crate::fe::field::Field;
use crate::fe::slab::Slab;
use crate::flexible::{SeenError, Workpiece};

/// The body and its modes.
#[derive(Clone, Debug)]
pub struct Giving {
    slab: Slab,
    seen: Workpiece<Arc<Field>>,
    /// How far up from its tip the tool has edges.
    edges_mm: f64,
}

impl Giving {
    /// A slab with its modes, and how far up from its tip the tool that cuts it has edges.
    pub fn new(slab: Slab, field: Arc<Field>, edges_mm: f64) -> Self {
        Giving { slab, seen: Workpiece::new(field), edges_mm }
    }

    /// How many modes it has.
    pub fn count(&self) -> usize {
        self.seen.count()
    }

    /// Its modes as seen from its middle, all with the same damping.
    ///
    /// # Errors
    /// The damping is none.
    pub fn modes(&mut self, damping_ratio: f64) -> Result<Vec<Mode>, SeenError> {
        let middle = scaled(sum(self.slab.lowest_mm, self.slab.highest_mm), 0.5);
        self.seen.modes(middle, damping_ratio)
    }

    /// What the modes do under a tool with its tip here, 1/sqrt(kg).
    pub fn shapes(&mut self, tip_mm: &Vector) -> &[Vector3<f64>] {
        let (low_mm, high_mm) = (self.slab.lowest_mm[2], self.slab.highest_mm[2]);
        let [from_mm, to_mm] = [tip_mm[2], tip_mm[2] + self.edges_mm].map(|at_mm| at_mm.clamp(low_mm, high_mm));
        let beside = [tip_mm[0], tip_mm[1], (from_mm + to_mm) / 2.0];
        // A point of the slab is within its mesh.
        self.seen.shapes(self.slab.nearest_mm(&beside)).unwrap_or_default()
    }
}
