//! Slab: part of a solid of revolution between two heights, whose walls are straight lines in the plane of radius and height.
//!
//! ```text
//! volume:  pi/3 H (R0^2 + R0 R1 + R1^2 - r0^2 - r0 r1 - r1^2)        (1)
//! ```
//!
//! Source: (1) the frustum of a cone.

use std::f64::consts::PI;

/// Part of a solid of revolution (such as a tool) between two heights; its outside and its hole are cones or cylinders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// The two heights above the tool's tip, the lower one first.
    pub heights_mm: [f64; 2],
    /// Radii of the outside at these two heights.
    pub outer_mm: [f64; 2],
    /// Radii of the hole at these two heights; `None` without a hole.
    pub inner_mm: Option<[f64; 2]>,
}

impl Slab {
    /// Volume, mm3, without the hole. (1)
    pub fn volume_mm3(&self) -> f64 {
        let squares = |[a, b]: [f64; 2]| a * a + a * b + b * b;
        let height_mm = self.heights_mm[1] - self.heights_mm[0];
        PI / 3.0 * height_mm * (squares(self.outer_mm) - self.inner_mm.map_or(0.0, squares))
    }
}
