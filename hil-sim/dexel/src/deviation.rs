//! Heights of a stock along an axis, and their deviation from those of another stock (tri-dexel model) on the same lattice.

use std::fmt;
use std::io::{self, Write};

use super::dexel::Interval;
use super::lattice::Lattice;
use super::workpiece::Stock;

/// Heights (upper ends of the material, mm), or differences of heights, of all rays along one axis, by column and row.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    axis: usize,
    lattice: Lattice,
    heights_mm: Vec<Option<f64>>,
}

/// Statistics of the heights, or differences of heights, of a [`HeightMap`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Number of rays with a height; rays without material have none.
    pub rays: usize,
    /// The lowest height, mm.
    pub min_mm: f64,
    /// The highest height, mm.
    pub max_mm: f64,
    /// Root mean square of the heights, mm.
    pub rms_mm: f64,
}

/// Error of a comparison of two height maps: they belong to different axes or to different lattices of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OtherLattice;

impl fmt::Display for OtherLattice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "heights can only be compared along the same axis on the same lattice")
    }
}

impl std::error::Error for OtherLattice {}

impl HeightMap {
    /// Coordinates of the upper ends of the material along an axis (0, 1, 2 for x, y, z); `None` for rays without material.
    pub fn new(stock: &Stock, axis: usize) -> Self {
        let axis = axis % 3;
        let top = |extent: Interval| extent.to_mm;
        let heights_mm = stock.grids()[axis].dexels().iter().map(|dexel| dexel.extent().map(top)).collect();
        HeightMap { axis, lattice: *stock.lattice(), heights_mm }
    }

    /// Difference of this map's heights and those of `reference`: positive for excess material, negative for missing material.
    /// `None` for rays without material in either of the two stocks.
    ///
    /// # Errors
    /// The maps belong to different axes or lattices, so that their rays do not correspond.
    pub fn above(&self, reference: &HeightMap) -> Result<HeightMap, OtherLattice> {
        if self.axis != reference.axis || self.lattice != reference.lattice {
            return Err(OtherLattice);
        }
        let pairs = self.heights_mm.iter().zip(&reference.heights_mm);
        let heights_mm = pairs.map(|(own, other)| Some((*own)? - (*other)?)).collect();
        Ok(HeightMap { heights_mm, ..*self })
    }

    /// All heights, mm, row by row; `None` for rays without material.
    pub fn heights_mm(&self) -> &[Option<f64>] {
        &self.heights_mm
    }

    /// Statistics of the heights; `None` if no ray has a height.
    pub fn figures(&self) -> Option<Figures> {
        let heights: Vec<f64> = self.heights_mm.iter().copied().flatten().collect();
        let squares: f64 = heights.iter().map(|height_mm| height_mm * height_mm).sum();
        Some(Figures {
            rays: heights.len(),
            min_mm: heights.iter().copied().reduce(f64::min)?,
            max_mm: heights.iter().copied().reduce(f64::max)?,
            rms_mm: libm::sqrt(squares / heights.len() as f64),
        })
    }

    /// Writes CSV: a header, then for each ray with a height a line `column coordinate, row coordinate, height`, mm.
    ///
    /// # Errors
    /// Writing to `file` fails.
    pub fn write_csv<W: Write>(&self, file: W) -> io::Result<()> {
        let mut file = io::BufWriter::new(file);
        let [column_axis, row_axis] = Lattice::across(self.axis);
        let name = |axis: usize| ["x", "y", "z"][axis];
        writeln!(file, "{}_mm,{}_mm,{}_mm", name(column_axis), name(row_axis), name(self.axis))?;
        let [width, _] = self.lattice.size(self.axis);
        for (index, height_mm) in self.heights_mm.iter().enumerate() {
            if let Some(height_mm) = height_mm {
                let column_mm = self.lattice.center_mm(column_axis, index % width);
                let row_mm = self.lattice.center_mm(row_axis, index / width);
                writeln!(file, "{column_mm:.6},{row_mm:.6},{height_mm:.6}")?;
            }
        }
        file.flush()
    }
}
