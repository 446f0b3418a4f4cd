//! Least distance of a point from triangles in a tree of boxes.
//!
//! ```text
//! |p - q| >= hypot(max(|a_k . (p - c)| - h_k, 0), k = 1, 2, 3)       for all q with |a_k . (q - c)| <= h_k        (1)
//! ```
//!
//! Each piece of the surface lies in a box about c whose edges point along a_1, the mean normal of the piece, and along the two main directions of its
//! corners across that. A piece of a smooth surface is flat, and on a blade often long and narrow: beside the nearest point spheres and discs about such pieces
//! come nearer than the surface, boxes do not. Our own.
//!
//! Boxes only decide which triangles are measured: single precision is enough for them, and four are compared at once. All places count from o, a corner of the
//! triangles, from which they reach to R. With u = 2^-24 each |a_k . (p - o) - a_k . (c - o)| - h_k is wrong by less than 8 u (|p - o| + R), and (1), with its
//! squares and their sum, by less than 17 u (|p - o| + R).

use crate::geometry::mesh::Triangle;
use crate::proof::spheres::{Node, Tree};
use crate::vector::{Point, Vector};

/// More than the error of (1) in single precision, of |p - o| + R: no piece with the nearest point is left out.
const ROUNDING: f64 = 32.0 / (1 << 24) as f64;

/// Triangles to which the distance of points is measured, in a tree of boxes for a fast search.
pub struct BoxTree {
    triangles: Vec<Triangle>,
    /// Boxes by fours; the last are those of the largest pieces.
    fours: Vec<Four>,
    /// o
    origin: Point,
    /// R
    reach_mm: f64,
}

/// Four boxes side by side. Where there are fewer, the others are infinitely far away.
struct Four {
    /// a: box axis, coordinate, box.
    axes: [[[f32; 4]; 3]; 3],
    /// a . (c - o): box axis, box.
    places_mm: [[f32; 4]; 3],
    /// h: box axis, box.
    halves_mm: [[f32; 4]; 3],
    /// Content of each box.
    pieces: [Piece; 4],
}

/// Content of a box.
#[derive(Clone, Copy)]
enum Piece {
    /// Single triangle, by its index.
    Triangle(usize),
    /// Four boxes, by their index.
    Four(usize),
}

/// Box in any orientation.
struct OrientedBox {
    /// c
    centre: Point,
    /// a
    axes: [Vector; 3],
    /// h
    halves_mm: [f64; 3],
}

/// Search for the triangle nearest to a point.
struct Search<'t> {
    tree: &'t BoxTree,
    point: &'t Point,
    /// p - o
    off_mm: [f32; 3],
    /// Error of boxes' distances.
    rounding_mm: f64,
    /// Distance of the nearest point so far, or the one within which points are looked for.
    distance_mm: f64,
    /// Square of the bound (1) from which on no box has a nearer point.
    limit_mm2: f32,
    /// The nearest point so far.
    on: Option<Point>,
}

impl BoxTree {
    /// Tree of these triangles.
    pub fn new(triangles: Vec<Triangle>) -> Self {
        let origin = triangles.first().map_or(Point::origin(), |triangle| triangle[0]);
        let corners = triangles.iter().flatten();
        let reach_mm = corners.map(|corner| (corner - origin).norm()).fold(0.0, f64::max);
        let halves = Tree::new(triangles);
        let mut found = BoxTree { triangles: halves.triangles().to_vec(), fours: Vec::new(), origin, reach_mm };
        if let Some(root) = halves.root() {
            found.add_four(&halves, root, &mut Vec::new());
        }
        found
    }

    /// All triangles.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// Nearest point of the triangles that lies nearer than `within_mm`, and its distance.
    pub fn nearest(&self, point: &Point, within_mm: f64) -> Option<(f64, Point)> {
        let off = point - self.origin;
        let rounding_mm = ROUNDING * (off.norm() + self.reach_mm);
        let off_mm = [off.x as f32, off.y as f32, off.z as f32];
        let mut search = Search { tree: self, point, off_mm, rounding_mm, distance_mm: 0.0, limit_mm2: 0.0, on: None };
        search.look_within(within_mm);
        search.four(self.fours.last()?);
        search.on.map(|on| (search.distance_mm, on))
    }

    /// Adds the boxes of the pieces of a node, below them first, and appends its triangles. Returns their index.
    fn add_four(&mut self, halves: &Tree, node: Node, numbers: &mut Vec<usize>) -> usize {
        let mut four = Four::EMPTY;
        for (index, part) in quarters(halves, node).into_iter().enumerate() {
            let first = numbers.len();
            let piece = match part {
                Node::Sphere(_) => Piece::Four(self.add_four(halves, part, numbers)),
                Node::Triangle(number) => {
                    numbers.push(number);
                    Piece::Triangle(number)
                }
            };
            let triangles: Vec<&Triangle> = numbers[first..].iter().map(|number| &self.triangles[*number]).collect();
            four.put(index, piece, &OrientedBox::about(&triangles), &self.origin);
        }
        self.fours.push(four);
        self.fours.len() - 1
    }
}

/// Halves of the halves of a node; triangles stay whole.
fn quarters(halves: &Tree, node: Node) -> Vec<Node> {
    let parts = |node: Node| match node {
        Node::Sphere(number) => halves.sphere(number).halves.to_vec(),
        Node::Triangle(_) => vec![node],
    };
    parts(node).into_iter().flat_map(parts).collect()
}

impl Four {
    /// No box.
    const EMPTY: Four = Four {
        axes: [[[0.0; 4]; 3]; 3],
        places_mm: [[0.0; 4]; 3],
        halves_mm: [[f32::NEG_INFINITY; 4]; 3],
        pieces: [Piece::Triangle(0); 4],
    };

    /// Sets one of the boxes; places count from `origin`.
    fn put(&mut self, index: usize, piece: Piece, found: &OrientedBox, origin: &Point) {
        for (k, axis) in found.axes.iter().enumerate() {
            for coordinate in 0..3 {
                self.axes[k][coordinate][index] = axis[coordinate] as f32;
            }
            self.places_mm[k][index] = axis.dot(&(found.centre - origin)) as f32;
            self.halves_mm[k][index] = found.halves_mm[k] as f32;
        }
        self.pieces[index] = piece;
    }

    /// Squares of the lower bounds (1) for a point at `off_mm` from the origin.
    fn no_less_mm2(&self, off_mm: [f32; 3]) -> [f32; 4] {
        let mut squares_mm2 = [0.0; 4];
        for k in 0..3 {
            let [x, y, z] = &self.axes[k];
            for index in 0..4 {
                let along_mm = x[index] * off_mm[0] + y[index] * off_mm[1] + z[index] * off_mm[2];
                let beyond_mm = (along_mm - self.places_mm[k][index]).abs() - self.halves_mm[k][index];
                // Not `max`, which asks whether one of them is no number.
                let beyond_mm = if beyond_mm > 0.0 { beyond_mm } else { 0.0 };
                squares_mm2[index] += beyond_mm * beyond_mm;
            }
        }
        squares_mm2
    }
}

impl Search<'_> {
    /// Looks for nearer points in four boxes, in the nearest one first.
    fn four(&mut self, four: &Four) {
        let mut left_mm2 = four.no_less_mm2(self.off_mm);
        loop {
            let nearer = |a: usize, b: usize| if left_mm2[b] < left_mm2[a] { b } else { a };
            let nearest = nearer(nearer(0, 1), nearer(2, 3));
            let may_be_nearer = left_mm2[nearest] < self.limit_mm2;
            if !may_be_nearer {
                return;
            }
            left_mm2[nearest] = f32::INFINITY;
            match four.pieces[nearest] {
                Piece::Triangle(number) => self.triangle(number),
                Piece::Four(number) => self.four(&self.tree.fours[number]),
            }
        }
    }

    fn triangle(&mut self, number: usize) {
        let on = on_triangle(&self.tree.triangles[number], self.point);
        let distance_mm = (on - self.point).norm();
        if distance_mm < self.distance_mm {
            self.on = Some(on);
            self.look_within(distance_mm);
        }
    }

    /// Only nearer points count from now on.
    fn look_within(&mut self, distance_mm: f64) {
        self.distance_mm = distance_mm;
        let limit_mm = distance_mm + self.rounding_mm;
        self.limit_mm2 = (limit_mm * limit_mm) as f32;
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
