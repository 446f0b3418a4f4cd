//! Marks: deviations that each tooth has left on the walls of the workpiece, relative to the sweep of an ideal tool.
//!
//! In every layer rays end on walls. For each wall the ray direction with the larger angle to it counts. The depth of a
//! ray's end in the sweep is the mark: positive for remaining material, negative where the wall is undercut. Marks
//! contain feed marks, runout, unequal teeth, bending and vibration, but not the distance of the rays, because an edge
//! determines each end exactly.
//!
//! Floors within the tolerance of a level are no material, and have no walls.
//!
//! Ends of the blank that no move was to cut do not count, nor do ends that a rapid cut.

use nalgebra::Vector2;
use rayon::iter::{IntoParallelIterator, ParallelExtend, ParallelIterator};

use super::envelope::{CuttingSolid, Depth, Envelope};
use super::tip_path::TipPath;
use super::trail::BlockRef;
use arcfeed_dexel::dexel::Interval;
use arcfeed_milling::cutting::layer::Layer;
use arcfeed_milling::cutting::layers::{LEVEL_RATIO, Layers};

/// Depth below which a remainder of the blank is rounding.
const LEFT_MM: f64 = 1e-9;

/// Mark at a point of a wall of the workpiece: how far the wall deviates from the sweep of an ideal tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallMark {
    /// Index of the layer of the workpiece, counted from the lowest.
    pub layer: usize,
    /// Point in the plane of the layers.
    pub point_mm: Vector2<f64>,
    /// Deviation along the wall's normal: positive for remaining material.
    pub off_mm: f64,
    /// Block that cut the wall.
    pub block: BlockRef,
}

/// Marks on all walls along the path of the tip, at all ends of rays. `blank` and `left` are the workpiece before and after; `turned` is
/// the solid that the tool's edges sweep.
pub fn marks(blank: &Layers, left: &Layers, tip_path: &TipPath, turned: &CuttingSolid) -> Vec<WallMark> {
    let mut marks = Vec::new();
    for (layer, (blank, now)) in blank.layers().iter().zip(left.layers()).enumerate() {
        let envelope = Envelope::new(tip_path.segments(), turned, left, layer);
        let mark = |end: End| {
            let Depth { deep_mm, segment, arm_mm } = envelope.deepest(&end.point_mm)?;
            let block = tip_path.segments()[segment].block;
            let is_mark = end.is_square_to(&arm_mm) && (end.is_new || deep_mm > LEFT_MM) && !block.is_rapid;
            is_mark.then_some(WallMark { layer, point_mm: end.point_mm, off_mm: deep_mm, block })
        };
        marks.par_extend(ends(blank, now).into_par_iter().filter_map(mark));
    }
    marks
}

/// End of the material of a ray.
struct End {
    axis: usize,
    point_mm: Vector2<f64>,
    /// Whether the blank did not end there.
    is_new: bool,
}

impl End {
    /// Whether the ray's axis meets a wall of this normal at the larger angle.
    fn is_square_to(&self, normal: &Vector2<f64>) -> bool {
        libm::fabs(normal[self.axis]) >= libm::fabs(normal[1 - self.axis])
    }
}

fn ends(blank: &Layer, now: &Layer) -> Vec<End> {
    let mut ends = Vec::new();
    for axis in [0, 1] {
        for (ray, before) in blank.rays(axis).iter().enumerate() {
            let Some(all) = before.extent() else { continue };
            for end_mm in ends_mm(&now.section(axis, ray as i64, &all, LEVEL_RATIO)) {
                let mut point_mm = Vector2::repeat(now.place_mm(axis, ray));
                point_mm[axis] = end_mm;
                ends.push(End { axis, point_mm, is_new: ends_mm(before.intervals()).all(|old_mm| old_mm != end_mm) });
            }
        }
    }
    ends
}

fn ends_mm(pieces: &[Interval]) -> impl Iterator<Item = f64> + '_ {
    pieces.iter().flat_map(|piece| [piece.from_mm, piece.to_mm])
}
