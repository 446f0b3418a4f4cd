//! The workpiece as layers one above the other, square to the tool's axis.

use crate::stock::workpiece::Stock;

use super::layer::Layer;

/// Layers of equal height.
#[derive(Clone, Debug)]
pub struct Layers {
    lowest_mm: f64,
    rise_mm: f64,
    layers: Vec<Layer>,
}

impl Layers {
    /// These, from a height upwards.
    pub fn new(lowest_mm: f64, rise_mm: f64, layers: Vec<Layer>) -> Self {
        Layers { lowest_mm, rise_mm, layers }
    }

    /// So many copies of a layer, from a height upwards.
    pub fn alike(layer: &Layer, lowest_mm: f64, rise_mm: f64, count: usize) -> Self {
        Layers { lowest_mm, rise_mm, layers: vec![layer.clone(); count] }
    }

    /// All cells of a stock along `axis`: 0, 1, 2 for x, y, z. The planes have the two axes that follow it.
    pub fn of(stock: &Stock, axis: usize) -> Self {
        let lattice = stock.lattice();
        let cell = |cell| Layer::of(stock, axis, lattice.center_mm(axis, cell));
        Layers {
            lowest_mm: lattice.lowest_mm()[axis],
            rise_mm: lattice.step_mm(),
            layers: (0..lattice.cells()[axis]).map(cell).collect(),
        }
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

    /// Which one is at a height.
    pub fn index(&self, height_mm: f64) -> Option<usize> {
        let index = (height_mm - self.lowest_mm) / self.rise_mm;
        (0.0..self.layers.len() as f64).contains(&index).then_some(index as usize)
    }

    /// Material as the rays along each axis have it, mm3.
    pub fn volumes_mm3(&self) -> [f64; 2] {
        let areas = self.layers.iter().map(Layer::areas_mm2);
        areas.fold([0.0; 2], |sum, area| [0, 1].map(|axis: usize| sum[axis] + area[axis] * self.rise_mm))
    }
}
