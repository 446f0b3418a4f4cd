//! Chip thickness of a tooth on its trochoid, by root finding: an oracle for chips measured otherwise. Needs nothing but `libm`.
//!
//! The centre moves along x by `c` a radian, teeth turn clockwise from y: p(a) = (c a + R sin a, R cos a), c = z fz / 2 pi. The
//! tooth before passed the same place by fz further back. On the ray from the present centre through the present edge its path lies
//! where, with d its angle less the present one,
//!
//! ```text
//! R sin d + (c d - fz) cos a = 0           (1)
//! h = R (1 - cos d) - (c d - fz) sin a     (2)
//! ```

/// A cutter that feeds straight on.
#[derive(Clone, Copy, Debug)]
pub struct Trochoid {
    pub radius_mm: f64,
    pub teeth: usize,
    pub feed_mm_per_tooth: f64,
}

impl Trochoid {
    /// Thickness that the tooth before left along the ray at this angle from y, clockwise. (2)
    pub fn chip_mm(&self, angle_rad: f64) -> f64 {
        let (sin, cos) = libm::sincos(angle_rad);
        let behind_mm = |d: f64| self.advance_mm() * d - self.feed_mm_per_tooth;
        let d = root(|d| self.radius_mm * libm::sin(d) + behind_mm(d) * cos); // (1)
        let half = libm::sin(d / 2.0);
        2.0 * self.radius_mm * half * half - behind_mm(d) * sin
    }

    /// Motion of the centre per radian.
    pub fn advance_mm(&self) -> f64 {
        self.teeth as f64 * self.feed_mm_per_tooth / std::f64::consts::TAU
    }
}

/// The root within half a turn: for feeds below the radius there is one, where `f` rises through zero.
fn root(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (-1.0, 1.0);
    assert!(f(low) < 0.0 && f(high) > 0.0);
    for _ in 0..80 {
        let middle = (low + high) / 2.0;
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
    (low + high) / 2.0
}
