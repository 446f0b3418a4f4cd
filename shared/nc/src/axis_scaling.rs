//! G51 and G51.1: coordinates scaled about a point, axis by axis, or mirrored.
//!
//! Each axis of the program goes to
//!
//! ```text
//! p' = c + m (p - c),    m in thousandths, negative: mirrored     (1)
//! ```
//!
//! before the rotation of G68 and the shift of the offsets. Results are rounded to nanometres. An arc remains an arc
//! if the axes of its plane have the same |m|; mirroring in one of them reverses its sense. Source: B-63534EN,
//! programmable mirror image, scaling.

use super::motion::Plane;
use arcfeed_units::Nm;

/// Magnification 1 (unchanged size), in thousandths.
pub const WHOLE: i32 = 1_000;

/// Scaling (G51) or mirror image (G51.1) in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisScaling {
    /// G code that set it, in tenths: 510 for G51, 511 for G51.1.
    pub code: u16,
    /// Point that keeps its place, in program coordinates of X, Y, Z.
    pub center: [Nm; 3],
    /// Magnifications of X, Y, Z in thousandths; negative: mirrored.
    pub thousandths: [i32; 3],
}

impl AxisScaling {
    /// Scales a point (X, Y, Z of the program) in place. A rotation by G68 and the offsets apply after this.
    pub fn apply(&self, axes: &mut [Nm; 3]) {
        for (axis, (center, by)) in axes.iter_mut().zip(self.center.iter().zip(self.thousandths)) {
            *axis = scaled_coordinate(*axis, *center, by, WHOLE); // (1)
        }
    }

    /// Reverses [`Self::apply`], up to rounding.
    pub fn undo(&self, axes: &mut [Nm; 3]) {
        for (axis, (center, by)) in axes.iter_mut().zip(self.center.iter().zip(self.thousandths)) {
            *axis = scaled_coordinate(*axis, *center, WHOLE, by);
        }
    }

    /// Scales a vector of the program, such as I, J, K, in place; the centre has no effect on it.
    pub fn vector(&self, axes: &mut [Nm; 3]) {
        AxisScaling { center: [Nm(0); 3], ..*self }.apply(axes);
    }

    /// Magnification of an arc's radius in this plane, in thousandths, and whether the arc's sense is reversed. `None`
    /// if the magnifications of the plane's axes differ, so that the result is not an arc.
    pub fn of_arc(&self, plane: Plane) -> Option<(i32, bool)> {
        let (first, second, _) = plane.axes();
        let (a, b) = (*self.thousandths.get(first)?, *self.thousandths.get(second)?);
        (a.abs() == b.abs()).then_some((a.abs(), (a < 0) != (b < 0)))
    }

    /// Whether an axis (0 for X to 2 for Z) is scaled or mirrored.
    pub fn is_along(&self, axis: usize) -> bool {
        self.thousandths.get(axis).is_some_and(|by| *by != WHOLE)
    }
}

/// Coordinate of a point on one axis, scaled by the factor `by / over` about a centre. (1)
pub fn scaled_coordinate(Nm(point): Nm, Nm(center): Nm, by: i32, over: i32) -> Nm {
    let (by, over) = (i64::from(by), i64::from(over));
    let part = point.saturating_sub(center).saturating_mul(by);
    let half = over.saturating_abs() / 2 * part.signum();
    Nm(center.saturating_add(part.saturating_add(half).checked_div(over).unwrap_or(0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_within_half_an_original_nanometre_whatever_the_signs() {
        for by in [-3_000, -1_000, -333, 1, 333, 999_999] {
            let scaling = AxisScaling { code: 510, center: [Nm(7); 3], thousandths: [by; 3] };
            for nm in [-1_000_001, -1, 0, 7, 8, 123_456_789] {
                let mut axes = [Nm(nm); 3];
                scaling.apply(&mut axes);
                let exact = 7.0 + (nm - 7) as f64 * by as f64 / 1e3;
                assert!((axes[0].0 as f64 - exact).abs() <= 0.5, "{nm} by {by}: {axes:?}");
                scaling.undo(&mut axes);
                assert!((axes[0].0 - nm).abs() as f64 <= 0.5 + 500.0 / by.abs() as f64, "{nm} by {by}: {axes:?}");
            }
        }
    }
}
