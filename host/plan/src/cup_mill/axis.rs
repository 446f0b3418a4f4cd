//! Tool axis of a cup mill along the edge of a blade (BPTA; Petean, section 3.3.1).
//!
//! ```text
//! PT1        end of the pressure side's tip curve nearest the leading edge
//! LN1, LN2   normals of hub and pressure side there, both with allowance
//! CRV1       the pressure side in the plane of LN1 and LN2: (p - PT1).(n1 x n2) = 0      (1)
//! LN3        through PT1 and the end of CRV1 on the hub: the tool's axis
//! ```
//!
//! With a twisted blade, the plane may pass beside the blade's edge above the hub. CRV1 then ends on the hub at that
//! edge: the foot of (1) nearest to the plane.

use crate::geometry::blisk::Revolution;
use crate::geometry::face::Face;
use crate::search::{Minimum, descend};
use crate::vector::{Point, Vector};

use super::side::{edges, leading_tip, leaves_hub};

/// Number of places along the hub on which the plane is searched.
const SAMPLES: i32 = 64;

/// Tool axis along the blade's edge (the source's line LN3), with the two points that define it, in the rotor's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Upper point PT1: end of the pressure side's tip curve.
    pub tip: Point,
    /// Lower point: end of the curve CRV1 on the hub with its allowance.
    pub foot: Point,
    /// Unit vector from the lower to the upper point.
    pub direction: Vector,
}

/// Tool axis along the blade's edge of a slot. `None` if the pressure side does not reach the hub with its allowance.
pub fn axis(pressure: &Face, hub: &Revolution, allowance_mm: f64) -> Option<Axis> {
    let [first, last] = edges(pressure);
    let (tip, normal) = leading_tip(pressure, allowance_mm);
    let plane = hub.normal(&tip).cross(&normal).normalize();
    let foot = |u: f64| {
        let v = leaves_hub(pressure, hub, allowance_mm, u).filter(|v| *v > 0.0)?;
        Some(pressure.offset(u, v, allowance_mm))
    };
    let off_mm = |u: f64| foot(u).map_or(f64::INFINITY, |foot| (foot - tip).dot(&plane).abs()); // (1)
    let width = (last - first) / f64::from(SAMPLES);
    let samples = (0..=SAMPLES).map(|k| first + width * f64::from(k));
    let start =
        samples.map(|u| Minimum { at: [u, 0.0], value: off_mm(u) }).min_by(|a, b| a.value.total_cmp(&b.value))?;
    let found = descend([[first, last], [0.0, 0.0]], start, [width, 0.0], |[u, _]| off_mm(u));
    let foot = foot(found.at[0])?;
    (tip - foot).try_normalize(1e-9).map(|direction| Axis { tip, foot, direction })
}
