//! Marks that the teeth leave on walls: results (JSON of docs/json.md), and text for a person.

use serde::Serialize;

use super::material::short;

/// Marks below this are reported as 0: rounding.
const NONE: f64 = 1e-8;

/// Marks of a run on walls, as distances from the surface that a tool without runout would leave: positive where
/// material is left, negative where the wall is cut away.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MarksFigures {
    /// Smallest and largest mark on all walls.
    #[serde(flatten)]
    pub range: RangeFigures,
    /// Mark with the largest absolute value.
    pub largest: LargestFigures,
    /// Layers with walls, from the lowest.
    pub layers: Vec<LayerFigures>,
    /// Blocks that made walls, in order.
    pub blocks: Vec<BlockMarksFigures>,
}

/// Smallest and largest mark on some walls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RangeFigures {
    /// Number of places at which the walls were measured (ends of dexel rays).
    pub points: usize,
    /// Smallest mark.
    pub min: f64,
    /// Largest mark.
    pub max: f64,
    /// Root mean square of the marks.
    pub rms: f64,
}

/// Mark with the largest absolute value, and its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LargestFigures {
    /// Distance of the wall from the reference: positive where material is left.
    pub distance: f64,
    /// X of the mark.
    pub x: f64,
    /// Y of the mark.
    pub y: f64,
    /// Z of the middle of its layer.
    pub z: f64,
    /// Number of blocks executed when the wall was made, including the block that made it.
    pub block: u32,
    /// N of that block.
    pub n: Option<i64>,
    /// Rule of that block, counted from 1.
    pub rule: Option<usize>,
}

/// Marks on the walls of one layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LayerFigures {
    /// Z of the middle of the layer.
    pub z: f64,
    /// Smallest and largest mark on the walls of the layer.
    #[serde(flatten)]
    pub range: RangeFigures,
}

/// Marks that one block left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BlockMarksFigures {
    /// Number of blocks executed then, including this one.
    pub block: u32,
    /// N of the block.
    pub n: Option<i64>,
    /// Rule of the block, counted from 1.
    pub rule: Option<usize>,
    /// Smallest and largest mark on the walls of the block.
    #[serde(flatten)]
    pub range: RangeFigures,
}

impl RangeFigures {
    /// Range of these marks; `None` if there are none.
    pub fn of(marks: impl Iterator<Item = f64>) -> Option<Self> {
        let none = RangeFigures { points: 0, min: f64::INFINITY, max: f64::NEG_INFINITY, rms: 0.0 };
        let sum = marks.fold(none, |sum, off| RangeFigures {
            points: sum.points + 1,
            min: sum.min.min(off),
            max: sum.max.max(off),
            rms: sum.rms + off * off,
        });
        (sum.points > 0).then(|| RangeFigures { rms: libm::sqrt(sum.rms / sum.points as f64), ..sum })
    }
}

impl MarksFigures {
    /// Range of the marks as text, from the least to the largest.
    pub fn range(&self) -> String {
        format!("{} .. {}", signed(self.range.min), signed(self.range.max))
    }
}

impl LargestFigures {
    /// Text about the largest mark: deviation, place and block.
    pub fn words(&self) -> String {
        let LargestFigures { distance, x, y, z, .. } = self;
        let block = self.n.map_or_else(|| format!("block {}", self.block), |n| format!("N{n}"));
        format!("{} at X{x:.3} Y{y:.3} Z{z:.3} by {block}", signed(*distance))
    }
}

/// A number with its sign.
pub fn signed(distance: f64) -> String {
    match distance {
        distance if distance.abs() < NONE => "0".into(),
        distance if distance > 0.0 => format!("+{}", short(distance)),
        distance => short(distance),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_have_a_sign_and_rounding_is_none() {
        assert_eq!([0.00025426, -0.02, 1e-15].map(signed), ["+0.0002543", "-0.02000", "0"]);
    }

    #[test]
    fn a_range_is_of_all_marks() {
        let range = RangeFigures::of([-3.0, 4.0].into_iter()).unwrap();
        assert_eq!((range.points, range.min, range.max), (2, -3.0, 4.0));
        assert!((range.rms - libm::sqrt(12.5)).abs() < 1e-12);
        assert_eq!(RangeFigures::of([].into_iter()), None);
    }
}
