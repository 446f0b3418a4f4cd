//! A block with its edges along the axes, held at one of its faces: a thin wall, a plate, a bar.

use arcfeed_shared::kinematics::vector::Vector;

use super::mesh::{Mesh, MeshError, graded};

/// Cells at the clamp over those at the other end: there the bending changes fast.
const HELD_RATIO: f64 = 0.2;

/// A face square to an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// At the higher end.
    pub is_upper: bool,
}

/// The block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// The lowest corner.
    pub lowest_mm: Vector,
    /// The highest corner.
    pub highest_mm: Vector,
    /// Where it is clamped.
    pub held: Face,
}

impl Slab {
    /// A mesh with cells along the axes, those at the clamp a fifth as long as those at the other end.
    ///
    /// # Errors
    /// No cells along an axis, or no length.
    pub fn mesh(&self, cells: [usize; 3]) -> Result<Mesh, MeshError> {
        let Face { axis: held, is_upper } = self.held;
        let part = |at: f64, axis: usize| {
            let even = at / cells[axis] as f64;
            match (axis == held, is_upper) {
                (false, _) => even,
                (true, false) => graded(even, cells[axis], HELD_RATIO),
                (true, true) => 1.0 - graded(1.0 - even, cells[axis], HELD_RATIO),
            }
        };
        let place = |at: [f64; 3]| {
            [0, 1, 2].map(|axis: usize| {
                let part = part(at[axis], axis);
                self.lowest_mm[axis] * (1.0 - part) + self.highest_mm[axis] * part
            })
        };
        Mesh::mapped(cells, |_| true, place)
    }

    /// Nodes of such a mesh that are in its clamp.
    pub fn clamped(&self, mesh: &Mesh) -> Vec<usize> {
        let Face { axis, is_upper } = self.held;
        let end = if is_upper { 2 * mesh.cells()[axis] } else { 0 };
        mesh.nodes_where(|place| place[axis] == end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_face_can_be_held_and_cells_are_short_there() {
        for (axis, is_upper) in [(0, false), (1, true), (2, true)] {
            let slab = Slab { lowest_mm: [1.0; 3], highest_mm: [4.0, 5.0, 6.0], held: Face { axis, is_upper } };
            let mesh = slab.mesh([3, 3, 3]).unwrap();
            let held_mm = if is_upper { slab.highest_mm[axis] } else { slab.lowest_mm[axis] };
            let clamped = slab.clamped(&mesh);
            assert_eq!(clamped.len(), 49);
            assert!(clamped.iter().all(|node| mesh.nodes_mm()[*node][axis] == held_mm));
            let off_mm = mesh.nodes_mm().iter().map(|node| (node[axis] - held_mm).abs());
            let first_mm = off_mm.filter(|off_mm| *off_mm > 1e-9).fold(f64::INFINITY, f64::min);
            // Cells are as 0.2, 0.6 and 1; the first node is in the middle of the first.
            let length_mm = slab.highest_mm[axis] - slab.lowest_mm[axis];
            assert!((first_mm - length_mm / 18.0).abs() < 1e-12, "{first_mm}");
        }
    }
}
