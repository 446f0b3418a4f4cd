//! The stock (workpiece as a tri-dexel model): three grids of rays that are cut together.

use std::fmt;

use super::grid::Grid;
use super::lattice::{Lattice, LatticeError};
use super::section::Sweep;
use super::solid::Solid;
use super::sweep::passes;
use super::tool::Tool;

/// Sweeps prepared at a time: bounds what a long list of them takes.
const SWEEPS_AT_A_TIME: usize = 1_024;

/// Workpiece as the intervals of material on rays along x, y and z (tri-dexel model).
#[derive(Clone, Debug)]
pub struct Stock {
    lattice: Lattice,
    grids: [Grid; 3],
    memory_max_bytes: usize,
}

/// Volume of the same material, measured once by each of the three grids of rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Volume by the rays along x, y and z, mm3.
    pub by_axis: [f64; 3],
}

/// Reason why a stock cannot be made or cut further.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StockError {
    /// The lattice of rays is invalid.
    Lattice(LatticeError),
    /// The stock takes more memory than allowed.
    Memory {
        /// Memory that the stock would take.
        needed_bytes: usize,
        /// Memory that the stock may take.
        allowed_bytes: usize,
    },
}

impl fmt::Display for StockError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StockError::Lattice(error) => write!(f, "{error}"),
            StockError::Memory { needed_bytes, allowed_bytes } => write!(
                f,
                "the stock takes {needed_bytes} bytes, more than the {allowed_bytes} it may: take a larger step between rays"
            ),
        }
    }
}

impl std::error::Error for StockError {}

impl From<LatticeError> for StockError {
    fn from(error: LatticeError) -> Self {
        StockError::Lattice(error)
    }
}

impl Volume {
    /// Mean of the three volumes.
    pub fn mean_mm3(&self) -> f64 {
        self.by_axis.iter().sum::<f64>() / 3.0
    }

    /// Difference between the largest and the smallest of the three volumes, mm3: an estimate of their error.
    pub fn spread_mm3(&self) -> f64 {
        let [a, b, c] = self.by_axis;
        a.max(b).max(c) - a.min(b).min(c)
    }
}

impl Stock {
    /// Stock of a solid, with rays `step_mm` apart in the box around it, which never takes more than
    /// `memory_max_bytes`.
    ///
    /// # Errors
    /// The solid has no extent, the step is not positive, or the rays alone take more than the memory allowed.
    pub fn new(solid: &dyn Solid, step_mm: f64, memory_max_bytes: usize) -> Result<Self, StockError> {
        let [lowest_mm, highest_mm] = solid.bounds_mm();
        Stock::on(&Lattice::new(lowest_mm, highest_mm, step_mm)?, solid, memory_max_bytes)
    }

    /// Stock of a solid on the rays of an existing lattice, so that two stocks can be compared.
    ///
    /// # Errors
    /// The rays take more than the memory allowed.
    pub fn on(lattice: &Lattice, solid: &dyn Solid, memory_max_bytes: usize) -> Result<Self, StockError> {
        let uncut = [0, 1, 2].map(|axis| Grid::bytes_uncut(lattice, axis));
        within(uncut.into_iter().fold(0, usize::saturating_add), memory_max_bytes)?;
        let stock =
            Stock { lattice: *lattice, grids: [0, 1, 2].map(|axis| solid.grid(lattice, axis)), memory_max_bytes };
        within(stock.memory_bytes(), memory_max_bytes)?;
        Ok(stock)
    }

    /// Lattice of the rays.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// The rays along x, y and z.
    pub fn grids(&self) -> &[Grid; 3] {
        &self.grids
    }

    /// Removes the material that the tool sweeps; returns the removed volume.
    ///
    /// # Errors
    /// The remaining intervals take more memory than allowed. Sweeps are cut 1024 at a time; those up to this point have been cut.
    pub fn cut(&mut self, tool: &Tool, sweeps: &[Sweep]) -> Result<Volume, StockError> {
        let mut removed = Volume { by_axis: [0.0; 3] };
        for sweeps in sweeps.chunks(SWEEPS_AT_A_TIME) {
            for (grid, removed_mm3) in self.grids.iter_mut().zip(&mut removed.by_axis) {
                *removed_mm3 += grid.cut(&passes(tool, sweeps, grid.axis()));
            }
            within(self.memory_bytes(), self.memory_max_bytes)?;
        }
        Ok(removed)
    }

    /// Volume of the remaining material.
    pub fn volume(&self) -> Volume {
        Volume { by_axis: [0, 1, 2].map(|axis: usize| self.grids[axis].volume_mm3()) }
    }

    /// Memory of the rays and of their intervals, bytes.
    pub fn memory_bytes(&self) -> usize {
        self.grids.iter().map(Grid::memory_bytes).sum()
    }
}

fn within(needed_bytes: usize, allowed_bytes: usize) -> Result<(), StockError> {
    if needed_bytes > allowed_bytes { Err(StockError::Memory { needed_bytes, allowed_bytes }) } else { Ok(()) }
}
