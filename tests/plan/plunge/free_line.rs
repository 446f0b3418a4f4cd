//! Largest mill of a plane by search, without offset curves and supporting lines: of all straight axes in the plane that which stays
//! farthest from dense samples of both blades.

use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::vector::Point;

/// Distance of places along an axis, mm.
const ALONG_MM: f64 = 1.5;
/// Distance from the plane within which samples count, mm.
const NEAR_MM: f64 = 25.0;
/// First and last step of the search: along x, mm, and of the slope over the whole depth, mm.
const STEPS_MM: [f64; 2] = [2.0, 0.004];

/// Greatest radius with its allowance of a straight axis in the plane at `z_mm`, between two radii about the rotor's axis and near an
/// angle.
pub fn widest_mm(blisk: &Blisk, z_mm: f64, [floor_mm, roof_mm]: [f64; 2], middle_rad: f64) -> f64 {
    let samples = samples(blisk, z_mm);
    let (sin, cos) = libm::sincos(middle_rad);
    let least_mm = |[foot, head]: [f64; 2]| {
        let places = libm::ceil((roof_mm - floor_mm) / ALONG_MM) as usize;
        let place = |k: usize| {
            let share = k as f64 / places as f64;
            let (x, y) = (foot + (head - foot) * share, floor_mm + (roof_mm - floor_mm) * share);
            Point::new(y * cos - x * sin, y * sin + x * cos, z_mm)
        };
        let nearest = |place: Point| samples.iter().map(|at| (at - place).norm_squared()).fold(f64::INFINITY, f64::min);
        libm::sqrt((0..=places).map(place).map(nearest).fold(f64::INFINITY, f64::min))
    };
    let (mut at, mut step_mm) = ([0.0; 2], STEPS_MM[0]);
    let mut best_mm = least_mm(at);
    while step_mm > STEPS_MM[1] {
        let ways =
            [[1.0, 1.0], [-1.0, -1.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, -1.0], [-1.0, 1.0]];
        let tried = ways.map(|way| [at[0] + way[0] * step_mm, at[1] + way[1] * step_mm]).map(|to| (least_mm(to), to));
        match tried.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((found_mm, to)) if found_mm > best_mm => (best_mm, at) = (found_mm, to),
            _ => step_mm /= 2.0,
        }
    }
    best_mm
}

/// Samples of both blades near a plane.
fn samples(blisk: &Blisk, z_mm: f64) -> Vec<Point> {
    let places = || (0..=300).flat_map(|i| (0..=150).map(move |j| [f64::from(i) / 300.0, f64::from(j) / 150.0]));
    let faces = [0, 1].map(|index| blisk.blade(index)).map(|blade| [blade.pressure, blade.suction]);
    let all = faces.iter().flatten().flat_map(|face| places().map(|[u, v]| face.point(u, v)).collect::<Vec<_>>());
    all.filter(|at| (at.z - z_mm).abs() <= NEAR_MM).collect()
}
