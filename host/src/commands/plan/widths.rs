//! Comparison of a cup-mill plan with rings of other widths and middle radii.

use arcfeed_plan::cup_mill::plan::SlotPlan;
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::rings::{Trial, trials};
use serde::Serialize;

use super::super::outcome::{Failure, say};
use super::plan_result::PlanResult;
use crate::console::note;

/// Figures of one ring.
#[derive(Debug, Serialize)]
struct WidthFigures {
    width_mm: f64,
    outer_radius_mm: f64,
    share_ratio: Option<f64>,
    refused: Option<String>,
}

/// Prints the results for rings of other widths; each is planned and proven as the part's own ring is.
///
/// # Errors
/// No ring fits between the blades.
pub fn widths(composed: &PlanResult, json: bool) -> Result<(), Failure> {
    let part = &composed.part;
    let problem = Problem::new(&part.blisk, &composed.slot, &part.cutter, &part.roughing);
    let problem = problem.map_err(|why| Failure::Input(why.to_string()))?.with_fixture(&part.fixtures);
    note(format_args!("planning and proving some twenty other rings"));
    let presents = |plan: &SlotPlan| composed.presents(plan);
    let share = |cutter: &CupMill| {
        let share = problem.share_ratio(cutter, part.axis, &presents);
        let width_mm = cutter.outer_radius_mm - cutter.inner_radius_mm;
        let result = share.as_ref().map_or_else(ToString::to_string, |share| format!("{:.2} %", 100.0 * share));
        note(format_args!("ring of {:.3} mm, {width_mm:.3} mm wide: {result}", cutter.outer_radius_mm));
        share
    };
    let [by_width, by_middle] = trials(&part.cutter, share);
    let worths = by_width.iter().chain(&by_middle).map(Trial::worth);
    let most = worths.fold(f64::NEG_INFINITY, f64::max);
    if most < 0.0 {
        return Err(Failure::Input("no ring of any width passes".into()));
    }
    if !json {
        say(format_args!("  ring's width, mm   outer radius, mm   taken of the slot, %"));
    }
    let own_mm = part.cutter.outer_radius_mm - part.cutter.inner_radius_mm;
    for (trial, is_own) in by_width
        .iter()
        .map(|trial| (trial, trial.width_mm == own_mm))
        .chain(by_middle.iter().map(|trial| (trial, false)))
    {
        let outer_radius_mm = trial.middle_mm + trial.width_mm / 2.0;
        let (share_ratio, refused) = match &trial.share_ratio {
            Ok(share) => (Some(*share), None),
            Err(why) => (None, Some(why.to_string())),
        };
        if json {
            let figures = WidthFigures { width_mm: trial.width_mm, outer_radius_mm, share_ratio, refused };
            say(format_args!("{}", serde_json::to_string(&figures).unwrap_or_default()));
        } else {
            let mark = match (trial.worth() >= most, is_own) {
                (true, true) => "  most, this cutter",
                (true, false) => "  most",
                (false, true) => "  this cutter",
                (false, false) => "",
            };
            let taken = share_ratio.map(|share| format!("{:.2}", 100.0 * share)).or(refused).unwrap_or_default();
            say(format_args!("  {:>16.3}   {outer_radius_mm:>16.3}   {taken}{mark}", trial.width_mm));
        }
    }
    Ok(())
}
