//! What a cutter could do better: the axis and the width of the ring that take most out of a slot (Petean, section 3.3.2, Fig. 3.11).
//!
//! A wider ring with the same limit points lies closer to both blades, until it does not pass any more. What a plan is worth is the share of the slot
//! that it takes, between the blades and above the hub with their allowances: the volume of the columns under the ring's way.

use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::cup_mill::fit::{Room, Rooms};
use crate::cup_mill::infeasible::Infeasible;
use crate::cup_mill::plan::{AxisChoice, Prepared, Roughing, SlotPlan};
use crate::cup_mill::turns::Around;
use crate::cutter::CupMill;
use crate::geometry::blisk::{Blisk, Slot};
use crate::proof::floor::Floor;
use crate::proof::left::Walls;
use crate::proof::removed::{Removed, Stock, removed};

/// A slot to be planned.
pub struct Problem<'p> {
    blisk: &'p Blisk,
    cutter: &'p CupMill,
    roughing: &'p Roughing,
    prepared: Prepared<'p>,
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

impl<'p> Problem<'p> {
    /// A rotor, its slot in the part frame, a cutter, and what is asked.
    ///
    /// # Errors
    /// A blade is not above the hub.
    pub fn new(
        blisk: &'p Blisk,
        slot: &'p Slot,
        cutter: &'p CupMill,
        roughing: &'p Roughing,
    ) -> Result<Self, Infeasible> {
        let prepared = Prepared::new(blisk, slot, roughing.allowance_mm)?;
        Ok(Problem { blisk, cutter, roughing, prepared })
    }

    /// The plan that takes most of those that `admits` lets pass: along the blade's axis, the roomiest, and others with at least half of its room.
    ///
    /// # Errors
    /// That of the roomiest axis, where there is no plan: what is missing at least.
    pub fn best(&self, admits: impl Fn(&SlotPlan) -> bool) -> Result<Valued, Infeasible> {
        let rooms = self.prepared.walls.rooms(self.cutter).ok_or(Infeasible::NoAxis)?;
        let along = |room: Room| self.along(AxisChoice::Found(room));
        let blade = || self.prepared.near_blade(self.cutter, || Some(rooms.roomiest)).map(along);
        let (blade, roomiest) = rayon::join(blade, || along(rooms.roomiest));
        let others = if roomiest.is_ok() { ridge(&rooms) } else { Vec::new() };
        let mut tried: Vec<_> = others.into_par_iter().map(|axis| self.along(axis)).collect();
        tried.extend(blade.into_iter().chain([roomiest.clone()]));
        let found = tried.into_iter().flatten().filter(|valued| admits(&valued.plan));
        let best = found.max_by(|a, b| a.removed.share_ratio().total_cmp(&b.removed.share_ratio()));
        best.map_or(roomiest, Ok)
    }

    /// The plan with one axis.
    ///
    /// # Errors
    /// There is none.
    pub fn along(&self, axis: AxisChoice) -> Result<Valued, Infeasible> {
        self.valued(self.cutter, axis)
    }

    fn valued(&self, cutter: &CupMill, axis: AxisChoice) -> Result<Valued, Infeasible> {
        let roughing = Roughing { axis, ..*self.roughing };
        let (plan, Around { pressure, suction, .. }) = self.prepared.plan(cutter, &roughing)?;
        let walls = Walls::between([pressure, suction], &self.blisk.hub, roughing.allowance_mm, plan.turn);
        let stock = Stock { blank: &self.blisk.blank, to_slot: plan.turn };
        let floor = Floor::new(cutter, &plan.path.steps());
        let removed = removed(&floor, plan.path.levels.len(), &stock, &walls, CELL_MM);
        Ok(Valued { plan, removed })
    }

    /// What a ring of another width about the same middle takes, along one axis.
    pub fn trial(&self, width_mm: f64, axis: AxisChoice) -> Trial {
        let valued = self.valued(&resized(self.cutter, width_mm), axis);
        Trial { width_mm, share_ratio: valued.map(|valued| valued.removed.share_ratio()) }
    }

    /// The same of many widths, in their order.
    pub fn trials(&self, widths_mm: Vec<f64>, axis: AxisChoice) -> Vec<Trial> {
        widths_mm.into_par_iter().map(|width_mm| self.trial(width_mm, axis)).collect()
    }

    /// The width that takes most along an axis, between half the cutter's and that for which there is no room any more.
    pub fn best_width(&self, axis: AxisChoice) -> Option<Trial> {
        let here = self.along(axis).ok()?.plan.room;
        let width_mm = self.cutter.outer_radius_mm - self.cutter.inner_radius_mm;
        let range = [width_mm / 2.0, width_mm + 2.0 * here.room_mm];
        let step_mm = (range[1] - range[0]) / f64::from(LOOKS);
        let looks = self.trials((0..=LOOKS).map(|k| range[0] + step_mm * f64::from(k)).collect(), axis);
        let mut best = looks.into_iter().max_by(|a, b| a.worth().total_cmp(&b.worth()))?;
        let mut ends = [(best.width_mm - step_mm).max(range[0]), (best.width_mm + step_mm).min(range[1])];
        for _ in 0..SECTIONS {
            let inner = [GOLDEN, 1.0 - GOLDEN].map(|share| ends[0] * share + ends[1] * (1.0 - share));
            let (low, high) = rayon::join(|| self.trial(inner[0], axis), || self.trial(inner[1], axis));
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

/// Directions with at least half of the most room, not too many of them.
fn ridge(rooms: &Rooms) -> Vec<AxisChoice> {
    let enough_mm = rooms.roomiest.room_mm / 2.0;
    if enough_mm <= 0.0 {
        return Vec::new();
    }
    let found: Vec<_> = rooms.grid.iter().filter(|room| room.room_mm >= enough_mm).collect();
    let stride = found.len().div_ceil(RIDGE_MAX).max(1);
    found.iter().step_by(stride).map(|room| AxisChoice::Given(room.direction)).collect()
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
