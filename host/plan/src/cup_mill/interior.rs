//! Point B1, about which the ring turns at the suction side (BASEPOS; Petean, section 3.3.3, Fig. 3.13).
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

/// Point B1 about which the ring turns at the suction side, and the fraction of the tip curve, from the leading edge,
/// at which the circle then meets the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InteriorPivot {
    /// Pivot B1, seen along the tool.
    pub pivot: Flat,
    /// Point of the tip curve that the circle meets after the turn, as a fraction of the curve, 0 to 1.
    pub contact: f64,
    /// Turn of the ring about the pivot until then, rad.
    pub turn_rad: f64,
}

/// Pivot B1 from which the turning inner circle first meets the tip curve within `share` of its end; if there is
/// none, the pivot with the nearest contact.
pub fn interior(suction: &OffsetSide, cutter: &CupMill, base: &Base, turn: Turn, share: f64) -> Option<InteriorPivot> {
    let tip = TipCurve::new(suction);
    let spoke = base.interior - base.centre;
    let leading = suction.tip(suction.edges[0]) - base.centre;
    let towards = libm::copysign(1.0, spoke.perp(&leading));
    let turning = |angle: f64| {
        let pivot = base.centre + nalgebra::Rotation2::new(angle * towards) * spoke;
        TurningTool { cutter, centre: base.centre, bottom_mm: 0.0, pivot, turn }
    };
    let contact = |angle: f64| tip.first_contact(&turning(angle));
    let step = FARTHEST_RAD / f64::from(STEPS);
    let met = |angle: f64| contact(angle).is_some_and(|(at, _)| at <= share);
    let mut best = (0.0, contact(0.0)?);
    if best.1.0 > share {
        // Samples of the curve come within a sample's distance of the place; from there on the curve itself counts.
        let near =
            |k: &i32| tip.sampled(&turning(step * f64::from(*k))).is_some_and(|start| start.at[0] <= share + SAMPLE);
        let found = (1..=STEPS).find(near).and_then(|first| (first..=STEPS).find(|k| met(step * f64::from(*k))));
        let angle = match found {
            Some(k) => {
                let (mut before, mut beyond) = (step * f64::from(k - 1), step * f64::from(k));
                for _ in 0..HALVINGS {
                    let middle = (before + beyond) / 2.0;
                    if met(middle) { beyond = middle } else { before = middle }
                }
                beyond
            }
            None => {
                let angles = (1..=STEPS).map(|k| step * f64::from(k));
                let nearest = angles.filter_map(|angle| contact(angle).map(|(at, _)| (angle, at)));
                nearest.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |(angle, _)| angle)
            }
        };
        best = (angle, contact(angle)?);
    }
    Some(InteriorPivot { pivot: turning(best.0).pivot, contact: best.1.0, turn_rad: best.1.1 })
}

/// Tip curve of the suction side.
struct TipCurve<'s> {
    suction: &'s OffsetSide,
    samples: Vec<(f64, Flat)>,
}

/// Distance of samples.
const SAMPLE: f64 = 1.0 / SAMPLES as f64;

impl<'s> TipCurve<'s> {
    fn new(suction: &'s OffsetSide) -> Self {
        let mut curve = TipCurve { suction, samples: Vec::new() };
        curve.samples = (0..=SAMPLES).map(|k| f64::from(k) * SAMPLE).map(|at| (at, curve.place(at))).collect();
        curve
    }

    fn place(&self, share: f64) -> Flat {
        let [first, last] = self.suction.edges;
        self.suction.tip(first + (last - first) * share)
    }

    /// Sample that the inner circle meets first.
    fn sampled(&self, turning: &TurningTool<'_>) -> Option<Minimum> {
        let valued = self.samples.iter().map(|(at, place)| Minimum { at: [*at, 0.0], value: until(turning, *place) });
        valued.min_by(|a, b| a.value.total_cmp(&b.value)).filter(|least| least.value.is_finite())
    }

    /// Fraction of the curve that the inner circle meets first, and the turn until then.
    fn first_contact(&self, turning: &TurningTool<'_>) -> Option<(f64, f64)> {
        let mut found = self.sampled(turning)?;
        if !self.suction.patch.is_coarse() {
            let f = |[at, _]: [f64; 2]| until(turning, self.place(at));
            found = descend([[0.0, 1.0], [0.0, 0.0]], found, [SAMPLE, 0.0], f);
        }
        Some((found.at[0], found.value))
    }
}

fn until(turning: &TurningTool<'_>, place: Flat) -> f64 {
    turning.circle_until(place, turning.cutter.inner_radius_mm, Circle::Inner).unwrap_or(f64::INFINITY)
}
