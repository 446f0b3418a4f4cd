//! Least distance of a point from triangles in a tree of spheres.
//!
//! ```text
//! sphere:  distance >= |p - c| - r                                                                    (1)
//! slab:    distance >= hypot(max(l - n . (p - c), n . (p - c) - h, 0), max(|(p - c) across n| - r, 0))   (2)
//! ```
//!
//! All points q of a piece have |q - c| <= r and l <= n . (q - c) <= h. A piece of a smooth surface is flat: beside the nearest point its sphere comes nearer
//! than the surface, its slab does not. (1) decides the order, (2) leaves out what cannot be nearer. Our own.

use crate::geometry::mesh::Triangle;
use crate::proof::spheres::{Node, Tree};
use crate::vector::{Point, Vector};

/// More than rounding of (2), mm: no piece with the nearest point is left out.
const ROUNDING_MM: f64 = 1e-9;

/// Triangles to which the distance of points is measured, in a tree of spheres and slabs for a fast search.
pub struct SlabTree {
    tree: Tree,
    /// Slabs of the tree's spheres, by their numbers.
    slabs: Vec<Slab>,
}

/// Slab about a sphere's centre that contains its triangles.
#[derive(Clone, Copy)]
struct Slab {
    /// n
    normal: Vector,
    /// l, h
    heights_mm: [f64; 2],
}

impl SlabTree {
    /// Tree of these triangles.
    pub fn new(triangles: Vec<Triangle>) -> Self {
        let tree = Tree::new(triangles);
        let mut found = SlabTree { slabs: Vec::new(), tree };
        if let Some(root) = found.tree.root() {
            found.add_slabs(root, &mut Vec::new());
        }
        found
    }

    /// All triangles.
    pub fn triangles(&self) -> &[Triangle] {
        self.tree.triangles()
    }

    /// Nearest point of the triangles that lies nearer than `within_mm`, and its distance.
    pub fn nearest(&self, point: &Point, within_mm: f64) -> Option<(f64, Point)> {
        let mut best = (within_mm, None);
        if let Some(root) = self.tree.root() {
            self.search(root, point, &mut best);
        }
        best.1.map(|found| (best.0, found))
    }

    /// Adds the slabs of a node, in the order of the spheres' numbers: halves come before their whole. Appends its triangles.
    fn add_slabs(&mut self, node: Node, numbers: &mut Vec<usize>) {
        let number = match node {
            Node::Triangle(number) => return numbers.push(number),
            Node::Sphere(number) => number,
        };
        let sphere = *self.tree.sphere(number);
        let first = numbers.len();
        for half in sphere.halves {
            self.add_slabs(half, numbers);
        }
        let triangles = || numbers[first..].iter().map(|number| &self.tree.triangles()[*number]);
        let sum: Vector = triangles().map(|[a, b, c]| (b - a).cross(&(c - a))).sum();
        let normal = sum.try_normalize(0.0).unwrap_or_else(Vector::z);
        let heights = triangles().flatten().map(|corner| normal.dot(&(corner - sphere.centre)));
        let heights_mm = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], at| [l.min(at), h.max(at)]);
        debug_assert_eq!(self.slabs.len(), number, "halves are numbered before their whole");
        self.slabs.push(Slab { normal, heights_mm });
    }

    fn search(&self, node: Node, point: &Point, best: &mut (f64, Option<Point>)) {
        match node {
            Node::Triangle(number) => {
                let found = on_triangle(&self.tree.triangles()[number], point);
                let distance_mm = (found - point).norm();
                if distance_mm < best.0 {
                    *best = (distance_mm, Some(found));
                }
            }
            Node::Sphere(number) => {
                let mut halves = self.tree.sphere(number).halves.map(|half| (self.no_less_mm(half, point), half));
                if halves[1].0 < halves[0].0 {
                    halves.swap(0, 1);
                }
                for (least_mm, half) in halves {
                    if least_mm < best.0 && self.may_be_nearer(half, point, best.0) {
                        self.search(half, point, best);
                    }
                }
            }
        }
    }

    /// Lower bound of the distance of a node (1).
    fn no_less_mm(&self, node: Node, point: &Point) -> f64 {
        match node {
            Node::Triangle(_) => 0.0,
            Node::Sphere(number) => {
                let sphere = self.tree.sphere(number);
                (point - sphere.centre).norm() - sphere.radius_mm
            }
        }
    }

    /// Whether a node may have a point nearer than `within_mm` (2).
    fn may_be_nearer(&self, node: Node, point: &Point, within_mm: f64) -> bool {
        let Node::Sphere(number) = node else { return true };
        let (sphere, Slab { normal, heights_mm: [low_mm, high_mm] }) = (self.tree.sphere(number), &self.slabs[number]);
        let off = point - sphere.centre;
        let height_mm = normal.dot(&off);
        let above_mm = (low_mm - height_mm).max(height_mm - high_mm).max(0.0);
        let across_mm = libm::sqrt((off.norm_squared() - height_mm * height_mm).max(0.0));
        let beside_mm = (across_mm - sphere.radius_mm).max(0.0);
        let limit_mm = within_mm + ROUNDING_MM;
        above_mm * above_mm + beside_mm * beside_mm < limit_mm * limit_mm
    }
}

/// Point of a triangle nearest to a point.
fn on_triangle([a, b, c]: &Triangle, point: &Point) -> Point {
    let normal = (b - a).cross(&(c - a));
    let is_over =
        [(a, b), (b, c), (c, a)].iter().all(|(from, to)| (*to - *from).cross(&(point - *from)).dot(&normal) >= 0.0);
    let square = normal.norm_squared();
    if is_over && square > 0.0 {
        return point - normal * (normal.dot(&(point - a)) / square);
    }
    let on_side = |from: &Point, to: &Point| {
        let way = to - from;
        let share = ((point - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        if share.is_nan() { *from } else { from + way * share }
    };
    let sides = [on_side(a, b), on_side(b, c), on_side(c, a)];
    let nearer = |one: Point, other: Point| {
        if (other - point).norm_squared() < (one - point).norm_squared() { other } else { one }
    };
    nearer(nearer(sides[0], sides[1]), sides[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_that_of_dense_samples() {
        let place = |k: usize| Point::new((k * 7 % 31) as f64, (k * 11 % 37) as f64, (k * 13 % 41) as f64);
        let triangles: Vec<Triangle> = (0..40).map(|k| [place(k), place(k + 1), place(k + 5)]).collect();
        let tree = SlabTree::new(triangles.clone());
        for point in (0..20).map(|k| place(k * 3 + 2) * 1.3) {
            let (found_mm, on) = tree.nearest(&point, f64::INFINITY).unwrap();
            assert!(((on - point).norm() - found_mm).abs() < 1e-12);
            let shares = (0..=60).flat_map(|i| (0..=60 - i).map(move |j| [f64::from(i) / 60.0, f64::from(j) / 60.0]));
            let sampled = triangles.iter().flat_map(|[a, b, c]| {
                let (a, b, c) = (*a, *b, *c);
                shares.clone().map(move |[s, t]| a + (b - a) * s + (c - a) * t)
            });
            let least_mm = sampled.map(|at| (at - point).norm()).fold(f64::INFINITY, f64::min);
            assert!(found_mm <= least_mm + 1e-12 && found_mm > least_mm - 1.0, "{found_mm} {least_mm}");
        }
        assert!(tree.nearest(&Point::new(100.0, 0.0, 0.0), 10.0).is_none());
    }

    #[test]
    fn no_triangle_of_a_curved_surface_is_nearer_to_the_bit() {
        let place = |i: u32, j: u32| {
            let [x, y] = [i, j].map(|k| f64::from(k) / 2.0);
            Point::new(x, y, 3.0 * libm::sin(x / 7.0) + y * y / 40.0)
        };
        let squares = (0..40)
            .flat_map(|i| (0..40).map(move |j| [place(i, j), place(i + 1, j), place(i, j + 1), place(i + 1, j + 1)]));
        let triangles: Vec<Triangle> = squares.flat_map(|[a, b, c, d]| [[a, b, c], [b, d, c]]).collect();
        let tree = SlabTree::new(triangles.clone());
        for k in 0..300_u32 {
            let [x, y, z] = [k * 7 % 31, k * 11 % 37, k * 13 % 41].map(f64::from);
            let point = Point::new(x - 5.0, y - 8.0, z - 15.0);
            let least_mm = triangles.iter().map(|triangle| (on_triangle(triangle, &point) - point).norm());
            let least_mm = least_mm.fold(f64::INFINITY, f64::min);
            assert_eq!(tree.nearest(&point, f64::INFINITY).unwrap().0, least_mm, "{point}");
        }
    }
}
