//! Meshes of ten-node tetrahedra: a lattice of hexahedra, six tetrahedra each, mapped to a shape by a function.
//!
//! All nodes are on the lattice of half cells: corners of cells, the middles of their edges and of the diagonals across
//! faces and cells. So neighbours share the nodes between them, and faces on opposite sides have the same pattern. A
//! cell is divided along the diagonal between two corners: one tetrahedron for each order of the three axes along the
//! path (H. Freudenthal, Annals of Mathematics 43, 1942; often named after Kuhn). Neighbours are mirror images: a plate
//! has the same stiffness in both directions, and bends more freely than with parallel diagonals.

use std::fmt;

use nalgebra::Vector3;

use super::element::jacobian;
use super::tetrahedron::{EDGES, NODES, fourteen_points, nodes};

/// Point of the mesh's lattice, in half cells along its three axes from the lowest corner.
pub type HalfCells = [usize; 3];

/// Mesh of tetrahedra with ten nodes each.
#[derive(Clone, Debug, PartialEq)]
pub struct TetMesh {
    nodes_mm: Vec<[f64; 3]>,
    places: Vec<HalfCells>,
    elements: Vec<[usize; NODES]>,
    cells: [usize; 3],
}

/// Reason why a mesh cannot be built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TetMeshError {
    /// The lattice has no cells, or none is kept.
    Empty,
    /// The mapping function folds an element: at one of its nodes the determinant is not positive.
    Folded {
        /// The element, counted from 0.
        element: usize,
    },
}

impl fmt::Display for TetMeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TetMeshError::Empty => write!(f, "a mesh without elements"),
            TetMeshError::Folded { element } => {
                write!(f, "element {element} is folded: a shape too strongly bent for its mesh")
            }
        }
    }
}

impl std::error::Error for TetMeshError {}

/// The orders of three axes, even ones first.
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// Graded position of a point in a row of cells, both from 0 to 1: the first cell has `first_ratio` of the length of
/// the last, with linear change between.
pub fn graded(at_ratio: f64, cells: usize, first_ratio: f64) -> f64 {
    let at = at_ratio * cells as f64;
    let before = |cell: f64| {
        let sum = cell * (cell - 1.0) / (2.0 * (cells as f64 - 1.0).max(1.0));
        cell + (first_ratio - 1.0) * (cell - sum)
    };
    let cell = at.floor();
    let (low, high) = (before(cell), before(cell + 1.0));
    (low + (high - low) * (at - cell)) / before(cells as f64)
}

/// Nodes of one tetrahedron of a cell, in half cells; cells with odd numbers are mirrored.
fn tetrahedron(cell: [usize; 3], order: usize) -> [HalfCells; NODES] {
    let is_mirrored = cell.map(|c| c % 2 == 1);
    let mut corners = [[0; 3]; 4];
    for (step, axis) in ORDERS[order].into_iter().enumerate() {
        for corner in &mut corners[step + 1..] {
            corner[axis] = 2;
        }
    }
    // An odd order is a mirror image, and so is a cell mirrored once or thrice.
    if (order >= 3) != (is_mirrored.iter().filter(|m| **m).count() % 2 == 1) {
        corners.swap(1, 2);
    }
    let corners = corners.map(|corner| {
        std::array::from_fn(|axis| 2 * cell[axis] + if is_mirrored[axis] { 2 - corner[axis] } else { corner[axis] })
    });
    let mut nodes: [HalfCells; NODES] = [corners[0]; NODES];
    nodes[..4].copy_from_slice(&corners);
    for (edge, [i, j]) in EDGES.into_iter().enumerate() {
        nodes[4 + edge] = std::array::from_fn(|axis| (corners[i][axis] + corners[j][axis]) / 2);
    }
    nodes
}

impl TetMesh {
    /// Mesh of the cells that `keep` selects in a lattice of `cells`; `map` gives the position of each node. `map`
    /// takes a point in cells, from zero to `cells`, returns millimetres, and must not mirror.
    ///
    /// # Errors
    /// No cell is left, or an element is folded.
    pub fn mapped(
        cells: [usize; 3],
        keep: impl Fn([usize; 3]) -> bool,
        map: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Result<TetMesh, TetMeshError> {
        TetMesh::with_ends(2 * cells[0] + 1, cells, keep, map)
    }

    /// Mesh of a lattice that closes along its first axis: the end is the beginning.
    ///
    /// # Errors
    /// The same as for [`Self::mapped`].
    pub fn ring(
        cells: [usize; 3],
        keep: impl Fn([usize; 3]) -> bool,
        map: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Result<TetMesh, TetMeshError> {
        TetMesh::with_ends(2 * cells[0], cells, keep, map)
    }

    /// Mesh with `around` different points along the first axis.
    fn with_ends(
        around: usize,
        cells: [usize; 3],
        keep: impl Fn([usize; 3]) -> bool,
        map: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Result<TetMesh, TetMeshError> {
        let size = [around, 2 * cells[1] + 1, 2 * cells[2] + 1];
        let mut numbers = vec![usize::MAX; size.iter().product()];
        let mut mesh = TetMesh { nodes_mm: Vec::new(), places: Vec::new(), elements: Vec::new(), cells };
        for index in 0..cells.iter().product() {
            let cell = [index % cells[0], index / cells[0] % cells[1], index / (cells[0] * cells[1])];
            if !keep(cell) {
                continue;
            }
            for order in 0..ORDERS.len() {
                mesh.elements.push(tetrahedron(cell, order).map(|[x, y, z]| {
                    let place = [x % around, y, z];
                    let number = &mut numbers[(z * size[1] + y) * around + place[0]];
                    if *number == usize::MAX {
                        *number = mesh.places.len();
                        mesh.places.push(place);
                        mesh.nodes_mm.push(map(place.map(|half| half as f64 / 2.0)));
                    }
                    *number
                }));
            }
        }
        mesh.checked()
    }

    /// Mesh of a box from the origin.
    ///
    /// # Errors
    /// No cells along an axis, or no length.
    pub fn block(edges_mm: [f64; 3], cells: [usize; 3]) -> Result<TetMesh, TetMeshError> {
        TetMesh::mapped(
            cells,
            |_| true,
            |at| std::array::from_fn(|axis| edges_mm[axis] * at[axis] / cells[axis] as f64),
        )
    }

    fn checked(self) -> Result<TetMesh, TetMeshError> {
        if self.elements.is_empty() {
            return Err(TetMeshError::Empty);
        }
        let is_folded = |element: &usize| {
            let nodes_mm = self.nodes_of_mm(*element);
            !nodes().iter().all(|place| jacobian(&nodes_mm, *place).determinant() > 0.0)
        };
        match (0..self.elements.len()).find(is_folded) {
            Some(element) => Err(TetMeshError::Folded { element }),
            None => Ok(self),
        }
    }

    /// Positions of the nodes.
    pub fn nodes_mm(&self) -> &[[f64; 3]] {
        &self.nodes_mm
    }

    /// Positions of the nodes on the lattice, in half cells.
    pub fn places(&self) -> &[HalfCells] {
        &self.places
    }

    /// Indices of the nodes of each element, in the order of [`super::tetrahedron`].
    pub fn elements(&self) -> &[[usize; NODES]] {
        &self.elements
    }

    /// Numbers of cells of the lattice along its axes.
    pub fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// Positions of an element's nodes.
    pub fn nodes_of_mm(&self, element: usize) -> [[f64; 3]; NODES] {
        self.elements[element].map(|node| self.nodes_mm[node])
    }

    /// Lowest and highest corner of a box around all nodes.
    pub fn bounds_mm(&self) -> [[f64; 3]; 2] {
        let corner = |choose: fn(f64, f64) -> f64| {
            let of = |axis: usize| self.nodes_mm.iter().map(|node| node[axis]).reduce(choose);
            [0, 1, 2].map(|axis| of(axis).unwrap_or_default())
        };
        [corner(f64::min), corner(f64::max)]
    }

    /// Largest of the elements' smallest altitudes, about the thickness of a wall of one cell. Up to this distance
    /// outside, displacements are about as exact as inside (docs/fe.md).
    pub fn thickness_mm(&self) -> f64 {
        let altitude_mm = |element: usize| {
            let corners: [Vector3<f64>; 4] =
                std::array::from_fn(|n| Vector3::from(self.nodes_mm[self.elements[element][n]]));
            let twice_mm2 = |[a, b, c]: [usize; 3]| (corners[b] - corners[a]).cross(&(corners[c] - corners[a]));
            let six_mm3 = (corners[3] - corners[0]).dot(&twice_mm2([0, 1, 2]));
            let faces = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
            libm::fabs(six_mm3) / faces.into_iter().map(|face| twice_mm2(face).norm()).fold(0.0, f64::max)
        };
        (0..self.elements.len()).map(altitude_mm).fold(0.0, f64::max)
    }

    /// Volume of the mesh, with bent edges of the elements taken into account.
    pub fn volume_mm3(&self) -> f64 {
        let of = |element| {
            let nodes_mm = self.nodes_of_mm(element);
            let parts = fourteen_points().map(|(place, weight)| weight * jacobian(&nodes_mm, place).determinant());
            parts.iter().sum::<f64>()
        };
        (0..self.elements.len()).map(of).sum()
    }

    /// Indices of the nodes whose lattice points satisfy a condition.
    pub fn nodes_where(&self, wanted: impl Fn(HalfCells) -> bool) -> Vec<usize> {
        (0..self.places.len()).filter(|node| wanted(self.places[*node])).collect()
    }
}
