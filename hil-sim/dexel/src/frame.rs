//! Frame of coordinates in which a workpiece is described: that of the workpiece itself, or of a tilted tool.

use arcfeed_kinematics::vector::{Vector, dot};

/// Right-handed frame of coordinates with the same origin as the workpiece's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Unit vectors of the frame's x, y and z axes, in the workpiece's own coordinates.
    pub axes: [Vector; 3],
}

impl Frame {
    /// The frame of the workpiece itself.
    pub const OWN: Frame = Frame { axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };

    /// Coordinates, in this frame, of a point or a direction given in the workpiece's own coordinates.
    pub fn coordinates(&self, vector: Vector) -> Vector {
        self.axes.map(|axis| dot(axis, vector))
    }
}
