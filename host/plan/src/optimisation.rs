//! Optimisation of a plan: the axis and the ring width that remove most from a slot (Petean, section 3.3.2, Fig. 3.11).
//!
//! A wider ring with the same limit points lies closer to both blades, until it does not pass any more. The value of a
//! plan is the fraction of the slot that it removes, between the blades and above the hub with their allowances: the
//! volume of the columns under the ring's path.

use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::cup_mill::infeasibility::Infeasible;
use crate::cup_mill::plan::{AxisChoice, BaseLimits, PreparedSlot, Roughing, SlotPlan};
use crate::cup_mill::room::{Room, Rooms};
use crate::cup_mill::turns::Surroundings;
use crate::cutter::CupMill;
use crate::geometry::blisk::{Blisk, Slot};
use crate::proof::floor::Floor;
use crate::proof::remaining::SlotWalls;
use crate::proof::removal::{RemovedVolumes, Stock, removed};

/// Slot to be planned.
pub struct Problem<'p> {
    blisk: &'p Blisk,
    cutter: &'p CupMill,
    roughing: &'p Roughing,
    prepared: PreparedSlot,
}

/// Plan and its removed volumes.
#[derive(Clone, Debug)]
pub struct ValuedPlan {
    /// Plan.
    pub plan: SlotPlan,
    /// Volumes.
    pub removed: RemovedVolumes,
}

/// Width of the ring, and its result.
#[derive(Clone, Debug)]
pub struct Trial {
    /// R - r, mm.
    pub width_mm: f64,
    /// Removed fraction of the slot, or the reason why there is no plan.
    pub share_ratio: Result<f64, Infeasible>,
}

/// Cell size for the comparison of plans, mm.
const CELL_MM: f64 = 1.0;
/// Most directions of the ridge that are planned.
const RIDGE_MAX: usize = 12;
/// Number of widths of the coarse search.
const LOOKS: i32 = 24;
/// Steps of the golden-section search after it.
const SECTIONS: i32 = 8;
/// Ratio of the golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

impl<'p> Problem<'p> {
    /// Problem from a rotor, its slot in the part frame, a cutter, and the requirements.
    ///
    /// # Errors
    /// A blade is not above the hub.
    pub fn new(
        blisk: &'p Blisk,
        slot: &'p Slot,
        cutter: &'p CupMill,
        roughing: &'p Roughing,
    ) -> Result<Self, Infeasible> {
        let prepared = PreparedSlot::new(blisk, slot, roughing.allowance_mm)?;
        Ok(Problem { blisk, cutter, roughing, prepared })
    }

    /// Plan that removes most among those that `admits` accepts.
    ///
    /// # Errors
    /// See [`Problem::ranked`].
    pub fn best(&self, admits: impl Fn(&SlotPlan) -> bool) -> Result<ValuedPlan, Infeasible> {
        self.ranked(admits).map(|mut ranked| ranked.swap_remove(0))
    }

    /// Plans that `admits` accepts, those that remove most first, at least one: along the blade's axis, the roomiest
    /// direction, and others with at least half of its room.
    ///
    /// # Errors
    /// Reason for the roomiest axis, if there is no plan: the least missing width.
    pub fn ranked(&self, admits: impl Fn(&SlotPlan) -> bool) -> Result<Vec<ValuedPlan>, Infeasible> {
        let rooms = self.prepared.walls.rooms(self.cutter).ok_or(Infeasible::NoAxis)?;
        let along = |room: Room| self.along(AxisChoice::Found(room));
        let blade = || self.prepared.near_blade(self.cutter, || Some(rooms.roomiest)).map(along);
        let (blade, roomiest) = rayon::join(blade, || along(rooms.roomiest));
        let others = if roomiest.is_ok() { ridge(&rooms) } else { Vec::new() };
        let mut tried: Vec<_> = others.into_par_iter().map(|axis| self.along(axis)).collect();
        tried.extend(blade.into_iter().chain([roomiest.clone()]));
        let mut found: Vec<ValuedPlan> = tried.into_iter().flatten().filter(|valued| admits(&valued.plan)).collect();
        found.sort_by(|a, b| b.removed.share_ratio().total_cmp(&a.removed.share_ratio()));
        if found.is_empty() { roomiest.map(|plan| vec![plan]) } else { Ok(found) }
    }

    /// Plan with one axis.
    ///
    /// # Errors
    /// There is none.
    pub fn along(&self, axis: AxisChoice) -> Result<ValuedPlan, Infeasible> {
        self.valued(self.cutter, axis)
    }

    fn valued(&self, cutter: &CupMill, axis: AxisChoice) -> Result<ValuedPlan, Infeasible> {
        let roughing = Roughing { axis, ..*self.roughing };
        let (mut plan, mut around) = self.prepared.plan(cutter, &roughing, BaseLimits::Sides)?;
        if around.cuts_edge(cutter, plan.base.centre)
            && let Ok(whole) = self.prepared.plan(cutter, &roughing, BaseLimits::WholeBlades)
        {
            (plan, around) = whole;
        }
        let Surroundings { pressure, suction, .. } = around;
        let walls = SlotWalls::between([pressure, suction], &self.blisk.hub, roughing.allowance_mm, plan.turn);
        let stock = Stock { blank: &self.blisk.blank, to_slot: plan.turn };
        let floor = Floor::new(cutter, &plan.path.steps());
        let removed = removed(&floor, plan.path.levels.len(), &stock, &walls, CELL_MM);
        Ok(ValuedPlan { plan, removed })
    }

    /// Result of a ring of another width about the same mean radius, along one axis.
    pub fn trial(&self, width_mm: f64, axis: AxisChoice) -> Trial {
        let valued = self.valued(&resized(self.cutter, width_mm), axis);
        Trial { width_mm, share_ratio: valued.map(|valued| valued.removed.share_ratio()) }
    }

    /// Results of many widths, in order.
    pub fn trials(&self, widths_mm: Vec<f64>, axis: AxisChoice) -> Vec<Trial> {
        widths_mm.into_par_iter().map(|width_mm| self.trial(width_mm, axis)).collect()
    }

    /// Width that removes most along an axis, between half the cutter's width and the largest with room.
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

/// The cutter with another width about the same mean radius.
pub fn resized(cutter: &CupMill, width_mm: f64) -> CupMill {
    let middle_mm = (cutter.outer_radius_mm + cutter.inner_radius_mm) / 2.0;
    let (outer_radius_mm, inner_radius_mm) = (middle_mm + width_mm / 2.0, middle_mm - width_mm / 2.0);
    CupMill { outer_radius_mm, inner_radius_mm, ..cutter.clone() }
}
