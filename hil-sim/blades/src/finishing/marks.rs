//! Marks: surface that a flexible tool or blade leaves after a pass, compared with that of a rigid pair of both.
//!
//! Rays square to the chord end on the machined side, in each layer. The deviation is measured along the normal,
//! positive for remaining material; if no material remains, it is the blade's thickness.

use super::pass::PassResult;
use super::side::Side;
use arcfeed_dexel::dexel::{Dexel, Interval};
use arcfeed_milling::cutting::layer::Layer;

/// Distance from an edge within which rays are left out: they may meet the edge itself.
const EDGE_MM: f64 = 0.3;

/// Point of the machined surface with its deviation from the surface that a rigid tool and blade would leave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceMark {
    /// Index of the layer of the workpiece, counted from the lowest.
    pub layer: usize,
    /// Position along the side of the blade, from its middle, positive towards the trailing edge.
    pub along_mm: f64,
    /// Deviation along the outward normal: positive for remaining material.
    pub deviation_mm: f64,
}

/// Deviations of `flexible` from `rigid` at all points of the surface that both have, layer by layer.
pub fn marks(side: &Side, rigid: &PassResult, flexible: &PassResult) -> Vec<SurfaceMark> {
    let layers = rigid.layers.layers().iter().zip(flexible.layers.layers()).enumerate();
    layers.flat_map(|(layer, (rigid, flexible))| of_layer(side, layer, rigid, flexible)).collect()
}

/// Root mean square of the deviations of some marks, mm; 0 without marks.
pub fn deviation_mm<'a>(marks: impl Iterator<Item = &'a SurfaceMark>) -> f64 {
    let (sum, count) =
        marks.fold((0.0, 0), |(sum, count), mark| (sum + mark.deviation_mm * mark.deviation_mm, count + 1));
    libm::sqrt(sum / f64::from(count.max(1)))
}

fn of_layer<'a>(
    side: &'a Side,
    layer: usize,
    rigid: &'a Layer,
    flexible: &'a Layer,
) -> impl Iterator<Item = SurfaceMark> + 'a {
    let ends = [-0.5, 0.5].map(|part| side.contact(part * side.length_mm()).point_mm.x);
    let pairs = rigid.rays(1).iter().zip(flexible.rays(1)).enumerate();
    pairs.filter_map(move |(ray, (reference, left))| {
        let x_mm = rigid.place_mm(1, ray);
        let reference = reference.extent()?;
        if x_mm < ends[0] + EDGE_MM || x_mm > ends[1] - EDGE_MM {
            return None;
        }
        // The line is almost evenly spaced along the chord.
        let along_mm = ((x_mm - ends[0]) / (ends[1] - ends[0]) - 0.5) * side.length_mm();
        let across = side.contact(along_mm).normal.y;
        Some(SurfaceMark { layer, along_mm, deviation_mm: (end_mm(left, &reference) - reference.to_mm) * across })
    })
}

/// End of the material on the machined side.
fn end_mm(left: &Dexel, reference: &Interval) -> f64 {
    left.extent().map_or(reference.from_mm, |extent| extent.to_mm)
}
