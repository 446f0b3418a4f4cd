//! What each tooth has left on the walls, against the solid that a true tool turns.
//!
//! In every layer rays end on walls; of the two directions that counts which meets the wall more squarely. How deep such an end lies in what the solid has swept is the mark there:
//! positive where material is left, negative where the wall is cut away. Feed marks, runout, unequal teeth, bending and
//! vibration are in it; the distance of the rays is not, as each end is where an edge put it.
//!
//! Floors that are lower than a level may be off are no material, and have no walls.
//!
//! An end of the blank that nothing was to cut is none, and neither is what a rapid took.

use nalgebra::Vector2;
use rayon::iter::{IntoParallelIterator, ParallelExtend, ParallelIterator};

use super::envelope::{Depth, Envelope, Turned};
use super::trail::Of;
use super::way::Way;
use crate::cutting::layer::Layer;
use crate::cutting::layers::{LEVEL_RATIO, Layers};
use crate::stock::dexel::Interval;

/// What is left of the blank this deep was to be cut: less is rounding.
const LEFT_MM: f64 = 1e-9;

/// A place on a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Which layer, from the lowest.
    pub layer: usize,
    /// Where, in the plane of the layers.
    pub point_mm: Vector2<f64>,
    /// Along the wall's normal: positive for material left.
    pub off_mm: f64,
    /// The block that made the wall.
    pub of: Of,
}

/// All ends of rays on walls, of a tool that went this way and turned this.
pub fn marks(blank: &Layers, left: &Layers, way: &Way, turned: &Turned) -> Vec<Mark> {
    let mut marks = Vec::new();
    for (layer, (blank, now)) in blank.layers().iter().zip(left.layers()).enumerate() {
        let envelope = Envelope::new(way.legs(), turned, left, layer);
        let mark = |end: End| {
            let Depth { deep_mm, leg, arm_mm } = envelope.deepest(&end.point_mm)?;
            let of = way.legs()[leg].of;
            let is_mark = end.is_square_to(&arm_mm) && (end.is_new || deep_mm > LEFT_MM) && !of.is_rapid;
            is_mark.then_some(Mark { layer, point_mm: end.point_mm, off_mm: deep_mm, of })
        };
        marks.par_extend(ends(blank, now).into_par_iter().filter_map(mark));
    }
    marks
}

/// Where the material of a ray ends.
struct End {
    axis: usize,
    point_mm: Vector2<f64>,
    /// Whether the blank did not end there.
    is_new: bool,
}

impl End {
    /// Whether no ray of the other axis meets a wall of this normal more squarely.
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
