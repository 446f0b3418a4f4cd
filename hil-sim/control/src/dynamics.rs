//! Limits of the axes along the path.

/// Limits of the axes along the path. Only the rapid rate is published for the machine of the source; the others are
/// assumed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dynamics {
    /// Acceleration along the path.
    pub acceleration_mm_per_s2: f64,
    /// Largest permitted step of an axis's speed at a corner.
    pub corner_jump_mm_per_s: f64,
    /// Speed of rapids (G0) along the path; the X axis of the HU80A-5X has 12 m/min.
    pub rapid_mm_per_s: f64,
}

impl Default for Dynamics {
    fn default() -> Self {
        Dynamics { acceleration_mm_per_s2: 500.0, corner_jump_mm_per_s: 5.0, rapid_mm_per_s: 200.0 }
    }
}
