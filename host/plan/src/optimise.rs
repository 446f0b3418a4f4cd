//! What a cutter could do better: the axis and the width of the ring that take most out of a slot (Petean, section 3.3.2, Fig. 3.11).
//!
//! A wider ring with the same limit points lies closer to both blades, until it does not pass any more. What a plan is worth is the share of the slot
//! that it takes, between the blades and above the hub with their allowances: the volume of the columns under the ring's way.

use nalgebra::Rotation3;

use crate::cup_mill::fit;
use crate::cup_mill::infeasible::Infeasible;
use crate::cup_mill::plan::{AxisChoice, Roughing, SlotPlan, plan};
use crate::cup_mill::side::{FarEdge, Hub, Side};
use crate::cutter::CupMill;
use crate::geometry::blisk::{Blisk, Slot};
use crate::proof::floor::Floor;
use crate::proof::left::Walls;
use crate::proof::removed::{Removed, Stock, removed};
use crate::vector::Vector;

/// A slot to be planned.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'p> {
    /// The rotor.
    pub blisk: &'p Blisk,
    /// Its slot, part frame.
    pub slot: &'p Slot,
    /// The cutter.
    pub cutter: &'p CupMill,
    /// What is asked.
    pub roughing: &'p Roughing,
}

/// A plan and what it takes.
#[derive(Clone, Debug)]
pub struct Valued {
    /// The plan.
    pub plan: SlotPlan,
    /// Its volumes.
    pub removed: Removed,
}

/// A width of the ring, and what comes of it.
#[derive(Clone, Debug)]
pub struct Trial {
    /// R - r, mm.
    pub width_mm: f64,
    /// The share of the slot that is taken, or why there is no plan.
    pub share_ratio: Result<f64, Infeasible>,
}

/// Cells in which plans are compared, mm.
const CELL_MM: f64 = 1.0;
/// Directions of the ridge that are planned at most.
const RIDGE_MAX: usize = 12;
/// Widths of the first look.
const LOOKS: i32 = 24;
/// Steps of the golden section after it.
const SECTIONS: i32 = 8;
/// The golden section's share.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

impl Problem<'_> {
    /// The plan that takes most of those that `admits` lets pass: along the blade's axis, the roomiest, and others with at least half of its room.
    ///
    /// # Errors
    /// That of the roomiest axis, where there is no plan: what is missing at least.
    pub fn best(&self, admits: impl Fn(&SlotPlan) -> bool) -> Result<Valued, Infeasible> {
        let roomiest = self.along(AxisChoice::Roomiest);
        let room_mm = roomiest.as_ref().map_or(0.0, |valued| valued.plan.room.room_mm);
        let others = self.ridge(room_mm / 2.0);
        let tried = others.into_iter().map(AxisChoice::Given).chain([AxisChoice::Blade]).map(|axis| self.along(axis));
        let found = tried.chain([roomiest.clone()]).flatten().filter(|valued| admits(&valued.plan));
        let best = found.max_by(|a, b| a.removed.share_ratio().total_cmp(&b.removed.share_ratio()));
        best.map_or(roomiest, Ok)
    }

    /// Directions with enough room, not too many of them.
    fn ridge(&self, enough_mm: f64) -> Vec<Vector> {
        let roughing = self.roughing;
        let above = Hub { hub: &self.blisk.hub, allowance_mm: roughing.allowance_mm };
        let lying = Rotation3::identity();
        let pressure = Side::new(&self.slot.pressure, FarEdge::Trailing, &above, &lying);
        let suction = Side::new(&self.slot.suction, FarEdge::Leading, &above, &lying);
        let Some((pressure, suction)) = pressure.zip(suction).filter(|_| enough_mm > 0.0) else { return Vec::new() };
        let rooms = fit::Walls::new(&pressure, &suction).roomy(self.cutter, enough_mm);
        let stride = rooms.len().div_ceil(RIDGE_MAX).max(1);
        rooms.iter().step_by(stride).map(|room| room.direction).collect()
    }

    /// The plan with one axis.
    ///
    /// # Errors
    /// There is none.
    pub fn along(&self, axis: AxisChoice) -> Result<Valued, Infeasible> {
        let roughing = Roughing { axis, ..*self.roughing };
        let plan = plan(self.blisk, self.slot, self.cutter, &roughing)?;
        let walls = Walls::new(self.slot, &self.blisk.hub, roughing.allowance_mm, plan.turn);
        let walls = walls.ok_or(Infeasible::NoFoot("pressure"))?;
        let stock = Stock { blank: &self.blisk.blank, to_slot: plan.turn };
        let floor = Floor::new(self.cutter, &plan.path.steps());
        let removed = removed(&floor, plan.path.levels.len(), &stock, &walls, CELL_MM);
        Ok(Valued { plan, removed })
    }

    /// What a ring of another width about the same middle takes, along one axis.
    pub fn trial(&self, width_mm: f64, axis: AxisChoice) -> Trial {
        let cutter = resized(self.cutter, width_mm);
        let valued = Problem { cutter: &cutter, ..*self }.along(axis);
        Trial { width_mm, share_ratio: valued.map(|valued| valued.removed.share_ratio()) }
    }

    /// The width that takes most along an axis, between half the cutter's and that for which there is no room any more.
    pub fn best_width(&self, axis: AxisChoice) -> Option<Trial> {
        let here = self.along(axis).ok()?.plan.room;
        let width_mm = self.cutter.outer_radius_mm - self.cutter.inner_radius_mm;
        let range = [width_mm / 2.0, width_mm + 2.0 * here.room_mm];
        let step_mm = (range[1] - range[0]) / f64::from(LOOKS);
        let looks = (0..=LOOKS).map(|k| self.trial(range[0] + step_mm * f64::from(k), axis));
        let mut best = looks.max_by(|a, b| a.worth().total_cmp(&b.worth()))?;
        let mut ends = [(best.width_mm - step_mm).max(range[0]), (best.width_mm + step_mm).min(range[1])];
        for _ in 0..SECTIONS {
            let inner = [GOLDEN, 1.0 - GOLDEN].map(|share| ends[0] * share + ends[1] * (1.0 - share));
            let [low, high] = inner.map(|width_mm| self.trial(width_mm, axis));
            ends = if low.worth() > high.worth() { [ends[0], inner[1]] } else { [inner[0], ends[1]] };
            for trial in [low, high] {
                if trial.worth() > best.worth() {
                    best = trial;
                }
            }
        }
        best.share_ratio.is_ok().then_some(best)
    }
}

impl Trial {
    fn worth(&self) -> f64 {
        self.share_ratio.as_ref().map_or(-1.0, |share| *share)
    }
}

/// The cutter with another width about the same middle radius.
pub fn resized(cutter: &CupMill, width_mm: f64) -> CupMill {
    let middle_mm = (cutter.outer_radius_mm + cutter.inner_radius_mm) / 2.0;
    let (outer_radius_mm, inner_radius_mm) = (middle_mm + width_mm / 2.0, middle_mm - width_mm / 2.0);
    CupMill { outer_radius_mm, inner_radius_mm, ..cutter.clone() }
}
