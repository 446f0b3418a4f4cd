//! Closed surfaces of triangles, which enclose a solid.
//!
//! ```text
//! volume = sum over triangles of a . (b x c) / 6        (1)
//! ```
//!
//! A ray enters the solid where it meets a triangle from outside and leaves it where it meets one from inside. Which triangles a ray
//! meets is decided by the sign of one number for each edge, formed in the same order of its two ends for both triangles that
//! share it: a ray between two triangles meets exactly one of them. Rays stand aside of the lattice by parts of a
//! millionth of a step, so that edges and corners on round numbers are not met.
//!
//! Source: (1) the divergence theorem.

use std::collections::HashMap;
use std::fmt;

use arcfeed_kinematics::vector::{Vector, cross, dot};
use rayon::slice::ParallelSliceMut;

use super::dexel::{Dexel, Interval};
use super::frame::Frame;
use super::grid::Grid;
use super::lattice::Lattice;
use super::solid::{Block, InitialSolid, Solid};

/// By which part of a step rays stand aside, along columns and rows.
const ASIDE_RATIO: [f64; 2] = [1.37e-7, 2.71e-7];

/// Faces of a block by the numbers of its corners: bit 0 is set at the highest x, bit 1 at the highest y, bit 2 at the
/// highest z.
const BLOCK_TRIANGLES: [[usize; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];

/// Closed surface of triangles whose corners are counter-clockwise as seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices_mm: Vec<Vector>,
    triangles: Vec<[usize; 3]>,
}

/// Reason why triangles do not enclose a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeshError {
    /// There are no triangles.
    Empty,
    /// A corner of a triangle has a coordinate that is no finite number, or is the index of no vertex.
    NotANumber {
        /// Index of that triangle, from 0.
        triangle: usize,
    },
    /// Some edges have no triangle on their other side, so the surface is not closed.
    Open {
        /// Number of open edges.
        edges: usize,
        /// Both ends of one of the open edges.
        example_mm: [Vector; 2],
    },
    /// The triangles face inwards: their corners are clockwise as seen from outside.
    InsideOut,
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MeshError::Empty => write!(f, "the mesh has no triangles"),
            MeshError::NotANumber { triangle } => write!(f, "triangle {triangle} has a corner that is no point"),
            MeshError::Open { edges, example_mm: [a, b] } => write!(
                f,
                "the mesh is open: {edges} edges have no triangle on their other side, one from {a:?} to {b:?}; close it first"
            ),
            MeshError::InsideOut => write!(f, "the triangles of the mesh face inwards: turn them round first"),
        }
    }
}

impl std::error::Error for MeshError {}

impl Mesh {
    /// Mesh of triangles given by the indices of their corners; triangles with two equal corners are left out.
    ///
    /// # Errors
    /// The triangles do not enclose a volume. An index of no vertex counts as [`MeshError::NotANumber`].
    pub fn new(vertices_mm: Vec<Vector>, mut triangles: Vec<[usize; 3]>) -> Result<Self, MeshError> {
        let is_point = |vertex: &usize| vertices_mm.get(*vertex).is_some_and(|v| v.iter().all(|x| x.is_finite()));
        if let Some(triangle) = triangles.iter().position(|triangle| !triangle.iter().all(is_point)) {
            return Err(MeshError::NotANumber { triangle });
        }
        triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        if triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        let mut balance: HashMap<[usize; 2], i32> = HashMap::new();
        for [from, to] in triangles.iter().flat_map(edges) {
            let (edge, sense) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
            *balance.entry(edge).or_default() += sense;
        }
        let open = balance.iter().filter(|(_, balance)| **balance != 0).map(|(edge, _)| *edge);
        if let Some(example) = open.clone().min() {
            return Err(MeshError::Open { edges: open.count(), example_mm: example.map(|vertex| vertices_mm[vertex]) });
        }
        let mesh = Mesh { vertices_mm, triangles };
        if mesh.volume_mm3() > 0.0 { Ok(mesh) } else { Err(MeshError::InsideOut) }
    }

    /// Mesh of triangles given by their corners; corners at the same place are merged.
    ///
    /// # Errors
    /// As [`Mesh::new`].
    pub fn from_corners(corners: impl Iterator<Item = [Vector; 3]>) -> Result<Self, MeshError> {
        let mut numbers: HashMap<[u64; 3], usize> = HashMap::new();
        let mut vertices_mm = Vec::new();
        let mut number = |corner: Vector| {
            // -0 is 0.
            let key = corner.map(|x| (x + 0.0).to_bits());
            *numbers.entry(key).or_insert_with(|| {
                vertices_mm.push(corner);
                vertices_mm.len() - 1
            })
        };
        let triangles = corners.map(|triangle| triangle.map(&mut number)).collect();
        Mesh::new(vertices_mm, triangles)
    }

    /// Vertices of the mesh.
    pub fn vertices_mm(&self) -> &[Vector] {
        &self.vertices_mm
    }

    /// Triangles, each as the indices of its three vertices.
    pub fn triangles(&self) -> &[[usize; 3]] {
        &self.triangles
    }

    /// Positions of the three corners of each triangle.
    pub fn corners_mm(&self) -> impl ExactSizeIterator<Item = [Vector; 3]> + '_ {
        self.triangles.iter().map(|triangle| triangle.map(|vertex| self.vertices_mm[vertex]))
    }

    /// Enclosed volume. (1)
    pub fn volume_mm3(&self) -> f64 {
        self.corners_mm().map(|[a, b, c]| dot(a, cross(b, c)) / 6.0).sum()
    }

    /// Adds the crossings of rays with a triangle: number of the ray, coordinate along it,
    /// +1 where the ray leaves the solid, -1 where it enters.
    fn add_crossings(&self, triangle: &[usize; 3], rays: &Rays<'_>, found: &mut Vec<(usize, f64, i32)>) {
        let corners = triangle.map(|vertex| self.vertices_mm[vertex]);
        let [columns, rows] = [0, 1].map(|side| {
            let axis = rays.across[side];
            let of = corners.map(|corner| corner[axis]);
            let (low, high) = (of[0].min(of[1]).min(of[2]), of[0].max(of[1]).max(of[2]));
            let aside = ASIDE_RATIO[side] * rays.lattice.step_mm();
            rays.lattice.cells_between(axis, low - aside, high)
        });
        for row in rows {
            for column in columns.clone() {
                let at = [column, row];
                let point = [0, 1].map(|side| {
                    rays.lattice.center_mm(rays.across[side], at[side]) + ASIDE_RATIO[side] * rays.lattice.step_mm()
                });
                let weights = [[1, 2], [2, 0], [0, 1]]
                    .map(|[from, to]| self.beside([triangle[from], triangle[to]], rays.across, point));
                let sense = match weights.map(|weight| weight.is_sign_positive()) {
                    [true, true, true] => 1,
                    [false, false, false] => -1,
                    _ => continue,
                };
                let along = corners.map(|corner| corner[rays.axis]);
                let sum: f64 = weights.iter().sum();
                let mixed = (0..3).map(|n| weights[n] * along[n]).sum::<f64>() / sum;
                let (low, high) = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
                // A triangle on edge has no sum: the ray runs within it.
                let coordinate = if mixed.is_finite() { mixed.clamp(low, high) } else { low };
                found.push((row * rays.width + column, coordinate, sense));
            }
        }
    }

    /// On which side of an edge a ray stands, and how far: twice the area between them, never without a sign.
    fn beside(&self, [from, to]: [usize; 2], across: [usize; 2], point: [f64; 2]) -> f64 {
        let (first, second, sign) = if from < to { (from, to, 1.0) } else { (to, from, -1.0) };
        let arm = |vertex: usize| [0, 1].map(|side| self.vertices_mm[vertex][across[side]] - point[side]);
        let (a, b) = (arm(first), arm(second));
        // Adding 0 makes -0 one with 0.
        sign * (a[0] * b[1] - a[1] * b[0] + 0.0)
    }
}

/// The rays that triangles are met by.
struct Rays<'a> {
    lattice: &'a Lattice,
    axis: usize,
    across: [usize; 2],
    width: usize,
}

impl Solid for Mesh {
    fn bounds_mm(&self) -> [Vector; 2] {
        let corner = |choose: fn(f64, f64) -> f64| {
            [0, 1, 2].map(|axis| self.vertices_mm.iter().map(|v| v[axis]).reduce(choose).unwrap_or_default())
        };
        [corner(f64::min), corner(f64::max)]
    }

    fn grid(&self, lattice: &Lattice, axis: usize) -> Grid {
        let [width, height] = lattice.size(axis);
        let rays = Rays { lattice, axis, across: Lattice::across(axis), width };
        let mut crossings = Vec::new();
        for triangle in &self.triangles {
            self.add_crossings(triangle, &rays, &mut crossings);
        }
        crossings.par_sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut dexels = vec![Dexel::Empty; width * height];
        for on_ray in crossings.chunk_by(|a, b| a.0 == b.0) {
            if let Some(dexel) = on_ray.first().and_then(|(ray, ..)| dexels.get_mut(*ray)) {
                *dexel = wound(on_ray);
            }
        }
        Grid::of(lattice, axis, dexels)
    }
}

impl InitialSolid for Mesh {
    fn in_frame(&self, frame: &Frame) -> Box<dyn InitialSolid> {
        let vertices_mm = self.vertices_mm.iter().map(|vertex| frame.coordinates(*vertex)).collect();
        Box::new(Mesh { vertices_mm, triangles: self.triangles.clone() })
    }
}

impl InitialSolid for Block {
    fn in_frame(&self, frame: &Frame) -> Box<dyn InitialSolid> {
        let (low, high) = (self.lowest_mm, self.highest_mm);
        let corner = |number: usize| [0, 1, 2].map(|axis| if number >> axis & 1 == 0 { low[axis] } else { high[axis] });
        let corners = (0..8).map(|number| frame.coordinates(corner(number))).collect();
        match Mesh::new(corners, BLOCK_TRIANGLES.to_vec()) {
            Ok(mesh) => Box::new(mesh),
            // A block without a volume has no material in any frame.
            Err(_) => Box::new(Block { lowest_mm: low, highest_mm: low }),
        }
    }
}

/// Material on a ray from the places where surfaces cross it, in ascending order: it is where more surfaces were entered than left.
pub(super) fn wound(crossings: &[(usize, f64, i32)]) -> Dexel {
    let mut pieces: Vec<Interval> = Vec::new();
    let mut inside = 0;
    for (_, at_mm, sense) in crossings {
        let (before, after) = (inside, inside - sense);
        inside = after;
        match pieces.last_mut() {
            Some(last) if before > 0 && after <= 0 => last.to_mm = *at_mm,
            Some(last) if before <= 0 && after > 0 && last.to_mm == *at_mm => {}
            _ if before <= 0 && after > 0 => pieces.push(Interval::new(*at_mm, *at_mm)),
            _ => {}
        }
    }
    Dexel::new(pieces)
}

/// The edges of a triangle, in its sense.
fn edges([a, b, c]: &[usize; 3]) -> [[usize; 2]; 3] {
    [[*a, *b], [*b, *c], [*c, *a]]
}
