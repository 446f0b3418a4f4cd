//! Tool axes that the rotary axes of a machine reach within their ranges.
//!
//! ```text
//! excess of an axis = distance of its position from its range, over all whole turns       (1)
//! excess of a tool axis = least over both solutions of the greater excess of its two axes      (2)
//! ```
//!
//! The positions are those of the machine's closed form. The part's frame is parallel to that of the machine with all axes at zero.

use core::fmt;

use arcfeed_kinematics::inverse::Angles;
use arcfeed_kinematics::machine::{Letter, Machine, RotaryAxis};

use crate::vector::Vector;

/// Distance that stations keep from the ends of the ranges: between two stations the tool axis runs on an arc, and its positions leave those of the stations.
const SPARE_DEG: f64 = 1.0;
const TURN_DEG: f64 = 360.0;

/// Position of a rotary axis that a tool axis would need, outside of the range of that rotary axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeExcess {
    /// Rotary axis.
    pub letter: Letter,
    /// Position that it would need.
    pub position_deg: f64,
    /// Smallest and largest position of its range.
    pub range_deg: [f64; 2],
    /// Distance of the position from the range that stations may use. (1)
    pub excess_deg: f64,
}

/// Excess of a tool axis over the ranges of a machine's rotary axes; `None` if both rotary axes stay within their ranges, by a degree at least. (2)
///
/// # Errors
/// No positions of the rotary axes give the tool axis, whatever their ranges.
pub fn range_excess(machine: &Machine, axis: &Vector) -> Result<Option<RangeExcess>, NoPositions> {
    let [first, second] = machine.rotary();
    let greater = |angles: [f64; 2]| larger(axis_excess(first, angles[0]), axis_excess(second, angles[1]));
    match machine.angles([axis.x, axis.y, axis.z]) {
        Angles::None => Err(NoPositions),
        Angles::One(angles) => Ok(greater(angles)),
        Angles::Two([one, other]) => Ok(smaller(greater(one), greater(other))),
        // Any position of the first axis is one.
        Angles::Any { second_deg } => Ok(axis_excess(second, second_deg)),
    }
}

/// No positions of the rotary axes give a tool axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoPositions;

impl fmt::Display for RangeExcess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let RangeExcess { letter, position_deg, range_deg: [least, greatest], .. } = self;
        write!(
            f,
            "{letter} would have to stand at {position_deg:.1} degrees, and its range is {least} to {greatest}, less {SPARE_DEG} degree at both ends"
        )
    }
}

/// Excess at the whole turn that is nearest to the range. (1)
fn axis_excess(axis: &RotaryAxis, position_deg: f64) -> Option<RangeExcess> {
    let range_deg = axis.range_deg?;
    let [least, greatest] = range_deg;
    let spare_deg = SPARE_DEG.min((greatest - least) / 2.0);
    let (low, high) = (least + spare_deg, greatest - spare_deg);
    let above_deg = position_deg + TURN_DEG * libm::ceil((low - position_deg) / TURN_DEG);
    let below_deg = above_deg - TURN_DEG;
    let excess = |position_deg, excess_deg| RangeExcess { letter: axis.letter, position_deg, range_deg, excess_deg };
    if above_deg <= high {
        None
    } else if above_deg - high < low - below_deg {
        Some(excess(above_deg, above_deg - high))
    } else {
        Some(excess(below_deg, low - below_deg))
    }
}

fn larger(one: Option<RangeExcess>, other: Option<RangeExcess>) -> Option<RangeExcess> {
    one.into_iter().chain(other).max_by(|a, b| a.excess_deg.total_cmp(&b.excess_deg))
}

fn smaller(one: Option<RangeExcess>, other: Option<RangeExcess>) -> Option<RangeExcess> {
    let (one, other) = (one?, other?);
    Some(if one.excess_deg <= other.excess_deg { one } else { other })
}
