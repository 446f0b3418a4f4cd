//! Columns of plunges between the boundary axes of a plane.
//!
//! ```text
//! m >= w_roof / s_x,   s_x <= min(a_e, R - r_k)                                            (1)
//! M_j = T1 + (j/m) (T2 - T1),  N_j = T3 + (j/m) (T4 - T3),  t_j = unit(M_j - N_j)         (2)
//! no pillars between aligned rows s_z apart:  s_x^2 + s_z^2 <= 4 R^2                      (3)
//! ```
//!
//! with the greatest width a_e of a cut and the radius r_k of the core that does not cut: beside one plunge the core lies in its hole if the axes are no
//! farther apart than R - r_k. A passage is widest at the roof, so (1) and (3) hold below it, too. Each segment lies between both boundary axes, so it
//! keeps their distance from the blades.
//!
//! Source: An Luling et al. for (2); (1) and (3) are ours.

use crate::vector::{Flat, Point, Vector};

use super::mill::PlungeMill;
use super::section::PlungeSection;

/// Column: axis of one plunge in a plane, in the rotor's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Point M of the axis near the roof (surface of the blank).
    pub roof: Point,
    /// Point N of the axis near the floor (hub with its allowance).
    pub floor: Point,
    /// Unit vector t from the floor to the roof.
    pub axis: Vector,
    /// Position j/m between the left boundary axis (0) and the right one (1).
    pub share: f64,
}

/// Largest distance of neighbouring columns (1), (3), mm. `None` if rows are too far apart for the tool, or nothing may be cut.
pub fn spacing_max_mm(mill: &PlungeMill, row_mm: f64) -> Option<f64> {
    let square = 4.0 * mill.radius_mm * mill.radius_mm - row_mm * row_mm;
    let most_mm = mill.width_max_mm.min(mill.radius_mm - mill.core_radius_mm);
    (square > 0.0 && most_mm > 0.0).then(|| most_mm.min(libm::sqrt(square)))
}

/// Columns of a plane from the left to the right, no farther apart than `spacing_mm` at the roof.
pub fn columns(PlungeSection { plane, boundary }: &PlungeSection, spacing_mm: f64) -> Vec<Column> {
    let pieces = pieces(boundary.widths_mm(), spacing_mm);
    let at = |[left, right]: &[Flat; 2], share: f64| plane.point(&(left + (right - left) * share));
    let shares = (0..=pieces).map(|j| if pieces == 0 { 0.5 } else { f64::from(j) / f64::from(pieces) });
    let column = |share: f64| {
        let (roof, floor) = (at(&boundary.roof, share), at(&boundary.floor, share));
        Column { roof, floor, axis: (roof - floor).normalize(), share }
    };
    shares.map(column).collect()
}

/// m: 0 if both boundary axes coincide.
fn pieces([roof_mm, floor_mm]: [f64; 2], spacing_mm: f64) -> u32 {
    // Rounding must not add a column.
    libm::ceil(roof_mm.max(floor_mm) / spacing_mm - 1e-9).max(0.0) as u32
}
