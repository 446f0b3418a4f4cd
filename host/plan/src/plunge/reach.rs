//! Reach of a tool between two upright walls.
//!
//! ```text
//! tilt_max = atan2(W - x, H - y) - asin(R / hypot(W - x, H - y))             towards the wall at x = W              (1)
//! ```
//!
//! and mirrored towards the wall at x = 0. The tool is a capsule: a cylinder of radius R whose end's centre stands at (x, y), with a round end. It
//! touches the upper edge of a wall first, if that is farther than R. Our own; the source names the accessibility without a formula.

/// Slot between upright walls at x = 0 and x = `width_mm`, from y = 0 to `height_mm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UprightSlot {
    /// W
    pub width_mm: f64,
    /// H
    pub height_mm: f64,
}

impl UprightSlot {
    /// Tilts of the tool's axis between which it touches no wall, from y towards x. `None` if its end touches already.
    pub fn tilts_rad(&self, radius_mm: f64, [x_mm, y_mm]: [f64; 2]) -> Option<[f64; 2]> {
        let up_mm = self.height_mm - y_mm;
        let up_to = |beside_mm: f64| {
            let reach_mm = libm::hypot(beside_mm, up_mm);
            (beside_mm >= radius_mm && up_mm >= 0.0)
                .then(|| libm::atan2(beside_mm, up_mm) - libm::asin(radius_mm / reach_mm)) // (1)
        };
        Some([-up_to(x_mm)?, up_to(self.width_mm - x_mm)?])
    }
}
