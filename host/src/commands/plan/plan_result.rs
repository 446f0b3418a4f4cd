//! Cup-mill plans of a part, one for each pass, with their proofs, stock limits and times.

use std::sync::Arc;

use arcfeed_plan::cup_mill::neighbours::NEARER_RATIO;
use arcfeed_plan::cup_mill::plan::SlotPlan;
use arcfeed_plan::cup_mill::plan::ValuedPlan;
use arcfeed_plan::geometry::blisk::Slot;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::output::baseline::{FlankMilling, PlannedTime, SlotSize, planned_time};
use arcfeed_plan::output::limits::{StockLimit, stock_limits};
use arcfeed_plan::output::nc;
use arcfeed_plan::path::Pass;
use arcfeed_plan::placement::{Placement, any_table, check_travel, placement};
use arcfeed_plan::proof::verdict::Proof;

use super::refusal::{idle, with_remedy};
use crate::console::note;
use crate::part::PartFile;
use crate::report::page::plan::BaselineResult;

/// Inverse time of indexing, as in the published listing: 1/50 min from slot to slot.
const INDEXING_PER_MIN: f64 = 50.0;

/// Reason why there is no further pass.
const UNPROVEN: &str = "none of the best paths for it is proven free of collisions";

/// Cup-mill plan of one pass through the slots of a part, with everything derived from it.
pub struct PlanResult {
    /// Content of the part file.
    pub part: Arc<PartFile>,
    /// Passes through the slot before this one.
    pub earlier: Vec<Pass>,
    /// Fraction of the slot that this pass and all earlier ones remove, 0 to 1.
    pub with_earlier_ratio: f64,
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
    /// Plans the first pass through the slots of the part, and evaluates the plan.
    ///
    /// # Errors
    /// The reason why there is no plan.
    pub fn of(part: PartFile) -> Result<Self, String> {
        PlanResult::passes(PartFile { passes_max: 1, ..part }).map(|mut passes| passes.swap_remove(0))
    }

    /// Plans the passes through the slots of the part, at least one; each removes most of what earlier ones have left. If there are
    /// fewer than the part asks for, a note has the reason.
    ///
    /// # Errors
    /// The reason why there is no plan of the first pass.
    pub fn passes(part: PartFile) -> Result<Vec<Self>, String> {
        let found = part.flaws();
        if !found.is_empty() {
            return Err(format!("this rotor cannot be planned: {}", found.join("; ")));
        }
        let part = Arc::new(part);
        let of_slot = |message: String| match part.slot_name() {
            Some(slot) => format!("{slot}: {message}"),
            None => message,
        };
        let slot = part.blisk.slot();
        let problem = Problem::new(&part.blisk, &slot, &part.cutter, &part.roughing);
        let problem = problem.map_err(|why| of_slot(with_remedy(&why, &part.cutter)))?;
        let mut problem = problem.with_fixture(&part.fixtures);
        let mut passes = vec![PlanResult::next(&part, &slot, &problem, 0.0).map_err(of_slot)?];
        while let Some(last) = passes.last().filter(|last| last.is_safe() && last.number() < part.passes_max) {
            problem.add_pass(&last.valued.plan);
            let next = PlanResult::next(&part, &slot, &problem, last.with_earlier_ratio);
            match next.and_then(|next| if next.is_safe() { Ok(next) } else { Err(UNPROVEN.into()) }) {
                Ok(next) => passes.push(next),
                Err(why) => {
                    note(format_args!("no pass {}: {why}", passes.len() + 1));
                    break;
                }
            }
        }
        Ok(passes)
    }

    /// Plan of the next pass, before which `removed_ratio` of the slot has been removed.
    fn next(part: &Arc<PartFile>, slot: &Slot, problem: &Problem<'_>, removed_ratio: f64) -> Result<Self, String> {
        let part = Arc::clone(part);
        let presents = |plan: &SlotPlan| slot_placement(&part, plan).is_ok();
        let proven = problem.proven(part.axis, presents);
        let (valued, proof) = proven.map_err(|why| with_remedy(&why, &part.cutter))?;
        if let Some(message) = idle(proof.removed.share_ratio()) {
            return Err(message);
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
        let earlier = problem.earlier().to_vec();
        let baseline = if earlier.is_empty() {
            baseline(&part, slot, volume_mm3)
        } else {
            Err("flank milling is compared with the first pass".into())
        };
        let with_earlier_ratio = removed_ratio + proof.removed.share_ratio();
        let slot = slot.clone();
        Ok(PlanResult { earlier, with_earlier_ratio, slot, placement, proof, limits, time, baseline, valued, part })
    }

    /// Number of the pass, from 1.
    pub fn number(&self) -> usize {
        self.earlier.len() + 1
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
