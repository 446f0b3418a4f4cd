//! Cup-mill plan of a part with its proof, stock limits and times.

use arcfeed_plan::cup_mill::neighbours::NEARER_RATIO;
use arcfeed_plan::cup_mill::plan::SlotPlan;
use arcfeed_plan::cup_mill::plan::ValuedPlan;
use arcfeed_plan::geometry::blisk::Slot;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::output::baseline::{FlankMilling, PlannedTime, SlotSize, planned_time};
use arcfeed_plan::output::limits::{StockLimit, stock_limits};
use arcfeed_plan::output::nc;
use arcfeed_plan::placement::{Placement, any_table, check_travel, placement};
use arcfeed_plan::proof::verdict::Proof;

use super::refusal::{idle, with_remedy};
use crate::part::PartFile;
use crate::report::page::plan::BaselineResult;

/// Inverse time of indexing, as in the published listing: 1/50 min from slot to slot.
const INDEXING_PER_MIN: f64 = 50.0;

/// Cup-mill plan of one part with everything derived from it.
pub struct PlanResult {
    /// Content of the part file.
    pub part: PartFile,
    /// Geometry of the slot, in the coordinates of the part.
    pub slot: Slot,
    /// Path through the slot, with the fraction of the slot that it removes.
    pub valued: ValuedPlan,
    /// Positions of the machine's rotary axes.
    pub placement: Placement,
    /// Proof that the tool collides with nothing, and the material that it leaves.
    pub proof: Proof,
    /// Limits of the stock, by which the feed law finds its contact.
    pub limits: Vec<StockLimit>,
    /// Time of one slot on the planned path.
    pub time: PlannedTime,
    /// Flank milling of one slot for comparison, or the reason why there is none.
    pub baseline: Result<BaselineResult, String>,
}

impl PlanResult {
    /// Plans the slots of the part, and evaluates the plan.
    ///
    /// # Errors
    /// The reason why there is no plan.
    pub fn of(part: PartFile) -> Result<Self, String> {
        let found = part.flaws();
        if !found.is_empty() {
            return Err(format!("this rotor cannot be planned: {}", found.join("; ")));
        }
        let slot = part.blisk.slot();
        let presents = |plan: &SlotPlan| slot_placement(&part, plan).is_ok();
        let problem = Problem::new(&part.blisk, &slot, &part.cutter, &part.roughing);
        let proven = problem.and_then(|problem| problem.with_fixture(&part.fixtures).proven(part.axis, presents));
        let of_slot = |message: String| match part.slot_name() {
            Some(slot) => format!("{slot}: {message}"),
            None => message,
        };
        let (valued, proof) = proven.map_err(|why| of_slot(with_remedy(&why, &part.cutter)))?;
        if let Some(message) = idle(proof.removed.share_ratio()) {
            return Err(of_slot(message));
        }
        let plan = &valued.plan;
        let placement = slot_placement(&part, plan)?;
        if let Some(file) = &part.machine {
            let cutter = &part.cutter;
            let tool_mm = cutter.height_mm + cutter.holder_mm.iter().map(|[_, length_mm]| length_mm).sum::<f64>();
            check_travel(&file.machine, &plan.path, tool_mm).map_err(|error| error.to_string())?;
        }
        let (blank, tool_axis) = (&part.blisk.blank, plan.tool_axis());
        let limits = stock_limits(&plan.path, &part.cutter, blank, &tool_axis).map_err(|error| error.to_string())?;
        let volume_mm3 = proof.removed.total_mm3();
        let feeds = feeds(&part);
        let time = planned_time(&plan.path, |purpose| feeds.of(purpose), volume_mm3);
        let baseline = baseline(&part, &slot, volume_mm3);
        Ok(PlanResult { slot, placement, proof, limits, time, baseline, valued, part })
    }

    /// Whether the proof shows that the tool collides with nothing and keeps the allowance, except beside the edge
    /// about which it turns.
    pub fn is_safe(&self) -> bool {
        let allowance_mm = self.part.roughing.allowance_mm;
        self.proof.holds(allowance_mm, NEARER_RATIO * allowance_mm)
    }

    /// Whether the machine's rotary axes can reach the position that the plan needs.
    pub fn presents(&self, plan: &SlotPlan) -> bool {
        slot_placement(&self.part, plan).is_ok()
    }

    /// Position of the machine's axis B for each slot, degrees.
    pub fn slots_deg(&self) -> Vec<f64> {
        let pitch_deg = 360.0 / f64::from(self.part.blisk.blades);
        (0..self.part.blisk.blades).map(|slot| self.placement.index_deg + pitch_deg * f64::from(slot)).collect()
    }
}

/// Positions of the rotary axes for a plan, on the part's machine.
fn slot_placement(part: &PartFile, plan: &SlotPlan) -> Result<Placement, String> {
    let found = match &part.machine {
        Some(file) => placement(&file.machine, &plan.turn),
        None => placement(&any_table().map_err(|error| format!("{error:?}"))?, &plan.turn),
    };
    found.map_err(|error| error.to_string())
}

/// Feeds that the program has for this part.
pub fn feeds(part: &PartFile) -> nc::Feeds {
    let settings = &part.feeds;
    nc::Feeds {
        cutting_mm_per_min: settings.per_tooth_mm * f64::from(part.cutter.active_teeth) * settings.rev_per_min,
        approach_mm_per_min: settings.approach_mm_per_min,
        axial_mm_per_min: settings.axial_mm_per_min,
        indexing_per_min: INDEXING_PER_MIN,
    }
}

fn baseline(part: &PartFile, slot: &Slot, volume_mm3: f64) -> Result<BaselineResult, String> {
    let settings = part.baseline.ok_or("the part has no [baseline]")?;
    let mill = FlankMilling {
        diameter_mm: settings.diameter_mm,
        feed_mm_per_min: settings.feed_mm_per_min,
        axial_depth_mm: settings.axial_depth_mm,
        stepover_mm: settings.stepover_mm,
    };
    let size = SlotSize::of(slot, &part.blisk, part.roughing.allowance_mm);
    let passes = mill.passes(&size).map_err(|error| error.to_string())?;
    let time = mill.time(&size, volume_mm3).map_err(|error| error.to_string())?;
    Ok(BaselineResult { mill, passes, time })
}
