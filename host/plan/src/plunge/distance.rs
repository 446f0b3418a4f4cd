//! Least distance of a point from triangles in a tree of spheres.

use crate::geometry::mesh::Triangle;
use crate::proof::spheres::{Branch, Tree};
use crate::vector::Point;

/// Nearest point of the triangles that lies nearer than `within_mm`, and its distance.
pub fn nearest(tree: &Tree, point: &Point, within_mm: f64) -> Option<(f64, Point)> {
    let mut best = (within_mm, None);
    if let Some(root) = tree.root() {
        search(tree, root, point, &mut best);
    }
    best.1.map(|found| (best.0, found))
}

fn search(tree: &Tree, branch: Branch, point: &Point, best: &mut (f64, Option<Point>)) {
    match branch {
        Branch::Triangle(number) => {
            let found = on_triangle(&tree.triangles()[number], point);
            let distance_mm = (found - point).norm();
            if distance_mm < best.0 {
                *best = (distance_mm, Some(found));
            }
        }
        Branch::Sphere(number) => {
            let mut halves = tree.sphere(number).halves.map(|half| (no_less_mm(tree, half, point), half));
            if halves[1].0 < halves[0].0 {
                halves.swap(0, 1);
            }
            for (least_mm, half) in halves {
                if least_mm < best.0 {
                    search(tree, half, point, best);
                }
            }
        }
    }
}

/// Lower bound of the distance of a branch.
fn no_less_mm(tree: &Tree, branch: Branch, point: &Point) -> f64 {
    match branch {
        Branch::Triangle(_) => 0.0,
        Branch::Sphere(number) => {
            let sphere = tree.sphere(number);
            (point - sphere.centre).norm() - sphere.radius_mm
        }
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
        let tree = Tree::new(triangles.clone());
        for point in (0..20).map(|k| place(k * 3 + 2) * 1.3) {
            let (found_mm, on) = nearest(&tree, &point, f64::INFINITY).unwrap();
            assert!(((on - point).norm() - found_mm).abs() < 1e-12);
            let shares = (0..=60).flat_map(|i| (0..=60 - i).map(move |j| [f64::from(i) / 60.0, f64::from(j) / 60.0]));
            let sampled = triangles.iter().flat_map(|[a, b, c]| {
                let (a, b, c) = (*a, *b, *c);
                shares.clone().map(move |[s, t]| a + (b - a) * s + (c - a) * t)
            });
            let least_mm = sampled.map(|at| (at - point).norm()).fold(f64::INFINITY, f64::min);
            assert!(found_mm <= least_mm + 1e-12 && found_mm > least_mm - 1.0, "{found_mm} {least_mm}");
        }
        assert!(nearest(&tree, &Point::new(100.0, 0.0, 0.0), 10.0).is_none());
    }
}
