//! Distance of neighbouring plunges beside a wall that leaves cusps of a given height.
//!
//! ```text
//! flat wall     s = 2 sqrt(h (2R - h))                                                                        (1)
//! curved wall   d = rho +- R, q = rho +- h,  th = 2 acos((d^2 + q^2 - R^2) / (2 d q)),
//!               between axes 2 d sin(th / 2), along the wall rho th                                          (2)
//! ```
//!
//! with the tool's radius R, the cusp's height h, and the wall's radius rho square to the tool; the upper sign is for a convex wall, the lower one for a
//! hollow one. Two circles about neighbouring axes meet at the cusp: exact. Our own; the source names the step without a formula.

use crate::geometry::face::Jet;
use crate::vector::Vector;

/// Distances of neighbouring plunges, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepover {
    /// Between their axes, square to them.
    pub axes_mm: f64,
    /// Along the wall.
    pub wall_mm: f64,
    /// Angle between the wall's normals at both.
    pub angle_rad: f64,
}

/// Step beside a wall with a curvature, positive if it is convex. `None` if the cusp does not fit: it is not below the tool's radius, or the
/// hollow is as narrow as the tool.
pub fn stepover(radius_mm: f64, cusp_mm: f64, curvature_per_mm: f64) -> Option<Stepover> {
    if !(cusp_mm > 0.0 && cusp_mm < radius_mm) {
        return None;
    }
    let flat_mm = 2.0 * libm::sqrt(cusp_mm * (2.0 * radius_mm - cusp_mm)); // (1)
    if curvature_per_mm == 0.0 {
        return Some(Stepover { axes_mm: flat_mm, wall_mm: flat_mm, angle_rad: 0.0 });
    }
    // With the sign of the curvature in rho both signs of (2) are one formula.
    let rho_mm = 1.0 / curvature_per_mm;
    let (d_mm, q_mm) = (rho_mm + radius_mm, rho_mm + cusp_mm);
    if d_mm * rho_mm <= 0.0 {
        return None;
    }
    // 1 - cos(th / 2), without the cancellation of a nearly flat wall: d - q is R - h.
    let versine = cusp_mm * (2.0 * radius_mm - cusp_mm) / (2.0 * d_mm * q_mm);
    if !(0.0..=2.0).contains(&versine) {
        return None;
    }
    let angle_rad = 4.0 * libm::asin(libm::sqrt(versine / 2.0)); // (2)
    let axes_mm = 2.0 * d_mm.abs() * libm::sin(angle_rad / 2.0);
    Some(Stepover { axes_mm, wall_mm: rho_mm.abs() * angle_rad, angle_rad })
}

/// Normal curvature of a face in the section square to the tool's axis, positive if convex; `outward` is the face's normal away from the blade.
pub fn curvature_across_per_mm(jet: &Jet, outward: &Vector, tool_axis: &Vector) -> f64 {
    let Some(along) = tool_axis.cross(outward).try_normalize(1e-9) else { return 0.0 };
    let (e, f, g) = (jet.u.norm_squared(), jet.u.dot(&jet.v), jet.v.norm_squared());
    let (by_u, by_v) = (along.dot(&jet.u), along.dot(&jet.v));
    let determinant = e * g - f * f;
    let (a, b) = ((by_u * g - by_v * f) / determinant, (by_v * e - by_u * f) / determinant);
    -(jet.uu * (a * a) + jet.uv * (2.0 * a * b) + jet.vv * (b * b)).dot(outward)
}
