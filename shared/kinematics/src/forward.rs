//! Forward kinematics: pose of the tool from the positions of the axes, and linear positions for given rotary ones.
//!
//! With T_i(v) the turn of v by the position q_i about axis i (through its point), h the tip as the head holds it, L the
//! positions of X, Y, Z and p0 the part's zero point in the machine frame, both axes of the table, one or none applied:
//!
//! ```text
//! h   = T_0 T_1 (-l t0)                  axes of the head            (1)
//! tip = T_0 T_1 (L + h) - p0             axes of the table           (2)
//! t   = R_0 R_1 t0                       all axes                    (3)
//! L   = T_1^-1 T_0^-1 (tip + p0) - h                                 (4)
//! ```
//!
//! Source: the chain itself; for A/C tables (3) is Tournier eq. 1.

use super::machine::{Carries, Machine, RotaryAxis};
use super::vector::{Vector, difference, scaled, sum, turned};

/// Position and direction of the tool in the part's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolPose {
    /// Position of the tool tip.
    pub tip_mm: Vector,
    /// (i, j, k): unit vector from the tip to the holder.
    pub axis: Vector,
}

/// Positions of all five axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// X, Y, Z: position of the gauge point (reference point of the spindle) in the machine frame.
    pub linear_mm: Vector,
    /// Positions of the rotary axes, in the order from the part to the tool.
    pub rotary_deg: [f64; 2],
}

/// Position of the part on the machine, and the tool's length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setup {
    /// Position of the part's zero point in the machine frame when all axes are at zero.
    pub part_zero_mm: Vector,
    /// Distance from the gauge point (reference point of the spindle) to the tip.
    pub tool_length_mm: f64,
}

impl Machine {
    /// Pose of the tool in the part's frame that these positions of the axes give. (2), (3)
    pub fn forward(&self, axes: &Axes, setup: &Setup) -> ToolPose {
        let held = sum(axes.linear_mm, self.held(axes.rotary_deg, setup));
        let on_table = self.through(Carries::Part, axes.rotary_deg, held);
        ToolPose { tip_mm: difference(on_table, setup.part_zero_mm), axis: self.axis_at(axes.rotary_deg) }
    }

    /// Unit vector from the tip to the holder, in the part's frame, at these positions of the rotary axes. (3)
    pub fn axis_at(&self, rotary_deg: [f64; 2]) -> Vector {
        let [first, second] = self.rotary();
        turned(turned(self.tool(), second.direction, rotary_deg[1]), first.direction, rotary_deg[0])
    }

    /// Positions of X, Y, Z that put the tip to this place of the part's frame while the rotary axes stand at these
    /// positions. (4)
    pub fn linear_for(&self, tip_mm: Vector, rotary_deg: [f64; 2], setup: &Setup) -> Vector {
        let [first, second] = self.rotary();
        let mut point = sum(tip_mm, setup.part_zero_mm);
        for (axis, position_deg) in [(first, rotary_deg[0]), (second, rotary_deg[1])] {
            if axis.carries == Carries::Part {
                point = turned_about(point, axis, -position_deg);
            }
        }
        difference(point, self.held(rotary_deg, setup))
    }

    /// The tip as the head holds it. (1)
    fn held(&self, rotary_deg: [f64; 2], setup: &Setup) -> Vector {
        self.through(Carries::Tool, rotary_deg, scaled(self.tool(), -setup.tool_length_mm))
    }

    /// Applies the axes of one side to a point, the one next to the tool first.
    fn through(&self, side: Carries, rotary_deg: [f64; 2], point_mm: Vector) -> Vector {
        let [first, second] = self.rotary();
        let mut point = point_mm;
        for (axis, position_deg) in [(second, rotary_deg[1]), (first, rotary_deg[0])] {
            if axis.carries == side {
                point = turned_about(point, axis, position_deg);
            }
        }
        point
    }
}

fn turned_about(point_mm: Vector, axis: &RotaryAxis, by_deg: f64) -> Vector {
    sum(axis.point_mm, turned(difference(point_mm, axis.point_mm), axis.direction, by_deg))
}
