//! Mapping from displacements of nodes to unknowns: clamped nodes, coupled nodes, and the numbering of the rest.
//!
//! ```text
//! u = T x,   K = sum of T_e' K_e T_e over the elements, M likewise                (1)
//! ```
//!
//! u has three displacements per node. A row of T is empty if its node is clamped, has one entry if it is free, and
//! more if it follows another node. One mesh may have two such T, the real and the imaginary part of a wave around a
//! disk; then both parts add up.

use super::element::{Mass, Stiffness};
use super::mesh::TetMesh;
use super::order::reverse_cuthill_mckee;
use super::sparse::Sparse;

/// Entries of a row of T: unknown and coefficient.
pub type MappingRow = Vec<(usize, f64)>;

/// Mapping T from the unknowns of the equations to the displacements of the nodes; for a wave around a disk in two
/// parts, real and imaginary.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknowns {
    parts: Vec<Vec<MappingRow>>,
    count: usize,
}

/// Numbers the unknown nodes so that nodes of one element have near numbers. Each node gets the number of its leader,
/// `None` without one; a leader leads itself.
pub fn numbers(mesh: &TetMesh, leaders: &[Option<usize>]) -> Vec<Option<usize>> {
    let mut neighbours = vec![Vec::new(); leaders.len()];
    for element in mesh.elements() {
        for a in element.iter().filter_map(|node| leaders[*node]) {
            neighbours[a].extend(element.iter().filter_map(|node| leaders[*node]));
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    let places = reverse_cuthill_mckee(&neighbours);
    let mut in_order: Vec<usize> = (0..leaders.len()).filter(|node| leaders[*node] == Some(*node)).collect();
    in_order.sort_by_key(|node| places[*node]);
    let mut numbers = vec![None; leaders.len()];
    for (number, node) in in_order.into_iter().enumerate() {
        numbers[node] = Some(number);
    }
    leaders.iter().map(|leader| leader.and_then(|leader| numbers[leader])).collect()
}

impl Unknowns {
    /// Unknowns of a mesh with clamped nodes; all others are free.
    pub fn clamped(mesh: &TetMesh, clamped: &[usize]) -> Self {
        let mut leaders: Vec<Option<usize>> = (0..mesh.nodes_mm().len()).map(Some).collect();
        for node in clamped {
            leaders[*node] = None;
        }
        let row = |(number, axis): (Option<usize>, usize)| {
            number.map(|number| (3 * number + axis, 1.0)).into_iter().collect()
        };
        let numbers = numbers(mesh, &leaders);
        let count = 3 * numbers.iter().flatten().count();
        let rows = numbers.into_iter().flat_map(|number| (0..3).map(move |axis| (number, axis))).map(row).collect();
        Unknowns { parts: vec![rows], count }
    }

    /// Unknowns with the given rows of T, three to a node, for each part.
    pub fn from_rows(parts: Vec<Vec<MappingRow>>, count: usize) -> Self {
        Unknowns { parts, count }
    }

    /// Number of unknowns.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Displacements u = T x of one part, by nodes.
    pub fn displacements(&self, part: usize, x: &[f64]) -> Vec<[f64; 3]> {
        let value = |row: &MappingRow| row.iter().map(|(unknown, coefficient)| coefficient * x[*unknown]).sum();
        self.parts[part].chunks_exact(3).map(|rows| std::array::from_fn(|axis| value(&rows[axis]))).collect()
    }

    /// Stiffness and mass matrix of the whole mesh (1).
    pub fn assemble(&self, mesh: &TetMesh, elements: &[(Stiffness, Mass)]) -> (Sparse, Sparse) {
        let (mut k_rows, mut m_rows) = (vec![Vec::new(); self.count], vec![Vec::new(); self.count]);
        for rows in &self.parts {
            for (nodes, (k, m)) in mesh.elements().iter().zip(elements) {
                for (a, node) in nodes.iter().enumerate() {
                    for (b, other) in nodes.iter().enumerate() {
                        for (i, j) in (0..9).map(|ij| (ij / 3, ij % 3)) {
                            let (row, column) = (&rows[3 * node + i], &rows[3 * other + j]);
                            spread(row, column, k[(3 * a + i, 3 * b + j)], &mut k_rows);
                            if i == j {
                                spread(row, column, m[(a, b)], &mut m_rows);
                            }
                        }
                    }
                }
            }
        }
        (Sparse::from_rows(k_rows), Sparse::from_rows(m_rows))
    }
}

/// Adds an entry between two displacements to all pairs of their unknowns, in the lower triangle.
fn spread(row: &MappingRow, column: &MappingRow, value: f64, into: &mut [MappingRow]) {
    for (i, of_row) in row {
        for (j, of_column) in column {
            if j <= i {
                into[*i].push((*j, of_row * of_column * value));
            }
        }
    }
}
