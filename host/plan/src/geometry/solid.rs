//! Blades that other programs export as surfaces: sections through the mesh of one blade.
//!
//! The outlines lie at shares of the height that grow with the square of their number, so that a fillet at the root has several. The
//! edges are the two points of an outline that lie farthest apart, between the points of the mesh.

use crate::vector::Point;

use super::blade::Sections;
use super::blisk::Revolution;
use super::closed_loop::Loop;
use super::curves::assigned_sides;
use super::generatrix::generatrix;
use super::resampling::spread;
use super::slices::{GasPath, outline};
use super::solid_fault::SolidFault;
use super::surface_mesh::{SmoothMesh, SurfaceMesh};

/// Number of sections.
const SECTIONS: usize = 25;

/// Number of points of a side, and how evenly they lie: facets at an edge are not as fine as points at it could be.
const POINTS: usize = 121;
const EVEN_RATIO: f64 = 0.15;

/// Share of the height by which the first and last outline keep away from the ends of the mesh, where it has no triangles.
const END_RATIO: f64 = 1e-3;

/// Least radial part of the normals of a blade's tip.
const TIP_RADIAL_MIN: f64 = 0.85;

/// Points about an edge, and how finely the edge is searched between them.
const WINDOW: usize = 4;
const FINE: usize = 801;

/// Half of the places to which a parabola is fitted.
const FIT: usize = 250;

/// Generatrix of the hub's mesh.
///
/// # Errors
/// The mesh is no surface of revolution.
pub fn hub(mesh: &SurfaceMesh) -> Result<Revolution, SolidFault> {
    if mesh.triangles.is_empty() {
        return Err(SolidFault::Empty);
    }
    generatrix(mesh, |_, _| true)
}

/// Sections of one blade's mesh between the hub and `tip`, or the tip face of the mesh; the leading edge lies at low z if `from_low_z`.
///
/// # Errors
/// The mesh is no single blade on this hub.
pub fn sections(
    mesh: &SurfaceMesh,
    hub: &Revolution,
    tip: Option<&Revolution>,
    from_low_z: bool,
) -> Result<Sections, SolidFault> {
    if mesh.triangles.is_empty() {
        return Err(SolidFault::Empty);
    }
    let own_tip = if tip.is_none() { Some(tip_of(mesh, hub)?) } else { None };
    let Some(tip) = tip.or(own_tip.as_ref()) else { return Err(SolidFault::NoTip) };
    let path = GasPath { hub, tip };
    let shares: Vec<f64> = mesh.points.iter().map(|point| path.share(point)).collect();
    let [least, most] = shares
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], share| [low.min(*share), high.max(*share)]);
    if !(least < 0.5 && most > 1.0 - 2.0 * END_RATIO) || least < -5.0 || most > 5.0 {
        return Err(SolidFault::OffTheHub { shares: [least, most] });
    }
    let smooth = SmoothMesh::new(mesh);
    let on = |share: f64| outline(&smooth, &shares, &path, share);
    let step = |k: usize| k as f64 / (SECTIONS - 1) as f64;
    let low = if on(0.0).is_ok() { 0.0 } else { least.max(0.0) + END_RATIO };
    let levels = (0..SECTIONS).map(|k| low + (1.0 - END_RATIO - low) * step(k) * step(k));
    let mut sides = Vec::new();
    for (at, level) in levels.enumerate() {
        let points = with_edges(on(level)?);
        let around = Loop { points, marks: Vec::new() };
        sides.push(around.split(at + 1, from_low_z).map_err(SolidFault::Section)?);
    }
    let mut blade = assigned_sides(sides, |side| spread(side, POINTS, EVEN_RATIO));
    for side in [&mut blade.pressure, &mut blade.suction] {
        extend(side, low, &path);
    }
    Ok(blade)
}

/// Tip of a blade's mesh: the triangles of its upper half that look outwards.
fn tip_of(mesh: &SurfaceMesh, hub: &Revolution) -> Result<Revolution, SolidFault> {
    let height_mm = |point: usize| {
        let point = &mesh.points[point];
        libm::hypot(point.x, point.y) - hub.radius_mm(point.z)
    };
    let most_mm = (0..mesh.points.len()).map(height_mm).fold(0.0, f64::max);
    let is_tip = |triangle: &[usize; 3], radial: f64| {
        radial > TIP_RADIAL_MIN && triangle.iter().all(|point| height_mm(*point) > most_mm / 2.0)
    };
    generatrix(mesh, is_tip).map_err(|fault| if fault == SolidFault::NoRevolution { SolidFault::NoTip } else { fault })
}

/// The outline with its two farthest points among its points.
fn with_edges(mut points: Vec<Point>) -> Vec<Point> {
    let count = points.len();
    if count < 2 * WINDOW + 2 {
        return points;
    }
    let pairs = (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j)));
    let apart = |(i, j): (usize, usize)| (points[i] - points[j]).norm_squared();
    let Some((i, j)) = pairs.max_by(|a, b| apart(*a).total_cmp(&apart(*b))) else { return points };
    let fine = |about: usize| {
        let near: Vec<Point> = (0..=2 * WINDOW).map(|k| points[(about + count + k - WINDOW) % count]).collect();
        spread(&near, FINE, 1.0)
    };
    let [about_i, about_j] = [fine(i), fine(j)];
    let (mut one, mut other) = (points[i], points[j]);
    for _ in 0..3 {
        one = farthest(&other, &about_i);
        other = farthest(&one, &about_j);
    }
    points[i] = one;
    points[j] = other;
    points
}

/// Point of a finely spread curve that is farthest from `from`: the vertex of the parabola that fits the distances best. Where the curve is
/// round, its farthest point alone moves by the square root of an error of the points.
fn farthest(from: &Point, among: &[Point]) -> Point {
    let off = |k: usize| (among[k] - from).norm();
    let mut middle = (0..FINE).max_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(0);
    for _ in 0..5 {
        let half = FIT.min(middle).min(FINE - 1 - middle);
        // Least squares over places t = -half to half, with sums of t^2 and t^4.
        let places = || (middle - half..=middle + half).map(|k| (k as f64 - middle as f64, off(k)));
        let sum = |of: fn(f64, f64) -> f64| places().map(|(t, value)| of(t, value)).sum::<f64>();
        let [count, second, fourth] = [sum(|_, _| 1.0), sum(|t, _| t * t), sum(|t, _| t * t * t * t)];
        let bend = (count * sum(|t, value| t * t * value) - second * sum(|_, value| value))
            / (count * fourth - second * second);
        let vertex = -(sum(|t, value| t * value) / second) / (2.0 * bend);
        // A sharp edge has no parabola.
        if bend.is_nan() || bend >= 0.0 || vertex.abs() > half as f64 {
            break;
        }
        middle = (middle as f64 + libm::round(vertex)) as usize;
    }
    among[middle]
}

/// Moves the last sections to the ends of the gas path, along the lines through the neighbouring ones.
fn extend(side: &mut [Vec<Point>], low: f64, path: &GasPath<'_>) {
    let last = side.len() - 1;
    let mut moved = |at: usize, inner: usize, target: f64| {
        for k in 0..side[at].len() {
            let (end, before) = (side[at][k], side[inner][k]);
            let (at_end, at_before) = (path.share(&end), path.share(&before));
            side[at][k] = end + (end - before) * ((target - at_end) / (at_end - at_before));
        }
    };
    moved(last, last - 1, 1.0);
    if low > 0.0 && low < 2.0 * END_RATIO {
        moved(0, 1, 0.0);
    }
}
