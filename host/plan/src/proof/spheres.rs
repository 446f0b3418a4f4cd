//! Tree of spheres about triangles.
//!
//! A sphere is about the middle of its triangles' box and reaches to their farthest corner: it contains the triangles,
//! but not the spheres below it.

use crate::geometry::mesh::Triangle;
use crate::vector::Point;

/// Bounding sphere about two or more triangles.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// Centre.
    pub centre: Point,
    /// Radius, mm.
    pub radius_mm: f64,
    /// Both halves of its triangles, each a sphere or a single triangle.
    pub halves: [Node; 2],
}

/// Node of the tree: a sphere about several triangles, or a single triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    /// Single triangle, by its index.
    Triangle(usize),
    /// Sphere, by its index.
    Sphere(usize),
}

/// Tree of bounding spheres about triangles.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    triangles: Vec<Triangle>,
    spheres: Vec<Sphere>,
    root: Option<Node>,
}

impl Tree {
    /// Tree of these triangles; both halves of a sphere have about the same number of them.
    pub fn new(triangles: Vec<Triangle>) -> Self {
        let mut order: Vec<usize> = (0..triangles.len()).collect();
        let mut tree = Tree { triangles, spheres: Vec::new(), root: None };
        tree.root = tree.grown(&mut order);
        tree
    }

    /// Top of the tree, which contains all triangles; `None` without triangles.
    pub fn root(&self) -> Option<Node> {
        self.root
    }

    /// Sphere with this index.
    pub fn sphere(&self, number: usize) -> &Sphere {
        &self.spheres[number]
    }

    /// All triangles.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// Adds the node that contains these triangles.
    fn grown(&mut self, order: &mut [usize]) -> Option<Node> {
        let first = *order.first()?;
        if order.len() == 1 {
            return Some(Node::Triangle(first));
        }
        let corners = || order.iter().flat_map(|number| self.triangles[*number]);
        let start = self.triangles[first][0];
        let (low, high) = corners().fold((start, start), |(low, high), at| (low.inf(&at), high.sup(&at)));
        let centre = nalgebra::center(&low, &high);
        let square = corners().map(|corner| (corner - centre).norm_squared()).fold(0.0, f64::max);
        let axis = (high - low).imax();
        let place = |number: &usize| self.triangles[*number].iter().map(|corner| corner[axis]).sum::<f64>();
        let half = order.len() / 2;
        order.select_nth_unstable_by(half, |a, b| place(a).total_cmp(&place(b)));
        let (left, right) = order.split_at_mut(half);
        let halves = [self.grown(left)?, self.grown(right)?];
        self.spheres.push(Sphere { centre, radius_mm: libm::sqrt(square), halves });
        Some(Node::Sphere(self.spheres.len() - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles below a node; each lies in all spheres above it.
    fn below(tree: &Tree, node: Node) -> Vec<usize> {
        let number = match node {
            Node::Triangle(number) => return vec![number],
            Node::Sphere(number) => number,
        };
        let sphere = tree.sphere(number);
        let found = sphere.halves.map(|half| below(tree, half)).concat();
        for corner in found.iter().flat_map(|triangle| tree.triangles()[*triangle]) {
            assert!((corner - sphere.centre).norm() <= sphere.radius_mm + 1e-12);
        }
        found
    }

    #[test]
    fn every_sphere_holds_its_triangles_and_every_triangle_is_there_once() {
        let place = |k: usize| Point::new((k * 7 % 31) as f64, (k * 11 % 37) as f64, (k * 13 % 41) as f64);
        let tree = Tree::new((0..101).map(|k| [place(k), place(k + 1), place(k + 5)]).collect());
        let mut all = below(&tree, tree.root().unwrap());
        all.sort_unstable();
        assert_eq!(all, (0..101).collect::<Vec<_>>());
        assert_eq!(Tree::new(Vec::new()).root(), None);
    }
}
