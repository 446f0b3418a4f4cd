//! Reasons why a slot cannot be planned.

use thiserror::Error;

use crate::vector::Point;

use super::free_width::FreeWidth;
use super::normal_form::StartEdge;
use super::side::OffsetSide;

/// Most levels of a path: more are a mistake in the greatest axial depth.
const LEVELS_MAX: f64 = 1000.0;

/// Reason why no path of a cup mill can be planned in a slot.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Infeasible {
    /// The side of this name (pressure or suction) does not reach the hub with its allowance.
    #[error("the {0} side does not reach the hub with its allowance")]
    NoFoot(&'static str),
    /// The tool would lie along the rotor's axis, for which there is no slot frame.
    #[error("the blade's edge lies along the rotor's axis: no tool comes in along it")]
    NoAxis,
    /// A ring of this width does not pass between the blades.
    #[error("no ring of this width passes: {missing_mm:.1} mm missing {place}")]
    TooNarrow {
        /// Width by which the slot is too narrow.
        missing_mm: f64,
        /// Description of the narrowest point.
        place: String,
    },
    /// The ring passes, but not at the base position, where it must touch both blades.
    #[error(
        "the ring passes ({room_mm:.2} mm of room on each side), but not where it touches both blades as the base position does"
    )]
    NoBase {
        /// Free width on each side of the ring, mm.
        room_mm: f64,
    },
    /// The ring is nowhere above the hub at the base position.
    #[error("the ring is nowhere above the hub at the base position: its radius does not suit the slot")]
    NoFloor,
    /// The cup's cavity is not deep enough for the blade that stands in it.
    #[error(
        "the cup is {cavity_mm:.1} mm deep, but the blade inside it reaches {needed_mm:.1} mm up from the lowest level"
    )]
    Shallow {
        /// Depth of the cavity, mm.
        cavity_mm: f64,
        /// Required depth, mm.
        needed_mm: f64,
    },
    /// There are plans, but none is proven free of collisions.
    #[error("the best paths collide, or leave less than the allowance: their proofs do not hold")]
    Unproven,
    /// A straight line from blade tip to blade tip would lead through the hub, so there is no slot for a ring.
    #[error(
        "with {blades} blades the straight way from tip to tip leads through the hub: there is no slot for a ring; take a tool that mills pockets"
    )]
    NoSlot {
        /// Number of blades.
        blades: u32,
    },
    /// The depth would need too many levels.
    #[error(
        "levels of {depth_max_mm} mm are too many for a depth of {depth_mm:.1} mm: `axial_depth_max` must be {least_mm:.3} mm or more"
    )]
    Levels {
        /// Depth of the slot, mm.
        depth_mm: f64,
        /// Given greatest axial depth of a level, mm.
        depth_max_mm: f64,
        /// Smallest axial depth of a level that is accepted for this slot, mm.
        least_mm: f64,
    },
}

/// Checks that a depth does not need too many levels.
///
/// # Errors
/// There would be too many levels.
pub fn check_levels(depth_mm: f64, depth_max_mm: f64) -> Result<(), Infeasible> {
    let least_mm = depth_mm / LEVELS_MAX;
    if depth_max_mm < least_mm { Err(Infeasible::Levels { depth_mm, depth_max_mm, least_mm }) } else { Ok(()) }
}

/// Description of the place where the ring is blocked.
pub fn narrow(free_width: &FreeWidth, pressure: &OffsetSide, suction: &OffsetSide, start: StartEdge) -> Infeasible {
    let off = |point: &Point| (point.xy() - free_width.centre).norm();
    let tightest = [(pressure, 1.0, "pressure"), (suction, -1.0, "suction")].map(|(side, sign, name)| {
        let least = side.patch.least(|point| sign * off(point));
        least.map_or(String::new(), |least| {
            let [u, v] = least.at;
            let share = (u - side.edges[0]) / (side.edges[1] - side.edges[0]);
            let share = if start == StartEdge::Leading { share } else { 1.0 - share };
            format!("the {name} side's {} {:.0} % up the blade", along(share), 100.0 * v)
        })
    });
    Infeasible::TooNarrow {
        missing_mm: -2.0 * free_width.per_side_mm,
        place: format!("between {}", tightest.join(" and ")),
    }
}

/// Part of a side in words.
fn along(share: f64) -> &'static str {
    match share {
        ..0.2 => "leading edge",
        0.2..0.8 => "middle",
        _ => "trailing edge",
    }
}
