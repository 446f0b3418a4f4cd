//! Surroundings of a place of the rotor: the sector of the part about it; those of a slot also in the slot frame.

use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::geometry::mesh::{Sector, Triangle};
use arcfeed_plan::vector::Point;

use super::plan_result::PlanResult;

/// Width of the stock on either side of the slot, in pitches.
pub(super) const BESIDE_PITCHES: f64 = 0.75;
/// Depth of the stock below the hub, mm.
const BELOW_HUB_MM: f64 = 5.0;

/// Triangles of the part in the slot frame.
pub(super) fn in_slot(composed: &PlanResult, triangles: Vec<Triangle>) -> Vec<Triangle> {
    let turn = composed.valued.plan.turn;
    triangles.into_iter().map(|corners| corners.map(|corner| turn * corner)).collect()
}

/// Both blades of the slot.
pub(super) fn blades(composed: &PlanResult) -> [i32; 2] {
    if composed.part.blisk.facing() > 0 { [0, 1] } else { [-1, 0] }
}

/// Sector of the part about the slot.
pub(super) fn sector(composed: &PlanResult) -> Sector {
    let blisk = &composed.part.blisk;
    let at = |point: Point| libm::atan2(point.y, point.x);
    let from = at(composed.slot.pressure.point(0.5, 0.5));
    let facing = f64::from(blisk.facing());
    let middle = from + facing * blisk.pitch_rad() / 2.0;
    sector_about(blisk, middle, (0.5 + BESIDE_PITCHES) * blisk.pitch_rad())
}

/// Sector of the part to both sides of an angle about the rotor's axis.
pub(super) fn sector_about(blisk: &Blisk, middle_rad: f64, reach_rad: f64) -> Sector {
    Sector {
        angles_rad: [middle_rad - reach_rad, middle_rad + reach_rad],
        faces_mm: blisk.blank.faces_mm,
        inner_radius_mm: bore_mm(blisk),
    }
}

/// Inner radius of blank and finished part.
pub(super) fn bore_mm(blisk: &Blisk) -> f64 {
    blisk.hub.profile_mm.iter().map(|[_, radius_mm]| *radius_mm).fold(f64::INFINITY, f64::min) - BELOW_HUB_MM
}
