//! Thickness of the material that the ring leaves on a surface.
//!
//! At a point of the surface, it is the least distance from the ring along the paths of all passes.

use nalgebra::Rotation3;

use crate::cup_mill::side::{FarEdge, Hub, OffsetSide};
use crate::geometry::blisk::{Revolution, Slot};
use crate::parallel;
use crate::vector::Point;

use super::motion::Motion;
use super::search::Search;
use super::section::Section;
use super::spheres::Tree;

/// Map of the material that remains on a surface: its thickness, mm, in rows; negative where the ring has cut into the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Number of values in a row; a row runs along the chord, from the leading edge.
    pub columns: usize,
    /// Values row by row, from the hub to the tip; on the hub from the pressure side to the suction side.
    pub values_mm: Vec<f64>,
}

/// Material that remains on the surfaces of a slot beyond the allowance.
#[derive(Clone, Debug, PartialEq)]
pub struct RemainingMaterial {
    /// Material on the pressure side.
    pub pressure: Map,
    /// Material on the suction side.
    pub suction: Map,
    /// Material on the hub between the sides.
    pub hub: Map,
}

/// Ring of a cup mill on its path, for measuring the material that it leaves.
pub struct Ring<'r> {
    /// Ring as pieces with an exact distance.
    pub sections: &'r [Section],
    /// Path of the ring, step by step.
    pub motions: &'r [Motion],
    /// Largest error of a distance, mm.
    pub gap_mm: f64,
}

/// Surfaces about a slot that keep their allowance: both sides and the hub.
pub struct SlotWalls<'w> {
    /// Pressure and suction side between the blades' round edges, from the hub's allowance up; slot frame.
    sides: [OffsetSide; 2],
    /// Hub, part frame.
    hub: &'w Revolution,
    /// Rotation from the part frame to the slot frame.
    to_slot: Rotation3<f64>,
    allowance_mm: f64,
    /// Largest radius of the hub.
    hub_radius_mm: f64,
}

impl Map {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.values_mm.len() / self.columns.max(1)
    }

    /// Smallest and largest thickness, mm.
    pub fn range_mm(&self) -> [f64; 2] {
        let over = |start: f64, choose: fn(f64, f64) -> f64| self.values_mm.iter().copied().fold(start, choose);
        [over(f64::INFINITY, f64::min), over(f64::NEG_INFINITY, f64::max)]
    }

    /// Mean thickness, mm.
    pub fn mean_mm(&self) -> f64 {
        self.values_mm.iter().sum::<f64>() / self.values_mm.len() as f64
    }
}

/// Material that the ring leaves on the walls of a slot in all its passes, on a grid of rows and columns. Each pass has the rotation
/// from the walls' slot frame to its own.
pub fn leaves(
    passes: &[(Ring<'_>, Rotation3<f64>)],
    walls: &SlotWalls<'_>,
    [rows, columns]: [usize; 2],
) -> RemainingMaterial {
    let share = |k: usize, count: usize| k as f64 / count.saturating_sub(1).max(1) as f64;
    let map = |point: &(dyn Fn(f64, f64) -> Point + Sync)| {
        let at = |&place: &usize| {
            let point = point(share(place % columns, columns), share(place / columns, rows));
            let distances_mm = passes.iter().map(|(ring, turn)| ring.nearest_mm(turn * point));
            distances_mm.fold(f64::INFINITY, f64::min)
        };
        Map { columns, values_mm: parallel::map(&(0..rows * columns).collect::<Vec<_>>(), &at) }
    };
    let [pressure, suction] = [0, 1].map(|side| map(&|u, v| walls.side(side, u, v)));
    RemainingMaterial { pressure, suction, hub: map(&|u, v| walls.floor(u, v)) }
}

impl Ring<'_> {
    /// Smallest distance of a point from the ring along the whole path, mm.
    pub fn nearest_mm(&self, point: Point) -> f64 {
        let tree = Tree::new(vec![[point; 3]]);
        let turns = [Rotation3::identity()];
        let search = Search { sections: self.sections, motions: self.motions, tree: &tree, turns: &turns };
        search.least(self.gap_mm).bounds_mm[1]
    }
}

impl<'w> SlotWalls<'w> {
    /// Walls of a slot; slot and hub are given in the part frame. `None` if a blade is not above the hub.
    pub fn new(slot: &Slot, hub: &'w Revolution, allowance_mm: f64, to_slot: Rotation3<f64>) -> Option<Self> {
        let side = |face, far| OffsetSide::new(face, far, &Hub { hub, allowance_mm }, &to_slot);
        let sides = [side(&slot.pressure, FarEdge::Trailing)?, side(&slot.suction, FarEdge::Leading)?];
        Some(SlotWalls::between(sides, hub, allowance_mm, to_slot))
    }

    /// Walls between two sides, pressure and suction, in the slot frame.
    pub fn between(sides: [OffsetSide; 2], hub: &'w Revolution, allowance_mm: f64, to_slot: Rotation3<f64>) -> Self {
        let hub_radius_mm = hub.profile_mm.iter().map(|place| place[1]).fold(0.0, f64::max);
        SlotWalls { sides, hub, to_slot, allowance_mm, hub_radius_mm }
    }

    /// Point of the pressure (0) or suction side (1): u from the leading to the trailing edge, v from the hub to the
    /// tip.
    pub fn side(&self, side: usize, u: f64, v: f64) -> Point {
        self.sides[side].at([u, v])
    }

    /// Point of the hub between corresponding points of the blades' feet, `across` from the pressure to the suction
    /// side.
    pub fn floor(&self, u: f64, across: f64) -> Point {
        let feet = [0, 1].map(|side| self.to_slot.inverse() * self.side(side, u, 0.0));
        let angles = feet.map(|foot| libm::atan2(foot.y, foot.x));
        let angle_rad = angles[0] + across * libm::remainder(angles[1] - angles[0], core::f64::consts::TAU);
        let [z, radius_mm] = beyond(self.hub, feet[0].z + across * (feet[1].z - feet[0].z), self.allowance_mm);
        self.to_slot * Point::new(radius_mm * libm::cos(angle_rad), radius_mm * libm::sin(angle_rad), z)
    }

    /// Whether a point, in coordinates of the slot frame, lies in the hub or in the layer of material that is left on it (the allowance).
    pub fn is_hub(&self, point: &Point) -> bool {
        let point = self.to_slot.inverse() * point;
        let is_near = libm::hypot(point.x, point.y) < self.hub_radius_mm + self.allowance_mm;
        is_near && self.hub.height_mm(&point) < self.allowance_mm
    }
}

/// Point of a profile at some z, moved along its normal: z and radius.
fn beyond(hub: &Revolution, z: f64, by_mm: f64) -> [f64; 2] {
    let pieces = || hub.profile_mm.windows(2);
    let Some(piece) = pieces().find(|pair| z <= pair[1][0]).or(pieces().last()) else { return [z, by_mm] };
    let [along, up] = [piece[1][0] - piece[0][0], piece[1][1] - piece[0][1]];
    let share = ((z - piece[0][0]) / along).clamp(0.0, 1.0);
    let length = libm::hypot(along, up);
    [z - by_mm * up / length, piece[0][1] + share * up + by_mm * along / length]
}
