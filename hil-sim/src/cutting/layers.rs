//! The workpiece as layers one above the other, square to the tool's axis.

use crate::stock::lattice::LatticeError;
use crate::stock::solid::Solid;
use crate::stock::workpiece::Stock;

use super::layer::Layer;

/// Part of a layer that a solid may be higher than a whole number of them: rounding.
const WHOLE_RATIO: f64 = 1e-9;

/// Part of a layer within which a height is on its border: rounding.
const BORDER_RATIO: f64 = 1e-6;

/// Part of a layer by which a level may be off its border: levels are rounded to a program's last digit, layers are not.
pub const LEVEL_RATIO: f64 = 0.02;

/// Layers that are a mistake in their height.
const LAYERS_MAX: f64 = 65_536.0;

/// Layers of equal height.
#[derive(Clone, Debug)]
pub struct Layers {
    lowest_mm: f64,
    rise_mm: f64,
    layers: Vec<Layer>,
    extent_mm: Option<[[f64; 2]; 2]>,
}

/// A height of a tool, and what turns there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// Their middle above the tip.
    pub height_mm: f64,
    /// 0 without inner edges.
    pub inner_mm: f64,
    /// From the spindle's axis to the outermost.
    pub outer_mm: f64,
}

impl Layers {
    /// These, from a height upwards.
    pub fn new(lowest_mm: f64, rise_mm: f64, layers: Vec<Layer>) -> Self {
        let extent_mm = layers.iter().map(Layer::extent_mm).reduce(|[a, b], [c, d]| {
            [[0, 1].map(|axis: usize| a[axis].min(c[axis])), [0, 1].map(|axis: usize| b[axis].max(d[axis]))]
        });
        Layers { lowest_mm, rise_mm, layers, extent_mm }
    }

    /// So many copies of a layer, from a height upwards.
    pub fn alike(layer: &Layer, lowest_mm: f64, rise_mm: f64, count: usize) -> Self {
        Layers::new(lowest_mm, rise_mm, vec![layer.clone(); count])
    }

    /// All cells of a stock along `axis`: 0, 1, 2 for x, y, z. The planes have the two axes that follow it.
    pub fn of(stock: &Stock, axis: usize) -> Self {
        let lattice = stock.lattice();
        let cell = |cell| Layer::of(stock, axis, lattice.center_mm(axis, cell));
        Layers::new(lattice.lowest_mm()[axis], lattice.step_mm(), (0..lattice.cells()[axis]).map(cell).collect())
    }

    /// A solid along `axis`, from its top downwards until it is covered; each layer is as the solid is in the layer's middle.
    ///
    /// # Errors
    /// There are no such layers or rays, or too many.
    pub fn of_solid(solid: &dyn Solid, axis: usize, rise_mm: f64, step_mm: f64) -> Result<Self, LatticeError> {
        let [lowest_mm, highest_mm] = solid.bounds_mm();
        let length_mm = highest_mm[axis] - lowest_mm[axis];
        let count = libm::ceil(length_mm / rise_mm - WHOLE_RATIO);
        if !(1.0..=LAYERS_MAX).contains(&count) {
            return Err(LatticeError::Box { axis, length_mm });
        }
        let lowest_mm = highest_mm[axis] - count * rise_mm;
        let layer = |n: usize| Layer::at(solid, axis, lowest_mm + (n as f64 + 0.5) * rise_mm, step_mm);
        let layers: Result<Vec<Layer>, LatticeError> = (0..count as usize).map(layer).collect();
        Ok(Layers::new(lowest_mm, rise_mm, layers?))
    }

    /// The lowest and the highest corner of all layers, in their plane.
    pub fn extent_mm(&self) -> Option<[[f64; 2]; 2]> {
        self.extent_mm
    }

    /// How high each of them is.
    pub fn rise_mm(&self) -> f64 {
        self.rise_mm
    }

    /// Height of the middle of one.
    pub fn middle_mm(&self, layer: usize) -> f64 {
        self.lowest_mm + (layer as f64 + 0.5) * self.rise_mm
    }

    /// All, from the lowest upwards.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// All, to be cut.
    pub fn layers_mut(&mut self) -> &mut [Layer] {
        &mut self.layers
    }

    /// Which one is at a height, counted on below the lowest and above the highest; a height on the border of two, but for
    /// rounding, is in the upper one.
    pub fn nth(&self, height_mm: f64) -> i64 {
        libm::floor((height_mm - self.lowest_mm) / self.rise_mm + BORDER_RATIO) as i64
    }

    /// A height as a part of such a layer: 0 at its bottom, 1 at its top, beyond that outside of it.
    pub fn part_ratio(&self, nth: i64, height_mm: f64) -> f64 {
        let ratio = (height_mm - self.lowest_mm) / self.rise_mm - nth as f64;
        let border = libm::round(ratio);
        if libm::fabs(ratio - border) <= BORDER_RATIO { border } else { ratio }
    }

    /// Where such a layer is in [`Layers::layers`].
    pub fn place(&self, nth: i64) -> Option<usize> {
        usize::try_from(nth).ok().filter(|index| *index < self.layers.len())
    }

    /// Where the layer at a height is in [`Layers::layers`].
    pub fn index(&self, height_mm: f64) -> Option<usize> {
        self.place(self.nth(height_mm))
    }

    /// Material as the rays along each axis have it, mm3.
    pub fn volumes_mm3(&self) -> [f64; 2] {
        let areas = self.layers.iter().map(Layer::areas_mm2);
        areas.fold([0.0; 2], |sum, area| [0, 1].map(|axis: usize| sum[axis] + area[axis] * self.rise_mm))
    }
}
