//! The same passage by plunging, by the cup mill and by flank milling, side by side.

use arcfeed_plan::output::baseline::{FlankMilling, SlotSize};
use arcfeed_plan::plunge::removed::removed_mm3;

use super::super::figures::Figures as CupMillFigures;
use super::super::plan_result::PlanResult;
use super::result::PlungeResult;

/// One way of roughing a passage.
pub struct Comparison {
    /// Name.
    pub name: &'static str,
    /// Time of the feed moves and volume, min and mm3, or the reason why there are none.
    pub outcome: Result<[f64; 2], String>,
    /// Allowance that is left on the blades, in words.
    pub left: String,
}

/// Rows of the table: plunging, and what else the part file describes.
pub fn comparisons(result: &PlungeResult) -> Vec<Comparison> {
    let part = &result.part;
    let middle_rad = result.plan.planes.first().map_or(0.0, |plane| plane.boundary.middle_rad);
    let about_rad = [middle_rad, part.blisk.pitch_rad()];
    let plunged_mm3 = removed_mm3(&result.plan.plunges, &part.blisk.blank, part.mill.radius_mm, about_rad);
    let allowance_mm = part.needs.allowance_mm;
    let all = result.left_over.iter().flat_map(|row| row.sides_mm.iter().flatten().flatten());
    let more_mm = all.copied().fold(0.0, f64::max);
    let plunging = Comparison {
        name: "plunge mill",
        outcome: Ok([result.passage_min, plunged_mm3]),
        left: format!("{allowance_mm:.2} to {:.2} mm on the blades, between cusps", allowance_mm + more_mm),
    };
    let cup = part.cup_mill.as_ref().map(|cup| {
        let planned = cup.clone().and_then(|cup| PlanResult::of(*cup));
        let left = planned.as_ref().map_or(String::new(), |planned| {
            let [pressure, suction, _] =
                CupMillFigures::of(planned).removed.left_max_mm.map(|most_mm| allowance_mm + most_mm);
            format!("up to {pressure:.2} mm on the pressure side, {suction:.2} mm on the suction side")
        });
        let figures = |planned: PlanResult| [planned.time.slot.cutting_min, planned.proof.removed.total_mm3()];
        Comparison { name: "cup mill", outcome: planned.map(figures), left }
    });
    let flank = part.baseline.map(|settings| {
        let mill = FlankMilling {
            diameter_mm: settings.diameter_mm,
            feed_mm_per_min: settings.feed_mm_per_min,
            axial_depth_mm: settings.axial_depth_mm,
            stepover_mm: settings.stepover_mm,
        };
        let size = SlotSize::of(&part.blisk.slot(), &part.blisk, allowance_mm);
        let time = mill.time(&size, plunged_mm3).map_err(|error| error.to_string());
        let outcome = time.map(|time| [time.cutting_min, plunged_mm3]);
        Comparison {
            name: "ball-end mill, by flank milling",
            outcome,
            left: format!("{allowance_mm:.2} mm and scallops, assumed"),
        }
    });
    std::iter::once(plunging).chain(cup).chain(flank).collect()
}
