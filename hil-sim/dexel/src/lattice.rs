//! Positions of the rays of a tri-dexel model: through the centres of cubic cells, in the three directions of the axes.
//!
//! Rays of all three directions meet in the cells' centres, the *nodes*. A ray along axis k stands at a column, counted
//! along axis k + 1, and a row, counted along axis k + 2 (mod 3).

use std::fmt;

/// Cells a lattice may have along one axis, so that no count of rays overflows.
const CELLS_MAX: f64 = 65_536.0;

/// Part of a cell that a box may be over a whole number of cells: rounding, no material.
const OVERHANG_RATIO: f64 = 1e-9;

/// Lattice of cubic cells in a box; rays along x, y and z pass through the centres of the cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    lowest_mm: [f64; 3],
    step_mm: f64,
    cells: [usize; 3],
}

/// Reason why a lattice cannot be built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LatticeError {
    /// The edge length of a cell is not a positive number.
    Step {
        /// Rejected edge length of a cell.
        step_mm: f64,
    },
    /// The box has no extent along an axis, or more than 65 536 cells.
    Box {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// Length of the box along the axis.
        length_mm: f64,
    },
}

impl fmt::Display for LatticeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LatticeError::Step { step_mm } => write!(f, "a step of {step_mm} mm between rays is none"),
            LatticeError::Box { axis, length_mm } => {
                let name = ["x", "y", "z"].get(*axis).unwrap_or(&"?");
                write!(f, "{length_mm} mm along {name} are none or more than {CELLS_MAX} cells of this step")
            }
        }
    }
}

impl std::error::Error for LatticeError {}

impl Lattice {
    /// Cells with edges of `step_mm` from the lowest corner to the highest; the last cells reach beyond the box if
    /// `step_mm` does not divide it.
    ///
    /// # Errors
    /// The step is not positive, or the box is empty or has more than 65 536 cells along an axis.
    pub fn new(lowest_mm: [f64; 3], highest_mm: [f64; 3], step_mm: f64) -> Result<Self, LatticeError> {
        if !(step_mm > 0.0 && step_mm.is_finite()) {
            return Err(LatticeError::Step { step_mm });
        }
        let mut cells = [0; 3];
        for axis in 0..3 {
            let length_mm = highest_mm[axis] - lowest_mm[axis];
            let count = (length_mm / step_mm - OVERHANG_RATIO).ceil();
            if !((1.0..=CELLS_MAX).contains(&count) && lowest_mm[axis].is_finite()) {
                return Err(LatticeError::Box { axis, length_mm });
            }
            cells[axis] = count as usize;
        }
        Ok(Lattice { lowest_mm, step_mm, cells })
    }

    /// Edge length of a cell, which is also the distance of neighbouring rays.
    pub fn step_mm(&self) -> f64 {
        self.step_mm
    }

    /// Cross-section that one ray represents, mm2: a face of a cell.
    pub fn area_mm2(&self) -> f64 {
        self.step_mm * self.step_mm
    }

    /// Number of cells along x, y and z.
    pub fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// Corner of the lattice with the lowest x, y and z.
    pub fn lowest_mm(&self) -> [f64; 3] {
        self.lowest_mm
    }

    /// For rays along `axis`: the axis along which their columns are counted, and the one along which their rows are counted.
    pub fn across(axis: usize) -> [usize; 2] {
        [(axis + 1) % 3, (axis + 2) % 3]
    }

    /// Numbers of columns and of rows of the rays along `axis`.
    pub fn size(&self, axis: usize) -> [usize; 2] {
        Self::across(axis).map(|across| self.cells[across])
    }

    /// Coordinate along `axis` of the centre of the cell with this index.
    #[inline]
    pub fn center_mm(&self, axis: usize, cell: usize) -> f64 {
        self.centers_mm(axis)(cell)
    }

    /// Function that returns the coordinate along `axis` of the centre of the cell with a given index.
    pub fn centers_mm(&self, axis: usize) -> impl Fn(usize) -> f64 + Copy {
        let (lowest_mm, step_mm) = (self.lowest_mm[axis], self.step_mm);
        // No lattice has as many cells as a u32 holds, and that is sooner a float.
        move |cell| lowest_mm + (f64::from(cell as u32) + 0.5) * step_mm
    }

    /// Indices of the cells along `axis` whose centres lie between two coordinates, both included.
    pub fn cells_between(&self, axis: usize, from_mm: f64, to_mm: f64) -> std::ops::Range<usize> {
        let place = |at_mm: f64| (at_mm - self.lowest_mm[axis]) / self.step_mm - 0.5;
        // A cast from float to whole number truncates and saturates: it is the next one down, 0 below that.
        let (from, to) = (place(from_mm), place(to_mm));
        let below = from as usize;
        let first = below.saturating_add(usize::from((below as f64) < from));
        let end = if to >= 0.0 { (to as usize).saturating_add(1) } else { 0 };
        first.min(self.cells[axis])..end.min(self.cells[axis]).max(first.min(self.cells[axis]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cover_the_box() {
        let lattice = Lattice::new([1.0, 2.0, 3.0], [2.0, 4.05, 3.1], 0.1).unwrap();
        assert_eq!(lattice.cells(), [10, 21, 1]);
        assert!((lattice.center_mm(0, 9) - 1.95).abs() < 1e-12);
        assert_eq!(lattice.size(0), [21, 1]);
        assert_eq!(lattice.size(1), [1, 10]);
    }

    #[test]
    fn a_range_has_the_centres_in_it() {
        let lattice = Lattice::new([0.0; 3], [1.0; 3], 0.25).unwrap();
        for (from_mm, to_mm, range) in [
            (-9.0, 9.0, 0..4),
            (0.2, 0.4, 1..2),
            (0.125, 0.125, 0..1),
            (0.2, 0.3, 1..1),
            (2.0, 3.0, 4..4),
            (-2.0, -1.0, 0..0),
        ] {
            assert_eq!(lattice.cells_between(0, from_mm, to_mm), range, "{from_mm} {to_mm}");
        }
    }

    #[test]
    fn nonsense_is_refused() {
        let step = |step_mm| Lattice::new([0.0; 3], [1.0; 3], step_mm);
        assert!(matches!(step(0.0), Err(LatticeError::Step { .. })));
        assert!(matches!(step(f64::NAN), Err(LatticeError::Step { .. })));
        assert!(matches!(step(1e-6), Err(LatticeError::Box { axis: 0, .. })));
        assert!(matches!(Lattice::new([0.0; 3], [1.0, -1.0, 1.0], 0.1), Err(LatticeError::Box { axis: 1, .. })));
    }
}
