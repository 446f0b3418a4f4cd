//! A part of a solid of revolution between two heights, with straight walls.
//!
//! ```text
//! volume:  pi/3 H (R0^2 + R0 R1 + R1^2 - r0^2 - r0 r1 - r1^2)        (1)
//! ```
//!
//! Source: (1) the frustum of a cone.

use std::f64::consts::PI;

/// Part of a solid of revolution between two heights, with straight walls outside and in its hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// The heights above the tip, the lower first.
    pub heights_mm: [f64; 2],
    /// Radii of the outside at these heights.
    pub outer_mm: [f64; 2],
    /// Radii of the hole; none if it is solid.
    pub inner_mm: Option<[f64; 2]>,
}

impl Slab {
    /// Volume. (1)
    pub fn volume_mm3(&self) -> f64 {
        let squares = |[a, b]: [f64; 2]| a * a + a * b + b * b;
        let height_mm = self.heights_mm[1] - self.heights_mm[0];
        PI / 3.0 * height_mm * (squares(self.outer_mm) - self.inner_mm.map_or(0.0, squares))
    }
}
