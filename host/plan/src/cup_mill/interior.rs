//! Point of interior rotation, B1 (BASEPOS; Petean, section 3.3.3, Fig. 3.13).
//!
//! ```text
//! 1  B1 lies on the inner circle at the base position
//! 2  turning about B1 brings the inner circle to the suction side's tip curve near the leading edge
//! ```
//!
//! The pivot is moved from B along the circle towards the leading edge, until the first point of the tip curve that the
//! circle meets lies within the given fraction of the curve from there: the nearest such pivot to B. If the blade is
//! more curved than the ring, the circle after the turn touches the curve at that very fraction, and B1 is where it
//! crosses the circle at the base position.

use arcfeed_nc::modal::Turn;

use crate::cutter::CupMill;
use crate::search::{Minimum, descend};
use crate::vector::Flat;

use super::base::Base;
use super::side::OffsetSide;
use super::turn::{Circle, TurningTool};

/// Number of points of the tip curve that are checked for the first contact.
const SAMPLES: i32 = 96;
/// Halvings that exhaust the precision of an angle.
const HALVINGS: i32 = 50;
/// Number of steps along the circle in the search for the pivot, and its range, rad.
const STEPS: i32 = 200;
const FARTHEST_RAD: f64 = 0.3;

/// B1, and the fraction of the tip curve, from the leading edge, at which the circle meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InteriorPivot {
    /// Pivot.
    pub pivot: Flat,
    /// Place on the tip curve that the circle meets, 0 to 1.
    pub contact: f64,
    /// Turn until then, rad.
    pub turn_rad: f64,
}

/// Pivot for a first contact within `share` of the tip curve; the one with the nearest contact if there is none.
pub fn interior(suction: &OffsetSide, cutter: &CupMill, base: &Base, turn: Turn, share: f64) -> Option<InteriorPivot> {
    let spoke = base.interior - base.centre;
    let leading = suction.tip(suction.edges[0]) - base.centre;
    let towards = libm::copysign(1.0, spoke.perp(&leading));
    let pivot = |angle: f64| base.centre + nalgebra::Rotation2::new(angle * towards) * spoke;
    let contact = |angle: f64| first_contact(suction, cutter, base.centre, pivot(angle), turn);
    let step = FARTHEST_RAD / f64::from(STEPS);
    let met = |angle: f64| contact(angle).is_some_and(|(at, _)| at <= share);
    let mut best = (0.0, contact(0.0)?);
    if best.1.0 > share {
        let angles = (1..=STEPS).map(|k| step * f64::from(k));
        let found = angles.clone().find(|angle| met(*angle));
        let angle = match found {
            Some(beyond) => {
                let (mut before, mut beyond) = (beyond - step, beyond);
                for _ in 0..HALVINGS {
                    let middle = (before + beyond) / 2.0;
                    if met(middle) { beyond = middle } else { before = middle }
                }
                beyond
            }
            None => {
                let nearest = angles.filter_map(|angle| contact(angle).map(|(at, _)| (angle, at)));
                nearest.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |(angle, _)| angle)
            }
        };
        best = (angle, contact(angle)?);
    }
    Some(InteriorPivot { pivot: pivot(best.0), contact: best.1.0, turn_rad: best.1.1 })
}

/// Fraction of the tip curve that the inner circle meets first, and the turn until then.
fn first_contact(suction: &OffsetSide, cutter: &CupMill, centre: Flat, pivot: Flat, turn: Turn) -> Option<(f64, f64)> {
    let turning = TurningTool { cutter, centre, bottom_mm: 0.0, pivot, turn };
    let [first, last] = suction.edges;
    let until = |share: f64| {
        let place = suction.tip(first + (last - first) * share);
        turning.circle_until(place, cutter.inner_radius_mm, Circle::Inner).unwrap_or(f64::INFINITY)
    };
    let samples = (0..=SAMPLES).map(|k| f64::from(k) / f64::from(SAMPLES));
    let valued = samples.map(|at| Minimum { at: [at, 0.0], value: until(at) });
    let start = valued.min_by(|a, b| a.value.total_cmp(&b.value)).filter(|least| least.value.is_finite())?;
    let found = descend([[0.0, 1.0], [0.0, 0.0]], start, [1.0 / f64::from(SAMPLES), 0.0], |[at, _]| until(at));
    Some((found.at[0], found.value))
}
