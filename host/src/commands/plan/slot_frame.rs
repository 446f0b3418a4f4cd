//! Surroundings of a place of the rotor: the sector of the part about it; those of a slot also in the slot frame.

use arcfeed_plan::geometry::blisk::{Blank, Blisk};
use arcfeed_plan::geometry::mesh::{Sector, Triangle};
use arcfeed_plan::output::workpiece::BlankRing;
use arcfeed_plan::vector::{FrameRotation, Point};

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

/// First and last of the blades in the sector about the slot: both blades of the slot, and with splitters one more on each side.
pub(super) fn blades(composed: &PlanResult) -> [i32; 2] {
    let blisk = &composed.part.blisk;
    let [first, last] = if blisk.facing() > 0 { [0, 1] } else { [-1, 0] };
    let beside = blisk.kinds() - 1;
    [first - beside, last + beside]
}

/// Sector of the part about the slot, as far as its neighbours.
pub(super) fn sector(composed: &PlanResult) -> Sector {
    let blisk = &composed.part.blisk;
    sector_of_reach(composed, (0.5 * blisk.slot_ratio() + BESIDE_PITCHES) * blisk.pitch_rad())
}

/// Sector of the part to both sides of the middle of the slot.
pub(super) fn sector_of_reach(composed: &PlanResult, reach_rad: f64) -> Sector {
    let blisk = &composed.part.blisk;
    let at = |point: Point| libm::atan2(point.y, point.x);
    let from = at(composed.slot.pressure.point(0.5, 0.5));
    let facing = f64::from(blisk.facing());
    let middle = from + facing * blisk.slot_ratio() * blisk.pitch_rad() / 2.0;
    sector_about(blisk, middle, reach_rad)
}

/// Sector of the part to both sides of an angle about the rotor's axis.
pub(super) fn sector_about(blisk: &Blisk, middle_rad: f64, reach_rad: f64) -> Sector {
    Sector {
        angles_rad: [middle_rad - reach_rad, middle_rad + reach_rad],
        faces_mm: blisk.blank.faces_mm,
        inner_radius_mm: bore_mm(blisk),
    }
}

/// The whole blank, in a frame of the tool.
pub(super) fn ring(blisk: &Blisk, to_tool: &FrameRotation) -> BlankRing {
    let Blank { radius_mm, faces_mm } = blisk.blank;
    BlankRing { ends_mm: faces_mm.map(|z_mm| to_tool * Point::new(0.0, 0.0, z_mm)), radius_mm, bore_mm: bore_mm(blisk) }
}

/// Inner radius of blank and finished part.
fn bore_mm(blisk: &Blisk) -> f64 {
    blisk.hub.profile_mm.iter().map(|[_, radius_mm]| *radius_mm).fold(f64::INFINITY, f64::min) - BELOW_HUB_MM
}
