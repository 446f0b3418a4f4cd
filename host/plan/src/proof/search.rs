//! Least distance of a part of the tool from a body along its whole path, by node and bound over path and body at
//! once.
//!
//! The pair of an interval of the path and a piece of the body with the least bound is examined first; of the two, the
//! one that makes the bound loose is halved. The search ends when the least bound is no more than a gap below the
//! distance found.

use core::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Rotation3;

use crate::geometry::mesh::Triangle;
use crate::vector::Point;

use super::bound::{Extent, NearPoint};
use super::motion::Motion;
use super::section::Section;
use super::spheres::{Node, Tree};

/// Number of pieces after which a search ends with its present result: its lower bound is true at any time.
const MOST_PIECES: usize = 4_000_000;

/// Tolerance of a depth, as a fraction of it: a collision is certain then, and the depth only shows its size.
const DEPTH_RATIO: f64 = 0.02;

/// Search for the least distance between a part of the tool on its path and copies of a body.
pub struct Search<'s> {
    /// Sections of the part.
    pub sections: &'s [Section],
    /// Path, step by step.
    pub motions: &'s [Motion],
    /// Surface of the body.
    pub tree: &'s Tree,
    /// Rotations of its copies into the slot frame.
    pub turns: &'s [Rotation3<f64>],
}

/// Place where the least distance occurs: point of the path and point of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index of the step of the path.
    pub step: usize,
    /// Length travelled on the step, mm.
    pub way_mm: f64,
    /// Position of the middle of the tool's bottom.
    pub tool: Point,
    /// Point of the body.
    pub point: Point,
    /// Index of the copy of the body.
    pub copy: usize,
}

/// Result of a search for the least distance between a tool on its path and a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastDistance {
    /// Lower bound of the distance, and a distance that occurs, mm; infinite if there is no body.
    pub bounds_mm: [f64; 2],
    /// Place where that distance occurs; `None` if there is no body.
    pub place: Option<Place>,
    /// Number of pieces of path and body that the search has bounded.
    pub pieces: usize,
}

/// Interval of the path with a piece of the body.
#[derive(Clone, Copy)]
struct Piece {
    step: usize,
    middle_mm: f64,
    half_mm: f64,
    copy: usize,
    shape: Shape,
}

#[derive(Clone, Copy)]
enum Shape {
    Sphere(usize),
    /// Triangle in the slot frame.
    Triangle(Triangle),
}

struct BoundedPiece {
    least_mm: f64,
    halve_way: bool,
    piece: Piece,
}

impl Search<'_> {
    /// Least distance, exact to within `gap_mm`; if the tool is inside the body, the depth to within a fiftieth.
    pub fn least(&self, gap_mm: f64) -> LeastDistance {
        self.least_until(gap_mm, [f64::NEG_INFINITY, f64::INFINITY])
    }

    /// Least distance, as [`Search::least`], but ended as soon as a distance below the first limit is found, or the
    /// lower bound reaches the second one.
    pub fn least_until(&self, gap_mm: f64, [too_near_mm, enough_mm]: [f64; 2]) -> LeastDistance {
        let mut least = LeastDistance { bounds_mm: [f64::INFINITY; 2], place: None, pieces: 0 };
        let mut heap = BinaryHeap::new();
        for (step, motion) in self.motions.iter().enumerate() {
            let half_mm = motion.length_mm / 2.0;
            for (copy, root) in (0..self.turns.len()).filter_map(|copy| Some((copy, self.tree.root()?))) {
                let piece = Piece { step, middle_mm: half_mm, half_mm, copy, shape: self.shape(root, copy) };
                heap.push(self.bounded(piece, f64::NEG_INFINITY, &mut least));
            }
        }
        while let Some(nearest) = heap.pop() {
            let gap_mm = gap_mm.max(-least.bounds_mm[1] * DEPTH_RATIO);
            let is_decided = least.bounds_mm[1] < too_near_mm || nearest.least_mm >= enough_mm;
            if is_decided || nearest.least_mm >= least.bounds_mm[1] - gap_mm || least.pieces >= MOST_PIECES {
                least.bounds_mm[0] = nearest.least_mm;
                break;
            }
            for piece in self.halves(&nearest) {
                let half = self.bounded(piece, nearest.least_mm, &mut least);
                // What is no nearer than a distance found would never be examined.
                if half.least_mm < least.bounds_mm[1] {
                    heap.push(half);
                }
            }
        }
        least.bounds_mm[0] = least.bounds_mm[0].min(least.bounds_mm[1]);
        least
    }

    fn shape(&self, node: Node, copy: usize) -> Shape {
        match node {
            Node::Sphere(number) => Shape::Sphere(number),
            Node::Triangle(number) => {
                Shape::Triangle(self.tree.triangles()[number].map(|corner| self.turns[copy] * corner))
            }
        }
    }

    fn halves(&self, whole: &BoundedPiece) -> [Piece; 2] {
        let piece = whole.piece;
        if whole.halve_way {
            let half_mm = piece.half_mm / 2.0;
            return [-half_mm, half_mm].map(|by| Piece { middle_mm: piece.middle_mm + by, half_mm, ..piece });
        }
        let shapes = match &piece.shape {
            Shape::Sphere(number) => self.tree.sphere(*number).halves.map(|half| self.shape(half, piece.copy)),
            Shape::Triangle(corners) => halved(corners).map(Shape::Triangle),
        };
        shapes.map(|shape| Piece { shape, ..piece })
    }

    /// The piece with its bound, not below that of its parent; the distance at its middle may become the least so far.
    fn bounded(&self, piece: Piece, no_less_mm: f64, least: &mut LeastDistance) -> BoundedPiece {
        least.pieces += 1;
        let pose = self.motions[piece.step].at(piece.middle_mm);
        let (middle, radius_mm) = match &piece.shape {
            Shape::Sphere(number) => {
                let sphere = self.tree.sphere(*number);
                (self.turns[piece.copy] * sphere.centre, sphere.radius_mm)
            }
            Shape::Triangle(corners) => about(corners),
        };
        let across_mm = match &piece.shape {
            Shape::Sphere(_) => radius_mm,
            Shape::Triangle(corners) => {
                let square = corners.iter().map(|corner| (corner - middle).xy().norm_squared()).fold(0.0, f64::max);
                libm::sqrt(square)
            }
        };
        let mut found = BoundedPiece { least_mm: f64::INFINITY, halve_way: true, piece };
        for section in self.sections {
            let near = NearPoint::new(section, &(middle - pose.place));
            let mut sink_mm = radius_mm;
            if let Shape::Triangle(corners) = &piece.shape {
                let sinks_mm = corners.map(|corner| near.gradient.dot(&(middle - corner)));
                let lowest = (0..3).max_by(|a, b| sinks_mm[*a].total_cmp(&sinks_mm[*b])).unwrap_or(0);
                sink_mm = sinks_mm[lowest].max(0.0);
                for (point, distance_mm) in [
                    (middle, near.distance_mm),
                    (corners[lowest], NearPoint::new(section, &(corners[lowest] - pose.place)).distance_mm),
                ] {
                    if distance_mm < least.bounds_mm[1] {
                        let Piece { step, middle_mm: way_mm, copy, .. } = piece;
                        least.bounds_mm[1] = distance_mm;
                        least.place = Some(Place { step, way_mm, tool: pose.place, point, copy });
                    }
                }
            }
            let bound = near.bound(&pose, piece.half_mm, &Extent { radius_mm, across_mm, sink_mm });
            if bound.least_mm < found.least_mm {
                found.least_mm = bound.least_mm;
                found.halve_way = bound.way_mm > bound.piece_mm;
            }
        }
        found.least_mm = found.least_mm.max(no_less_mm);
        found
    }
}

/// Middle of a triangle, and its distance from the farthest corner.
fn about(corners: &Triangle) -> (Point, f64) {
    let middle = Point::from((corners[0].coords + corners[1].coords + corners[2].coords) / 3.0);
    let square = corners.iter().map(|corner| (corner - middle).norm_squared()).fold(0.0, f64::max);
    (middle, libm::sqrt(square))
}

/// Halves the triangle across its longest side.
fn halved(corners: &Triangle) -> [Triangle; 2] {
    let side = |k: usize| (corners[(k + 1) % 3] - corners[k]).norm_squared();
    let longest = (0..3).max_by(|a, b| side(*a).total_cmp(&side(*b))).unwrap_or(0);
    let [from, to, tip] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
    let between = nalgebra::center(&from, &to);
    [[from, between, tip], [between, to, tip]]
}

impl Ord for BoundedPiece {
    /// The lowest bound is the greatest.
    fn cmp(&self, other: &Self) -> Ordering {
        other.least_mm.total_cmp(&self.least_mm)
    }
}

impl PartialOrd for BoundedPiece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for BoundedPiece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for BoundedPiece {}
