//! A block with its edges along the axes, clamped at one of its faces: a thin wall, a plate, a bar.

use arcfeed_kinematics::vector::Vector;

use super::mesh::{TetMesh, TetMeshError, graded};

/// Ratio of the cell length at the clamp to that at the other end: the bending changes fast at the clamp.
const HELD_RATIO: f64 = 0.2;

/// Face of a block, perpendicular to one of the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Whether the face is at the higher coordinate of that axis; otherwise it is at the lower one.
    pub is_upper: bool,
}

impl Face {
    /// Graded position of a point along the face's axis in a row of cells, both from 0 to 1: cells at the face have a
    /// fifth of the length of those at the other end.
    pub(super) fn graded(self, at_ratio: f64, cells: usize) -> f64 {
        if self.is_upper {
            1.0 - graded(1.0 - at_ratio, cells, HELD_RATIO)
        } else {
            graded(at_ratio, cells, HELD_RATIO)
        }
    }

    /// Indices of the mesh's nodes in this face, for a mesh whose lattice has its axes along x, y and z.
    pub fn nodes(self, mesh: &TetMesh) -> Vec<usize> {
        let end = if self.is_upper { 2 * mesh.cells()[self.axis] } else { 0 };
        mesh.nodes_where(|place| place[self.axis] == end)
    }
}

/// Block with its edges along the axes, clamped at one face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClampedBlock {
    /// The lowest corner.
    pub lowest_mm: Vector,
    /// The highest corner.
    pub highest_mm: Vector,
    /// Clamped face.
    pub held: Face,
}

impl ClampedBlock {
    /// Mesh with these numbers of cells along the axes; cells at the clamp have a fifth of the length of those at the other end.
    ///
    /// # Errors
    /// An axis has no cells, or the block no length.
    pub fn mesh(&self, cells: [usize; 3]) -> Result<TetMesh, TetMeshError> {
        let part = |at: f64, axis: usize| {
            let even = at / cells[axis] as f64;
            if axis == self.held.axis { self.held.graded(even, cells[axis]) } else { even }
        };
        let place = |at: [f64; 3]| {
            [0, 1, 2].map(|axis: usize| {
                let part = part(at[axis], axis);
                self.lowest_mm[axis] * (1.0 - part) + self.highest_mm[axis] * part
            })
        };
        TetMesh::mapped(cells, |_| true, place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_face_can_be_held_and_cells_are_short_there() {
        for (axis, is_upper) in [(0, false), (1, true), (2, true)] {
            let block =
                ClampedBlock { lowest_mm: [1.0; 3], highest_mm: [4.0, 5.0, 6.0], held: Face { axis, is_upper } };
            let mesh = block.mesh([3, 3, 3]).unwrap();
            let held_mm = if is_upper { block.highest_mm[axis] } else { block.lowest_mm[axis] };
            let clamped = block.held.nodes(&mesh);
            assert_eq!(clamped.len(), 49);
            assert!(clamped.iter().all(|node| mesh.nodes_mm()[*node][axis] == held_mm));
            let off_mm = mesh.nodes_mm().iter().map(|node| (node[axis] - held_mm).abs());
            let first_mm = off_mm.filter(|off_mm| *off_mm > 1e-9).fold(f64::INFINITY, f64::min);
            // Cells have the lengths 0.2, 0.6 and 1; the first node is in the middle of the first.
            let length_mm = block.highest_mm[axis] - block.lowest_mm[axis];
            assert!((first_mm - length_mm / 18.0).abs() < 1e-12, "{first_mm}");
        }
    }
}
