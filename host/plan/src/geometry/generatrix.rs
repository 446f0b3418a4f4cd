//! Generatrix of a surface of revolution that is given as a mesh: the points of the mesh lie on the surface.

use crate::vector::Vector;

use super::blisk::Revolution;
use super::solid_fault::SolidFault;
use super::surface_mesh::SurfaceMesh;

/// Least radial part of a normal: faces square to the axis and edges do not count.
const RADIAL_MIN: f64 = 0.2;

/// Points nearer than this along the axis stand for one place, mm.
const SAME_PLACE_MM: f64 = 1e-3;

/// Largest difference of radii at one place, mm.
const ROUND_MM: f64 = 0.05;

/// Generatrix of the triangles that `is_part` selects by their normal's radial part and their points. Of a solid, the outer surface.
///
/// # Errors
/// The triangles do not lie on a surface of revolution.
pub(super) fn generatrix(
    mesh: &SurfaceMesh,
    is_part: impl Fn(&[usize; 3], f64) -> bool,
) -> Result<Revolution, SolidFault> {
    let radial = |triangle: &[usize; 3]| {
        let [a, b, c] = mesh.corners(triangle).map(|point| point.coords);
        let out = (a + b + c).xy().try_normalize(0.0).unwrap_or_default();
        let normal: Vector = mesh.area_vector(triangle).try_normalize(0.0).unwrap_or_default();
        normal.xy().dot(&out)
    };
    let mut places: [Vec<[f64; 2]>; 2] = Default::default();
    for triangle in &mesh.triangles {
        let part = radial(triangle);
        if part.abs() > RADIAL_MIN && is_part(triangle, part.abs()) {
            let corners = mesh.corners(triangle).map(|point| [point.z, libm::hypot(point.x, point.y)]);
            places[usize::from(part > 0.0)].extend(corners);
        }
    }
    // A bore looks to the axis; triangles of a surface alone may be in either sense.
    let [inner, outer] = places;
    let mean_mm = |places: &[[f64; 2]]| places.iter().map(|place| place[1]).sum::<f64>() / places.len() as f64;
    let is_inner = outer.is_empty() || (!inner.is_empty() && mean_mm(&inner) > mean_mm(&outer));
    joined(if is_inner { inner } else { outer })
}

/// Generatrix through places `[z, r]`, in any order.
///
/// # Errors
/// Two radii at one place.
pub(super) fn joined(mut places: Vec<[f64; 2]>) -> Result<Revolution, SolidFault> {
    places.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut profile_mm: Vec<[f64; 2]> = Vec::new();
    for group in places.chunk_by(|a, b| b[0] - a[0] < SAME_PLACE_MM) {
        let radii = || group.iter().map(|place| place[1]);
        let (least_mm, most_mm) = (radii().fold(f64::INFINITY, f64::min), radii().fold(0.0, f64::max));
        if most_mm - least_mm > ROUND_MM {
            return Err(SolidFault::NotRound { z_mm: group[0][0], radii_mm: [least_mm, most_mm] });
        }
        let mean = |axis: usize| group.iter().map(|place| place[axis]).sum::<f64>() / group.len() as f64;
        profile_mm.push([mean(0), mean(1)]);
    }
    // Points of another surface between those of the gas path.
    let is_jump = |pair: &&[[f64; 2]]| (pair[1][1] - pair[0][1]).abs() > ROUND_MM + 20.0 * (pair[1][0] - pair[0][0]);
    if let Some(pair) = profile_mm.windows(2).find(is_jump) {
        return Err(SolidFault::NotRound {
            z_mm: pair[0][0],
            radii_mm: [pair[0][1].min(pair[1][1]), pair[0][1].max(pair[1][1])],
        });
    }
    if profile_mm.len() < 2 { Err(SolidFault::NoRevolution) } else { Ok(Revolution { profile_mm }) }
}
