//! Least distance of a point from triangles in a tree of boxes.
//!
//! ```text
//! |p - q| >= hypot(max(|a_k . (p - c)| - h_k, 0), k = 1, 2, 3)       for all q with |a_k . (q - c)| <= h_k        (1)
//! ```
//!
//! Each piece of the surface lies in a box about c whose edges point along a_1, the mean normal of the piece, and along the two main directions of its
//! corners across that. A piece of a smooth surface is flat, and on a blade often long and narrow: beside the nearest point spheres and discs about such pieces
//! come nearer than the surface, boxes do not. Our own.

use crate::geometry::mesh::Triangle;
use crate::proof::spheres::{Node, Tree};
use crate::vector::{Point, Vector};

/// More than rounding of (1), mm: no piece with the nearest point is left out.
const ROUNDING_MM: f64 = 1e-9;

/// Triangles to which the distance of points is measured, in a tree of boxes for a fast search.
pub struct BoxTree {
    /// Halves of each piece. Its spheres are not used.
    tree: Tree,
    /// Boxes of the tree's spheres, by their numbers.
    pieces: Vec<OrientedBox>,
    /// Boxes of the triangles.
    single: Vec<OrientedBox>,
}

/// Box in any orientation.
#[derive(Clone, Copy)]
struct OrientedBox {
    /// c
    centre: Point,
    /// a
    axes: [Vector; 3],
    /// h
    halves_mm: [f64; 3],
}

/// Nearest point so far.
struct Nearest {
    distance_mm: f64,
    on: Option<Point>,
}

impl BoxTree {
    /// Tree of these triangles.
    pub fn new(triangles: Vec<Triangle>) -> Self {
        let single = triangles.iter().map(|triangle| OrientedBox::about(&[triangle])).collect();
        let mut found = BoxTree { pieces: Vec::new(), single, tree: Tree::new(triangles) };
        if let Some(root) = found.tree.root() {
            found.add_pieces(root, &mut Vec::new());
        }
        found
    }

    /// All triangles.
    pub fn triangles(&self) -> &[Triangle] {
        self.tree.triangles()
    }

    /// Nearest point of the triangles that lies nearer than `within_mm`, and its distance.
    pub fn nearest(&self, point: &Point, within_mm: f64) -> Option<(f64, Point)> {
        let mut best = Nearest { distance_mm: within_mm, on: None };
        if let Some(root) = self.tree.root() {
            self.search(root, point, &mut best);
        }
        best.on.map(|on| (best.distance_mm, on))
    }

    /// Adds the boxes of a node, in the order of the spheres' numbers: halves come before their whole. Appends its triangles.
    fn add_pieces(&mut self, node: Node, numbers: &mut Vec<usize>) {
        let number = match node {
            Node::Triangle(number) => return numbers.push(number),
            Node::Sphere(number) => number,
        };
        let first = numbers.len();
        for half in self.tree.sphere(number).halves {
            self.add_pieces(half, numbers);
        }
        let triangles: Vec<&Triangle> = numbers[first..].iter().map(|number| &self.triangles()[*number]).collect();
        let piece = OrientedBox::about(&triangles);
        debug_assert_eq!(self.pieces.len(), number, "halves are numbered before their whole");
        self.pieces.push(piece);
    }

    fn search(&self, node: Node, point: &Point, best: &mut Nearest) {
        match node {
            Node::Triangle(number) => {
                let on = on_triangle(&self.triangles()[number], point);
                let distance_mm = (on - point).norm();
                if distance_mm < best.distance_mm {
                    *best = Nearest { distance_mm, on: Some(on) };
                }
            }
            Node::Sphere(number) => {
                let mut halves = self.tree.sphere(number).halves.map(|half| (self.no_less_mm2(half, point), half));
                if halves[1].0 < halves[0].0 {
                    halves.swap(0, 1);
                }
                for (least_mm2, half) in halves {
                    let limit_mm = best.distance_mm + ROUNDING_MM;
                    if least_mm2 < limit_mm * limit_mm {
                        self.search(half, point, best);
                    }
                }
            }
        }
    }

    /// Square of the lower bound of a node's distance (1).
    fn no_less_mm2(&self, node: Node, point: &Point) -> f64 {
        match node {
            Node::Triangle(number) => self.single[number].no_less_mm2(point),
            Node::Sphere(number) => self.pieces[number].no_less_mm2(point),
        }
    }
}

impl OrientedBox {
    /// Box about triangles.
    fn about(triangles: &[&Triangle]) -> Self {
        let sum: Vector = triangles.iter().map(|[a, b, c]| (b - a).cross(&(c - a))).sum();
        let normal = sum.try_normalize(0.0).unwrap_or_else(Vector::z);
        let level = normal.cross(&Vector::ith(normal.iamin(), 1.0)).normalize();
        let axes = [normal, level, normal.cross(&level)];
        let corners = || triangles.iter().copied().flatten();
        let first = triangles[0][0];
        // Main directions across the normal, from the second moments of the corners.
        let count = 3.0 * triangles.len() as f64;
        let places = || corners().map(|corner| [axes[1].dot(&(corner - first)), axes[2].dot(&(corner - first))]);
        let [x, y] = places().fold([0.0; 2], |[x, y], at| [x + at[0] / count, y + at[1] / count]);
        let [xx, xy, yy] = places().fold([0.0; 3], |[xx, xy, yy], at| {
            let [dx, dy] = [at[0] - x, at[1] - y];
            [xx + dx * dx, xy + dx * dy, yy + dy * dy]
        });
        let (sin, cos) = libm::sincos(libm::atan2(2.0 * xy, xx - yy) / 2.0);
        let axes = [axes[0], axes[1] * cos + axes[2] * sin, axes[2] * cos - axes[1] * sin];
        let ranges_mm = axes.map(|axis| {
            let along = corners().map(|corner| axis.dot(&(corner - first)));
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
        });
        let middle =
            [0, 1, 2].map(|k| axes[k] * f64::midpoint(ranges_mm[k][0], ranges_mm[k][1])).iter().sum::<Vector>();
        OrientedBox { centre: first + middle, axes, halves_mm: ranges_mm.map(|[low, high]| (high - low) / 2.0) }
    }

    /// Square of the lower bound of a point's distance (1).
    fn no_less_mm2(&self, point: &Point) -> f64 {
        let off = point - self.centre;
        let beyond_mm = |k: usize| (self.axes[k].dot(&off).abs() - self.halves_mm[k]).max(0.0);
        let [x, y, z] = [beyond_mm(0), beyond_mm(1), beyond_mm(2)];
        x * x + y * y + z * z
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
        let tree = BoxTree::new(triangles.clone());
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
        let tree = BoxTree::new(triangles.clone());
        for k in 0..300_u32 {
            let [x, y, z] = [k * 7 % 31, k * 11 % 37, k * 13 % 41].map(f64::from);
            let point = Point::new(x - 5.0, y - 8.0, z - 15.0);
            let least_mm = triangles.iter().map(|triangle| (on_triangle(triangle, &point) - point).norm());
            let least_mm = least_mm.fold(f64::INFINITY, f64::min);
            assert_eq!(tree.nearest(&point, f64::INFINITY).unwrap().0, least_mm, "{point}");
        }
    }
}
