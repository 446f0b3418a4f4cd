//! The path of a level (PATHLOW, PATH; Petean, section 3.3.3): from the base position about A until the ring meets a blade or the hub (D), and
//! about B1 likewise (E).

use crate::search::Least;
use crate::vector::{Flat, Point};

use super::patch::Patch;
use super::turn::{Circle, Turning};

/// What a turn ended at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// The pressure side with its allowance.
    Pressure,
    /// The suction side with its.
    Suction,
    /// The hub with its.
    Hub,
}

/// Where a turn ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// By how much it turned, rad.
    pub turn_rad: f64,
    /// The tool's centre.
    pub centre: Flat,
    /// What it met: what, with which circle, where.
    pub at: Option<(Obstacle, Circle, Point)>,
}

/// Beyond this a turn has left the slot, rad.
pub const TURN_MAX_RAD: f64 = 0.6;

/// The end of a turn among `obstacles`.
pub fn stop(turning: &Turning<'_>, obstacles: &[(Obstacle, &Patch)]) -> Stop {
    let until = |point: &Point| turning.until(point).map_or(f64::INFINITY, |(turn_rad, _)| turn_rad);
    let met =
        obstacles.iter().filter_map(|(obstacle, patch)| patch.least(until).map(|least| (*obstacle, *patch, least)));
    let first = met.min_by(|a, b| a.2.value.total_cmp(&b.2.value)).filter(|(.., least)| least.value < TURN_MAX_RAD);
    match first {
        None => Stop { turn_rad: TURN_MAX_RAD, centre: turning.centre_after(TURN_MAX_RAD), at: None },
        Some((obstacle, patch, Least { at: [u, v], value })) => {
            let point = patch.point(u, v);
            let turn_rad = value.max(0.0);
            let at = turning.until(&point).map(|(_, circle)| (obstacle, circle, point));
            Stop { turn_rad, centre: turning.centre_after(turn_rad), at }
        }
    }
}
