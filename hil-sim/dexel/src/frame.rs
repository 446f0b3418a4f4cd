//! Frame in which a workpiece is seen: the axes of a tilted tool.

use arcfeed_kinematics::vector::{Vector, dot};

/// Right-handed unit vectors of a frame about the same origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Directions of x, y and z.
    pub axes: [Vector; 3],
}

impl Frame {
    /// The frame of the workpiece itself.
    pub const OWN: Frame = Frame { axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };

    /// Coordinates of a point or a direction in the frame.
    pub fn coordinates(&self, vector: Vector) -> Vector {
        self.axes.map(|axis| dot(axis, vector))
    }
}
