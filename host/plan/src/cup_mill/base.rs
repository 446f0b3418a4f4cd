//! Base position (Petean, section 3.3.2): the outer circle passes through the pressure side's limit line, the inner one
//! through the suction side's.
//!
//! ```text
//! cos(alpha) = (R^2 + a^2 - r^2) / (2 R a),  a = |AB|                        (5)
//! C = A + R (e cos(alpha) +- n sin(alpha)),  e = (B - A) / a, n square to it
//! ```
//!
//! Among the two centres, the one with the suction side within the ring applies. The source's limit lines, LN3 and LN4,
//! go through the ends of the tip curves. That is right for the whole depth only if neither side leans over them. So the
//! lines begin there, and the point with the deepest cut of the ring replaces its side's line, until there is no such
//! point.

use crate::cutter::CupMill;
use crate::parallel;
use crate::search::Minimum;
use crate::vector::{Flat, Point};

use super::patch::Patch;

/// Base position: position of the ring in which its outer circle touches one blade of the slot and its inner circle the other one.
/// Points are in the slot frame (z along the tool's axis), seen along the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Base {
    /// Contact A of the outer circle, at the pressure side.
    pub exterior: Flat,
    /// Contact B of the inner circle, at the suction side.
    pub interior: Flat,
    /// Centre C of the ring.
    pub centre: Flat,
    /// Angle alpha at A, between the directions to B and to C.
    pub alpha_rad: f64,
}

/// Largest depth of a side within the ring, against rounding, mm.
const WITHIN_MM: f64 = 1e-6;
/// Most exchanges of limit lines.
const EXCHANGES_MAX: usize = 60;

/// Base position of a ring with these outer and inner radii, through the contacts `exterior` and `interior`; `inside` is in its hollow.
///
/// `None` if no triangle has these sides: the limit lines are nearer than the ring is wide, or farther than it reaches.
pub fn triangle(exterior: Flat, interior: Flat, radii_mm: [f64; 2], inside: Flat) -> Option<Base> {
    let [outer_mm, inner_mm] = radii_mm;
    let a_mm = (interior - exterior).norm();
    let cos = (outer_mm * outer_mm + a_mm * a_mm - inner_mm * inner_mm) / (2.0 * outer_mm * a_mm); // (5)
    if !(-1.0..=1.0).contains(&cos) {
        return None;
    }
    let along = (interior - exterior) / a_mm;
    let square = nalgebra::Vector2::new(-along.y, along.x);
    let alpha_rad = libm::acos(cos);
    let sin = libm::sin(alpha_rad);
    let centres = [1.0, -1.0].map(|side| exterior + (along * cos + square * (side * sin)) * outer_mm);
    let centre = centres.into_iter().min_by(|a, b| (a - inside).norm().total_cmp(&(b - inside).norm()))?;
    Some(Base { exterior, interior, centre, alpha_rad })
}

/// Surfaces between which the ring must lie at the base position.
pub struct Limits<'p> {
    /// Surfaces outside the ring: the pressure side, or the whole blade to which it belongs.
    pub outside: Vec<&'p Patch>,
    /// Surfaces in the ring's hollow: the suction side, or the whole blade to which it belongs.
    pub inside: Vec<&'p Patch>,
    /// A point in the ring's hollow, seen along the tool.
    pub hollow: Flat,
}

/// Least value over several surfaces, and its point.
fn least(patches: &[&Patch], f: impl Fn(&Point) -> f64 + Copy) -> Option<(f64, Flat)> {
    let each = patches.iter().filter_map(|patch| patch.least(f).map(|least| (*patch, least)));
    let (patch, Minimum { at: [u, v], value }) = each.min_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
    Some((value, patch.point(u, v).xy()))
}

/// Base position in which the ring touches the surfaces of both limits without cutting into them; the search begins with contacts at
/// `lines`, the points PT1 and PT3 of the source.
///
/// `None` if no position keeps clear of all surfaces.
pub fn settle(limits: &Limits<'_>, cutter: &CupMill, lines: [Flat; 2]) -> Option<Base> {
    let radii_mm = [cutter.outer_radius_mm, cutter.inner_radius_mm];
    let [mut exterior, mut interior] = lines;
    for _ in 0..EXCHANGES_MAX {
        let base = triangle(exterior, interior, radii_mm, limits.hollow)?;
        let off = |place: Flat| (place - base.centre).norm();
        let (outer, inner) = parallel::join(
            || least(&limits.outside, |p| off(p.xy()) - radii_mm[0]),
            || least(&limits.inside, |p| radii_mm[1] - off(p.xy())),
        );
        let (outer, inner) = (outer?, inner?);
        if outer.0 >= -WITHIN_MM && inner.0 >= -WITHIN_MM {
            return Some(base);
        }
        // One at a time: if both are exchanged, each may undo the other.
        if outer.0 < inner.0 {
            exterior = outer.1;
        } else {
            interior = inner.1;
        }
    }
    None
}
