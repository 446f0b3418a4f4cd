//! Section of plunges: area of a union of discs.
//!
//! ```text
//! area = 1/2 closed integral (x dy - y dx) = sum r/2 (r (b - a) + x (sin b - sin a) - y (cos b - cos a))       (1)
//! ```
//!
//! over the arcs a..b of each circle that lie in no other disc: Green's theorem, exact.

use core::f64::consts::TAU;

use crate::vector::Flat;

/// Disc that a plunge cuts, seen along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Centre.
    pub centre: Flat,
    /// Radius, mm.
    pub radius_mm: f64,
}

/// Area of the union of discs, mm2.
pub fn union_mm2(discs: &[Disc]) -> f64 {
    discs
        .iter()
        .enumerate()
        .map(|(index, disc)| free_arcs(index, discs).map(|arc| under_mm2(disc, arc)).sum::<f64>())
        .sum()
}

/// Area that the last disc adds to the union of all others, mm2.
pub fn engaged_mm2(discs: &[Disc]) -> f64 {
    let before = discs.split_last().map_or(discs, |(_, before)| before);
    union_mm2(discs) - union_mm2(before)
}

/// Term of (1).
fn under_mm2(disc: &Disc, [from, to]: [f64; 2]) -> f64 {
    let Disc { centre, radius_mm } = disc;
    let ((sin_from, cos_from), (sin_to, cos_to)) = (libm::sincos(from), libm::sincos(to));
    radius_mm / 2.0 * (radius_mm * (to - from) + centre.x * (sin_to - sin_from) - centre.y * (cos_to - cos_from)) // (1)
}

/// Arcs of a disc's circle outside of all others; of equal discs only the first has any.
fn free_arcs(index: usize, discs: &[Disc]) -> impl Iterator<Item = [f64; 2]> {
    let disc = &discs[index];
    let mut covered: Vec<[f64; 2]> = Vec::new();
    for (number, other) in discs.iter().enumerate().filter(|(number, _)| *number != index) {
        let way = other.centre - disc.centre;
        let apart_mm = way.norm();
        let is_inside = apart_mm + disc.radius_mm <= other.radius_mm;
        let is_equal = apart_mm == 0.0 && disc.radius_mm == other.radius_mm;
        if is_inside && (!is_equal || number < index) {
            covered.push([0.0, TAU]);
        } else if !is_inside
            && apart_mm < disc.radius_mm + other.radius_mm
            && apart_mm + other.radius_mm > disc.radius_mm
        {
            let cos = (apart_mm * apart_mm + disc.radius_mm * disc.radius_mm - other.radius_mm * other.radius_mm)
                / (2.0 * apart_mm * disc.radius_mm);
            let (middle, half) = (libm::atan2(way.y, way.x), libm::acos(cos.clamp(-1.0, 1.0)));
            let from = (middle - half).rem_euclid(TAU);
            let to = from + 2.0 * half;
            covered.extend([[from, to.min(TAU)], [0.0, to - TAU]].into_iter().filter(|[from, to]| to > from));
        }
    }
    covered.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut reached = 0.0_f64;
    let mut free = Vec::new();
    for [from, to] in covered.into_iter().chain([[TAU, TAU]]) {
        if from > reached {
            free.push([reached, from]);
        }
        reached = reached.max(to);
    }
    free.into_iter()
}
