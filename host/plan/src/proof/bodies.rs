//! Obstacles of the tool as triangles, with all corners on the surfaces.

use core::f64::consts::TAU;

use crate::geometry::blisk::{Blank, Blisk, Revolution};
use crate::geometry::mesh::{self, Sector, Triangle};
use crate::vector::Point;

/// Triangles of the blades of a rotor's first pitch as solids whose feet are inside the hub, in the rotor's own frame.
pub fn blades(blisk: &Blisk, chord_mm: f64) -> Vec<Triangle> {
    (0..blisk.kinds()).flat_map(|index| mesh::blade(&blisk.blade(index), chord_mm, chord_mm)).collect()
}

/// Triangles of the solid below a surface of revolution, between two planes across its axis.
pub fn revolved(surface: &Revolution, faces_mm: [f64; 2], chord_mm: f64) -> Vec<Triangle> {
    mesh::revolved(surface, &Sector { angles_rad: [0.0, TAU], faces_mm, inner_radius_mm: 0.0 }, chord_mm)
}

/// Triangles of the part of the blank below the gas path, in the rotor's own frame.
pub fn hub(blisk: &Blisk, chord_mm: f64) -> Vec<Triangle> {
    revolved(&blisk.hub, blisk.blank.faces_mm, chord_mm)
}

/// Triangles of the blank as a solid, in the rotor's own frame.
pub fn blank(blank: &Blank, chord_mm: f64) -> Vec<Triangle> {
    let side = Revolution { profile_mm: blank.faces_mm.map(|z| [z, blank.radius_mm]).to_vec() };
    revolved(&side, blank.faces_mm, chord_mm)
}

/// Triangles of a box between two opposite corners, with edges along the axes.
pub fn cuboid(corners: &[Point; 2]) -> Vec<Triangle> {
    let corner = |k: usize| Point::new(corners[k & 1].x, corners[k >> 1 & 1].y, corners[k >> 2].z);
    let sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    sides.iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]].map(|side| side.map(|k| corner(*k)))).collect()
}
