//! All rays of one direction.
//!
//! Rows are cut side by side on all cores. No ray is touched by two of them, and sums are formed row by row, then in the
//! order of the rows, so the number of threads does not show in any result.

use std::ops::Range;

use arcfeed_shared::kinematics::vector::Vector;
use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use rayon::slice::ParallelSliceMut;

use super::dexel::Dexel;
use super::lattice::Lattice;
use super::level::Losses;
use super::sweep::{Pass, Reach, RowCut};

/// The rays along one axis.
#[derive(Clone, Debug)]
pub struct Grid {
    axis: usize,
    lattice: Lattice,
    dexels: Vec<Dexel>,
    /// What the dexels have allocated.
    heap_bytes: usize,
}

/// What a cut does to a row: the length removed, and the bytes allocated before and after by the rays that were cut.
#[derive(Clone, Copy, Debug, Default)]
struct Removed {
    length_mm: f64,
    bytes_before: usize,
    bytes_after: usize,
}

impl Grid {
    /// Asks for the material of every ray; `on_ray` is told a point of it, with 0 as the coordinate along it.
    pub fn new(lattice: &Lattice, axis: usize, on_ray: impl Fn(Vector) -> Dexel + Sync) -> Self {
        let [width, height] = lattice.size(axis);
        let ray = |index: usize| on_ray(point_mm(lattice, axis, [index % width, index / width]));
        Grid::of(lattice, axis, (0..width * height).into_par_iter().map(ray).collect())
    }

    /// Of rays that are there already, row by row; rays that are missing are empty.
    pub fn of(lattice: &Lattice, axis: usize, mut dexels: Vec<Dexel>) -> Self {
        dexels.resize(lattice.size(axis).iter().product(), Dexel::Empty);
        let heap_bytes = dexels.iter().map(Dexel::heap_bytes).sum();
        Grid { axis, lattice: *lattice, dexels, heap_bytes }
    }

    /// 0, 1, 2 for rays along x, y, z.
    pub fn axis(&self) -> usize {
        self.axis
    }

    /// The rays, row by row.
    pub fn dexels(&self) -> &[Dexel] {
        &self.dexels
    }

    /// The ray at a column and a row.
    pub fn dexel(&self, column: usize, row: usize) -> Option<&Dexel> {
        let [width, _] = self.lattice.size(self.axis);
        self.dexels.get(row * width + column).filter(|_| column < width)
    }

    /// Length of all material times the area of a cell.
    pub fn volume_mm3(&self) -> f64 {
        let [width, _] = self.lattice.size(self.axis);
        let rows = self.dexels.chunks(width).map(|row| row.iter().map(Dexel::length_mm).sum::<f64>());
        rows.sum::<f64>() * self.lattice.area_mm2()
    }

    /// Bytes of the rays and of what they have allocated.
    pub fn memory_bytes(&self) -> usize {
        self.dexels.capacity() * size_of::<Dexel>() + self.heap_bytes
    }

    /// Takes what the passes sweep; answers its volume, mm3.
    pub fn cut(&mut self, passes: &[Pass<'_>]) -> f64 {
        let (axis, lattice) = (self.axis, self.lattice);
        let [width, _] = lattice.size(axis);
        let [column_axis, row_axis] = Lattice::across(axis);
        let rows: Vec<Range<usize>> = passes.iter().map(|pass| pass.rows(&lattice)).collect();
        let first = rows.iter().filter(|rows| !rows.is_empty()).map(|rows| rows.start).min().unwrap_or(0);
        let end = rows.iter().map(|rows| rows.end).max().unwrap_or(0).max(first);
        let cut_row = |(index, dexels): (usize, &mut [Dexel])| {
            let row = first + index;
            let row_mm = lattice.center_mm(row_axis, row);
            let mut removed = Removed::default();
            for (pass, _) in passes.iter().zip(&rows).filter(|(_, rows)| rows.contains(&row)) {
                if let Some(reach) = pass.reach(&lattice, row_mm) {
                    let column_mm = |column| lattice.center_mm(column_axis, column);
                    match pass.row_cut(row_mm) {
                        RowCut::Axial(mut row) => removed.lose(&reach, dexels, |column| row.losses(column_mm(column))),
                        RowCut::Layer(row) => removed.lose(&reach, dexels, |column| row.losses(column_mm(column))),
                        RowCut::Upright(mut row) => {
                            removed.lose(&reach, dexels, |column| row.losses(column_mm(column)))
                        }
                        RowCut::Rays(pass) => {
                            removed.cut(pass, &reach, dexels, |column| point_mm(&lattice, axis, [column, row]));
                        }
                    }
                }
            }
            removed
        };
        let touched = &mut self.dexels[first * width..end * width];
        let removed: Vec<Removed> = touched.par_chunks_mut(width).enumerate().map(cut_row).collect();
        let bytes = |bytes: fn(&Removed) -> usize| removed.iter().map(bytes).sum::<usize>();
        self.heap_bytes += bytes(|row| row.bytes_after);
        self.heap_bytes -= bytes(|row| row.bytes_before);
        removed.iter().map(|row| row.length_mm).sum::<f64>() * lattice.area_mm2()
    }
}

impl Removed {
    /// Takes from one row what its rays lose.
    fn lose(&mut self, reach: &Reach, dexels: &mut [Dexel], mut losses: impl FnMut(usize) -> Losses) {
        for column in reach.columns() {
            let Some(dexel) = dexels.get_mut(column) else { break };
            if !dexel.meets(&reach.along) {
                continue;
            }
            for loss in losses(column).into_iter().flatten() {
                if dexel.meets(&loss) {
                    self.bytes_before += dexel.heap_bytes();
                    self.length_mm += dexel.subtract(loss);
                    self.bytes_after += dexel.heap_bytes();
                }
            }
        }
    }

    /// Takes what a pass sweeps from one row.
    fn cut(&mut self, pass: &Pass<'_>, reach: &Reach, dexels: &mut [Dexel], point_mm: impl Fn(usize) -> Vector) {
        for column in reach.columns() {
            let Some(dexel) = dexels.get_mut(column) else { break };
            let point_mm = point_mm(column);
            if dexel.meets(&reach.along) && pass.may_cut(&point_mm, dexel) {
                self.bytes_before += dexel.heap_bytes();
                self.length_mm += pass.cut(point_mm, reach, dexel);
                self.bytes_after += dexel.heap_bytes();
            }
        }
    }
}

/// A point of the ray at a column and a row, 0 along it.
fn point_mm(lattice: &Lattice, axis: usize, at: [usize; 2]) -> Vector {
    let mut point_mm = [0.0; 3];
    for (across, cell) in Lattice::across(axis).into_iter().zip(at) {
        point_mm[across] = lattice.center_mm(across, cell);
    }
    point_mm
}
