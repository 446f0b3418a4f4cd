//! The workpiece as layers one above the other, square to the tool's axis.

use arcfeed_dexel::lattice::LatticeError;
use arcfeed_dexel::solid::Solid;
use arcfeed_dexel::workpiece::Stock;

use super::layer::Layer;

/// Fraction of a layer by which a solid may exceed a whole number of layers: rounding.
const WHOLE_RATIO: f64 = 1e-9;

/// Fraction of a layer within which a height counts as on its border: rounding.
const BORDER_RATIO: f64 = 1e-6;

/// Part of a layer's height by which a programmed height may differ from a layer's border and still count as on it: programs round
/// their coordinates, layers do not.
pub const LEVEL_RATIO: f64 = 0.02;

/// Number of layers above which the layer height is taken for a mistake.
const LAYERS_MAX: f64 = 65_536.0;

/// Workpiece as layers of equal height, one above the other along the tool's axis.
#[derive(Clone, Debug)]
pub struct Layers {
    lowest_mm: f64,
    rise_mm: f64,
    layers: Vec<Layer>,
    extent_mm: Option<[[f64; 2]; 2]>,
}

/// Slice of a tool at one height above its tip, with its radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// Height of the slice's middle above the tip.
    pub height_mm: f64,
    /// Innermost radius of the edges; 0 without inner edges.
    pub inner_mm: f64,
    /// Outermost radius of the edges, from the spindle's axis.
    pub outer_mm: f64,
}

impl Layers {
    /// Layers, each `rise_mm` high, from the height `lowest_mm` upwards.
    pub fn new(lowest_mm: f64, rise_mm: f64, layers: Vec<Layer>) -> Self {
        let extent_mm = layers.iter().map(Layer::extent_mm).reduce(|[a, b], [c, d]| {
            [[0, 1].map(|axis: usize| a[axis].min(c[axis])), [0, 1].map(|axis: usize| b[axis].max(d[axis]))]
        });
        Layers { lowest_mm, rise_mm, layers, extent_mm }
    }

    /// As many copies of one layer, from the height `lowest_mm` upwards.
    pub fn alike(layer: &Layer, lowest_mm: f64, rise_mm: f64, count: usize) -> Self {
        Layers::new(lowest_mm, rise_mm, vec![layer.clone(); count])
    }

    /// Layers of all cells of a stock (tri-dexel model) along `axis`: 0, 1, 2 for x, y, z. The planes of the layers have the two axes
    /// that follow it in cyclic order.
    pub fn of(stock: &Stock, axis: usize) -> Self {
        let lattice = stock.lattice();
        let cell = |cell| Layer::of(stock, axis, lattice.center_mm(axis, cell));
        Layers::new(lattice.lowest_mm()[axis], lattice.step_mm(), (0..lattice.cells()[axis]).map(cell).collect())
    }

    /// Layers of a solid along `axis`, from its top downwards until it is covered; each is the section of the solid at the height of
    /// the layer's middle.
    ///
    /// # Errors
    /// The solid has no extent, a step is not positive, or there would be too many layers or rays.
    pub fn of_solid(solid: &dyn Solid, axis: usize, rise_mm: f64, step_mm: f64) -> Result<Self, LatticeError> {
        let mut layers = Layers::empty(solid.bounds_mm(), axis, rise_mm, step_mm)?;
        (0..layers.layers.len()).try_for_each(|layer| layers.fill(layer, solid, axis))?;
        Ok(layers)
    }

    /// Layers of a solid with these bounds, as [`Layers::of_solid`] divides it, still without material.
    ///
    /// # Errors
    /// As [`Layers::of_solid`].
    pub fn empty(bounds_mm: [[f64; 3]; 2], axis: usize, rise_mm: f64, step_mm: f64) -> Result<Self, LatticeError> {
        let [lowest_mm, highest_mm] = bounds_mm;
        let length_mm = highest_mm[axis] - lowest_mm[axis];
        let count = libm::ceil(length_mm / rise_mm - WHOLE_RATIO);
        if !(1.0..=LAYERS_MAX).contains(&count) {
            return Err(LatticeError::Box { axis, length_mm });
        }
        let lowest_mm = highest_mm[axis] - count * rise_mm;
        let layer = |n: usize| Layer::empty_at(bounds_mm, axis, lowest_mm + (n as f64 + 0.5) * rise_mm, step_mm);
        let layers: Result<Vec<Layer>, LatticeError> = (0..count as usize).map(layer).collect();
        Ok(Layers::new(lowest_mm, rise_mm, layers?))
    }

    /// Replaces the layer with this index by the section of a solid along `axis`.
    ///
    /// # Errors
    /// There would be too many rays.
    pub fn fill(&mut self, layer: usize, solid: &dyn Solid, axis: usize) -> Result<(), LatticeError> {
        let middle_mm = self.middle_mm(layer);
        let step_mm = self.layers[layer].step_mm();
        self.layers[layer] = Layer::at(solid, axis, middle_mm, step_mm)?;
        Ok(())
    }

    /// Lowest and highest corner, in the plane of the layers, of a rectangle around all of them; `None` without layers.
    pub fn extent_mm(&self) -> Option<[[f64; 2]; 2]> {
        self.extent_mm
    }

    /// Height of each layer, mm.
    pub fn rise_mm(&self) -> f64 {
        self.rise_mm
    }

    /// Height of the middle of the layer with this index.
    pub fn middle_mm(&self, layer: usize) -> f64 {
        self.lowest_mm + (layer as f64 + 0.5) * self.rise_mm
    }

    /// Layers from the lowest upwards.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Layers from the lowest upwards, to be cut.
    pub fn layers_mut(&mut self) -> &mut [Layer] {
        &mut self.layers
    }

    /// Number of the layer at a height: 0 for the lowest, negative below it, and beyond the last index above the highest. A height on
    /// the border of two layers, within rounding, belongs to the upper one.
    pub fn nth(&self, height_mm: f64) -> i64 {
        libm::floor((height_mm - self.lowest_mm) / self.rise_mm + BORDER_RATIO) as i64
    }

    /// Height as a fraction of the height of layer `nth`: 0 at its bottom, 1 at its top, negative below, more than 1 above.
    pub fn part_ratio(&self, nth: i64, height_mm: f64) -> f64 {
        let ratio = (height_mm - self.lowest_mm) / self.rise_mm - nth as f64;
        let border = libm::round(ratio);
        if libm::fabs(ratio - border) <= BORDER_RATIO { border } else { ratio }
    }

    /// Index in [`Layers::layers`] of the layer with this number; `None` if there is no such layer.
    pub fn place(&self, nth: i64) -> Option<usize> {
        usize::try_from(nth).ok().filter(|index| *index < self.layers.len())
    }

    /// Index in [`Layers::layers`] of the layer at a height; `None` if there is none.
    pub fn index(&self, height_mm: f64) -> Option<usize> {
        self.place(self.nth(height_mm))
    }

    /// Volume of the material, mm3, as measured by the rays along each of the two axes of the layers.
    pub fn volumes_mm3(&self) -> [f64; 2] {
        let areas = self.layers.iter().map(Layer::areas_mm2);
        areas.fold([0.0; 2], |sum, area| [0, 1].map(|axis: usize| sum[axis] + area[axis] * self.rise_mm))
    }
}
