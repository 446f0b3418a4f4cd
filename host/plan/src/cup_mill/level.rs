//! Path of a level (PATHLOW, PATH; Petean, section 3.3.3): from the base position about A until the ring meets a blade
//! or the hub (D), and likewise about B1 (E).

use crate::geometry::flaws::BladeSide;
use crate::search::Minimum;
use crate::vector::{Flat, Point};

use super::patch::Patch;
use super::turn::{Circle, TurningTool};

/// Surface that ends a turn of the ring about a pivot, because the ring meets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopSurface {
    /// Pressure side with its allowance.
    Pressure,
    /// Suction side with its allowance.
    Suction,
    /// Hub with its allowance.
    Hub,
    /// Side of any blade, with its round edges; counted as in [`Neighbour`](super::neighbours::Neighbour).
    Blade(i32, BladeSide),
}

/// End of a turn of the ring about a pivot: where the ring meets a surface, or leaves the slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Angle of the turn, rad.
    pub turn_rad: f64,
    /// Centre of the tool at the end of the turn, seen along the tool.
    pub centre: Flat,
    /// Contact: surface, circle of the ring (outer or inner), and point; `None` if the ring meets nothing and leaves the slot.
    pub at: Option<(StopSurface, Circle, Point)>,
}

/// Angle at which a turn without a contact ends, because the ring has left the slot, rad.
pub const TURN_MAX_RAD: f64 = 0.6;

/// Excess of the turn at a sample over that between samples, rad: larger ones are not searched.
const SLACK_RAD: f64 = 0.05;

/// Finds the first of the `obstacles` that the turning ring meets. The search is fastest if the most likely one
/// comes first.
pub fn stop(turning: &TurningTool<'_>, obstacles: &[(StopSurface, &Patch)]) -> Stop {
    let until = |point: &Point| turning.until(point).map_or(f64::INFINITY, |(turn_rad, _)| turn_rad);
    let mut first: Option<(StopSurface, &Patch, Minimum)> = None;
    for (obstacle, patch) in obstacles {
        let so_far_rad = first.map_or(TURN_MAX_RAD, |(.., least)| least.value);
        let least = patch.least_below(so_far_rad + SLACK_RAD, until).filter(|least| least.value < so_far_rad);
        first = least.map(|least| (*obstacle, *patch, least)).or(first);
    }
    match first {
        None => Stop { turn_rad: TURN_MAX_RAD, centre: turning.centre_after(TURN_MAX_RAD), at: None },
        Some((obstacle, patch, Minimum { at: [u, v], value })) => {
            let point = patch.point(u, v);
            let turn_rad = value.max(0.0);
            let at = turning.until(&point).map(|(_, circle)| (obstacle, circle, point));
            Stop { turn_rad, centre: turning.centre_after(turn_rad), at }
        }
    }
}
