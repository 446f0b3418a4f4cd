//! Search for the element that contains a point, and the position in it; or for the nearest element.
//!
//! A coarse grid lists for each of its cells the elements nearby. Newton's method finds the position in an element; its
//! first step is exact if edges are straight. A point outside belongs to the element whose straight tetrahedron is
//! nearest to it (nearest of all corners, edges, faces), and its position is beyond that element's border.

use std::fmt;

use nalgebra::{Matrix3, Vector3};

use super::element::jacobian;
use super::mesh::TetMesh;
use super::tetrahedron::{EDGES, MIDDLE, NODES, NaturalCoordinates, barycentric, functions};

/// Distance beyond the border, as a fraction of an element's size, that counts as inside.
const BORDER_RATIO: f64 = 1e-9;

/// Fraction of an element's box by which bent edges may leave it.
const BULGE_RATIO: f64 = 0.1;

/// Upper bound of the sum of the edge nodes' functions, reached in the middle of the element.
const BEND_SUM_MAX: f64 = 1.5;

/// Largest number of steps of Newton's method.
const STEPS: usize = 12;

/// Point located in a mesh: its element and the position in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocatedPoint {
    /// Index of the element.
    pub element: usize,
    /// Position in the element, as natural coordinates; for a point outside the body, beyond the element's border.
    pub place: NaturalCoordinates,
    /// Distance of the point to the body, 0 inside.
    pub outside_mm: f64,
    /// Nearest point of the body.
    nearest_mm: Vector3<f64>,
}

impl LocatedPoint {
    /// Whether these corners and everything between them are no nearer to a point outside: all of them are behind the
    /// plane through the nearest point, square to the line from there to the point. If faces are in one plane, within
    /// rounding, the first of them suffices.
    fn hides(&self, corners_mm: &[[f64; 3]], point: &Vector3<f64>) -> bool {
        let off = point - self.nearest_mm;
        let least = BORDER_RATIO * off.norm_squared();
        corners_mm.iter().all(|corner_mm| off.dot(&(Vector3::from(*corner_mm) - self.nearest_mm)) <= least)
    }
}

/// Error: the point is outside the body by more than the reach of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooFar {
    /// Requested point.
    pub point_mm: [f64; 3],
}

impl fmt::Display for TooFar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.point_mm;
        write!(f, "the point {x:.3} {y:.3} {z:.3} is too far from the body to move with it")
    }
}

impl std::error::Error for TooFar {}

/// Lowest and highest corner.
type Box3 = [Vector3<f64>; 2];

/// Search for the element of a mesh that contains a point, by a coarse grid.
#[derive(Clone, Debug)]
pub struct Locator {
    boxes: Vec<Box3>,
    planes: Vec<Option<Planes>>,
    lowest_mm: Vector3<f64>,
    step_mm: Vector3<f64>,
    counts: [usize; 3],
    elements: Vec<Vec<usize>>,
    reach_mm: f64,
}

/// Distance of a point from a box.
fn distance_mm([low, high]: &Box3, point: &Vector3<f64>) -> f64 {
    (low - point).sup(&(point - high)).sup(&Vector3::zeros()).norm()
}

/// Position of a point in an element, in it or beyond it; `None` if the element's bend does not reach the point.
fn place_of(nodes_mm: &[[f64; 3]; NODES], point: &Vector3<f64>) -> Option<NaturalCoordinates> {
    let mut place = Vector3::from(MIDDLE);
    for _ in 0..STEPS {
        let at: NaturalCoordinates = place.into();
        let here: Vector3<f64> =
            functions(at).iter().zip(nodes_mm).map(|(n, node_mm)| Vector3::from(*node_mm) * *n).sum();
        let step = jacobian(nodes_mm, at).try_inverse()? * (point - here);
        place += step;
        if step.amax() < BORDER_RATIO {
            return Some(place.into());
        }
    }
    None
}

/// Planes of the four faces between straight corners.
#[derive(Clone, Debug)]
struct Planes {
    base: Vector3<f64>,
    /// Gradients (rows) of the barycentric coordinates of all corners but the first.
    gradients: Matrix3<f64>,
    /// Steepness of these gradients, and of that of the first corner.
    steepness: [f64; 3],
    of_base: f64,
    /// Largest distance of points of the element beyond the planes, because its edges are bent.
    bulge_mm: f64,
}

impl Planes {
    /// Planes; `None` if the corners are in one plane.
    fn new(nodes_mm: &[[f64; 3]; NODES]) -> Option<Self> {
        let node = |i: usize| Vector3::from(nodes_mm[i]);
        let base = node(0);
        let edges = Matrix3::from_columns(&[1, 2, 3].map(|i| node(i) - base));
        let gradients = edges.try_inverse()?;
        let steepness = [0, 1, 2].map(|k| gradients.row(k).norm());
        let bends_mm =
            EDGES.iter().enumerate().map(|(edge, [i, j])| (node(4 + edge) - (node(*i) + node(*j)) / 2.0).norm());
        let bulge_mm = BEND_SUM_MAX * bends_mm.fold(0.0, f64::max) + 2.0 * BORDER_RATIO * edges.norm();
        Some(Planes { base, gradients, steepness, of_base: gradients.row_sum().norm(), bulge_mm })
    }

    /// Nearest point of the straight tetrahedron, and its distance, if it is in the face whose plane the point is
    /// farthest beyond: that plane separates them.
    fn on_face_mm(&self, point: &Vector3<f64>) -> Option<(Vector3<f64>, f64)> {
        let l = self.gradients * (point - self.base);
        let of_base = ((l.sum() - 1.0) / self.of_base, self.gradients.row_sum().transpose() / self.of_base);
        let others =
            (0..3).map(|k| (-l[k] / self.steepness[k], -self.gradients.row(k).transpose() / self.steepness[k]));
        let (beyond_mm, normal) = others.fold(of_base, |most, other| if other.0 > most.0 { other } else { most });
        let nearest = point - normal * beyond_mm;
        let on = self.gradients * (nearest - self.base);
        let is_within = on.min() >= -BORDER_RATIO && on.sum() <= 1.0 + BORDER_RATIO;
        (beyond_mm > 0.0 && is_within).then_some((nearest, beyond_mm))
    }

    /// Largest distance of a point beyond the planes, a lower bound of its distance from the tetrahedron.
    fn beyond_mm(&self, point: &Vector3<f64>) -> f64 {
        let l = self.gradients * (point - self.base);
        let of_base = (l.sum() - 1.0) / self.of_base;
        (0..3).map(|k| -l[k] / self.steepness[k]).fold(of_base, f64::max)
    }
}

/// Subsets of four corners as bits, whose hulls are the faces, edges, corners and the whole; likely ones first.
const HULLS: [usize; 15] = [7, 11, 13, 14, 3, 5, 6, 9, 10, 12, 1, 2, 4, 8, 15];

/// Nearest point of the straight tetrahedron between four corners, and its distance.
///
/// It is the nearest point of the hull of some corners: a point inside that hull with no other corner in front of it.
fn from_corners_mm(corners_mm: &[[f64; 3]], point: &Vector3<f64>) -> (Vector3<f64>, f64) {
    let corner = |i: usize| Vector3::from(corners_mm[i]);
    // Whether the point is not before the beginning of an edge between two corners.
    let follows = |from: usize, to: usize| {
        let edge = corner(to) - corner(from);
        edge.dot(&(point - corner(from))) >= -BORDER_RATIO * edge.norm_squared()
    };
    let mut least = (*point, f64::INFINITY);
    for some in HULLS {
        let is_chosen = |i: usize| some >> i & 1 == 1;
        let is_beside = |i: usize| (0..4).any(|j| j != i && is_chosen(j) && !follows(i, j));
        if some.count_ones() == 2 && (0..4).any(|i| is_chosen(i) && is_beside(i)) {
            continue;
        }
        let base = some.trailing_zeros() as usize;
        let edge = |i: usize| if is_chosen(i) { corner(i) - corner(base) } else { Vector3::zeros() };
        // The other corners, chosen or not; corners not chosen get a part of zero.
        let others: [usize; 3] = std::array::from_fn(|k| (base + 1 + k) % 4);
        let edges = others.map(edge);
        let gram = Matrix3::from_fn(|i, j| edges[i].dot(&edges[j]) + f64::from(i == j && !is_chosen(others[i])));
        let right = Vector3::from_fn(|i, _| edges[i].dot(&(point - corner(base))));
        let Some(inverse) = gram.try_inverse() else { continue };
        let parts = inverse * right;
        if parts.min() >= 0.0 && parts.sum() <= 1.0 {
            let along: Vector3<f64> = edges.iter().zip(parts.iter()).map(|(edge, part)| edge * *part).sum();
            let nearest = corner(base) + along;
            let off = point - nearest;
            if off.norm() < least.1 {
                least = (nearest, off.norm());
            }
            if (0..4).all(|i| is_chosen(i) || off.dot(&(corner(i) - nearest)) <= 0.0) {
                break;
            }
        }
    }
    least
}

impl Locator {
    /// Prepares the search for points in a mesh, and for those up to `reach_mm` outside.
    pub fn new(mesh: &TetMesh, reach_mm: f64) -> Self {
        let boxes: Vec<Box3> = (0..mesh.elements().len()).map(|element| around(mesh, element)).collect();
        let planes = (0..boxes.len()).map(|element| Planes::new(&mesh.nodes_of_mm(element))).collect();
        let infinite = [Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)];
        let [low, high] = boxes.iter().fold(infinite, |[low, high], b| [low.inf(&b[0]), high.sup(&b[1])]);
        let reach = Vector3::repeat(reach_mm);
        let (lowest_mm, size) = (low - reach, high - low + reach * 2.0);
        // About as many cells as elements, near to cubes.
        let edge_mm = libm::cbrt(size.product() / boxes.len() as f64);
        let counts: [usize; 3] = std::array::from_fn(|axis| (size[axis] / edge_mm).ceil().max(1.0) as usize);
        let step_mm = Vector3::from_fn(|axis, _| size[axis] / counts[axis] as f64);
        let elements = vec![Vec::new(); counts.iter().product()];
        let mut locator = Locator { boxes, planes, lowest_mm, step_mm, counts, elements, reach_mm };
        for element in 0..locator.boxes.len() {
            let [low, high] = locator.boxes[element];
            let (first, last) = (locator.cell(&(low - reach)), locator.cell(&(high + reach)));
            for z in first[2]..=last[2] {
                for y in first[1]..=last[1] {
                    for x in first[0]..=last[0] {
                        let index = locator.index([x, y, z]);
                        locator.elements[index].push(element);
                    }
                }
            }
        }
        locator
    }

    /// Largest distance from the mesh at which a point outside it is located.
    pub fn reach_mm(&self) -> f64 {
        self.reach_mm
    }

    /// The cell of a point, or the nearest one.
    fn cell(&self, point: &Vector3<f64>) -> [usize; 3] {
        // A cast from float to whole number saturates.
        std::array::from_fn(|axis| {
            let place = (point[axis] - self.lowest_mm[axis]) / self.step_mm[axis];
            (place as usize).min(self.counts[axis] - 1)
        })
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// Whether a point is inside an element's box and planes.
    fn may_hold(&self, element: usize, point: &Vector3<f64>) -> bool {
        let planes = self.planes[element].as_ref();
        distance_mm(&self.boxes[element], point) == 0.0
            && planes.is_none_or(|planes| planes.beyond_mm(point) <= planes.bulge_mm)
    }

    /// Locates a point. `near` is an element to check first.
    ///
    /// # Errors
    /// The point is outside by more than the reach.
    pub fn find(&self, mesh: &TetMesh, point_mm: [f64; 3], near: Option<usize>) -> Result<LocatedPoint, TooFar> {
        let point = Vector3::from(point_mm);
        let others = &self.elements[self.index(self.cell(&point))];
        let candidates = || near.into_iter().chain(others.iter().copied().filter(|element| near != Some(*element)));
        for element in candidates().filter(|element| self.may_hold(*element, &point)) {
            let place = place_of(&mesh.nodes_of_mm(element), &point);
            if let Some(place) = place.filter(|place| barycentric(*place).iter().all(|l| *l >= -BORDER_RATIO)) {
                return Ok(LocatedPoint { element, place, outside_mm: 0.0, nearest_mm: point });
            }
        }
        self.nearest(mesh, &point, candidates(), self.reach_mm).ok_or(TooFar { point_mm })
    }

    /// Locates a point or, if it is outside by more than `beyond_mm`, the point at that distance from the body on the
    /// line from the nearest point of the body. `near` is an element to check first.
    pub fn find_nearest(
        &self,
        mesh: &TetMesh,
        point_mm: [f64; 3],
        beyond_mm: f64,
        near: Option<usize>,
    ) -> Option<LocatedPoint> {
        let point = Vector3::from(point_mm);
        let all = || near.into_iter().chain(0..self.boxes.len());
        let found = self.find(mesh, point_mm, near).ok();
        let found = found.or_else(|| self.nearest(mesh, &point, all(), f64::INFINITY))?;
        if found.outside_mm <= beyond_mm {
            return Some(found);
        }
        let carried = found.nearest_mm + (point - found.nearest_mm) * (beyond_mm / found.outside_mm);
        place_of(&mesh.nodes_of_mm(found.element), &carried).map(|place| LocatedPoint { place, ..found })
    }

    /// Element nearest to a point outside, if within a reach.
    fn nearest(
        &self,
        mesh: &TetMesh,
        point: &Vector3<f64>,
        elements: impl Iterator<Item = usize>,
        reach_mm: f64,
    ) -> Option<LocatedPoint> {
        let mut best: Option<LocatedPoint> = None;
        for element in elements {
            let least_mm = best.map_or(f64::INFINITY, |best| best.outside_mm);
            if distance_mm(&self.boxes[element], point) > least_mm.min(reach_mm) {
                continue;
            }
            if best.is_some_and(|best| best.hides(&mesh.nodes_of_mm(element)[..4], point)) {
                continue;
            }
            let Some(planes) = &self.planes[element] else { continue };
            if planes.beyond_mm(point) >= least_mm {
                continue;
            }
            let nodes_mm = mesh.nodes_of_mm(element);
            let on_face_mm = planes.on_face_mm(point);
            let (nearest_mm, outside_mm) = on_face_mm.unwrap_or_else(|| from_corners_mm(&nodes_mm[..4], point));
            if outside_mm < least_mm
                && let Some(place) = place_of(&nodes_mm, point)
            {
                best = Some(LocatedPoint { element, place, outside_mm, nearest_mm });
            }
        }
        best.filter(|best| best.outside_mm <= reach_mm)
    }
}

/// Box of an element, with a margin for bent edges.
fn around(mesh: &TetMesh, element: usize) -> Box3 {
    let nodes = mesh.nodes_of_mm(element).map(Vector3::from);
    let low = nodes.iter().fold(nodes[0], |low, node| low.inf(node));
    let high = nodes.iter().fold(nodes[0], |high, node| high.sup(node));
    let bulge = (high - low) * BULGE_RATIO;
    [low - bulge, high + bulge]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random numbers from -1 to 1.
    fn spread(seed: usize) -> f64 {
        let at = libm::sin(seed as f64 * 12.9898) * 43758.5453;
        2.0 * (at - libm::floor(at)) - 1.0
    }

    #[test]
    fn shortcuts_for_points_outside_lead_to_the_nearest_point() {
        let (mut on_face, mut hidden) = (0, 0);
        for round in 0..2000 {
            let seed = 100 * round;
            let vector = |of: usize| [0, 1, 2].map(|axis| spread(seed + 3 * of + axis));
            let tetrahedron = |of: usize| -> [[f64; 3]; NODES] {
                let corners = [0, 1, 2, 3].map(|corner| Vector3::from(vector(of + corner)));
                std::array::from_fn(|node| match node.checked_sub(4) {
                    None => corners[node].into(),
                    Some(edge) => ((corners[EDGES[edge][0]] + corners[EDGES[edge][1]]) / 2.0).into(),
                })
            };
            let (point, one, other) = (Vector3::from(vector(0)) * 2.0, tetrahedron(1), tetrahedron(5));
            let Some(planes) = Planes::new(&one) else { continue };
            let (nearest_mm, outside_mm) = from_corners_mm(&one[..4], &point);
            if let Some((found_mm, found_outside_mm)) = planes.on_face_mm(&point) {
                on_face += 1;
                assert!((found_outside_mm - outside_mm).abs() < 1e-7 && (found_mm - nearest_mm).norm() < 1e-6);
            }
            let found = LocatedPoint { element: 0, place: MIDDLE, outside_mm, nearest_mm };
            if outside_mm > 0.0 && found.hides(&other[..4], &point) {
                hidden += 1;
                assert!(from_corners_mm(&other[..4], &point).1 > outside_mm * (1.0 - 1e-6));
            }
        }
        assert!(on_face > 100 && hidden > 100, "{on_face} {hidden}");
    }
}
