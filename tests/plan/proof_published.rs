//! The proof of the plan for the 19-blade rotor with the published tool.

use std::sync::OnceLock;

use arcfeed_plan::cup_mill::plan::ValuedPlan;
use arcfeed_plan::cup_mill::plan::{AxisChoice, Roughing, SlotPlan, plan};
use arcfeed_plan::cutter::{CupMill, ToolPart};
use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::proof::clearance::{Clearance, Obstacle};
use arcfeed_plan::proof::removal::RemovedVolumes;
use arcfeed_plan::proof::verdict::{Proof, ProofCase, ProofResolution, prove};
use arcfeed_plan::vector::Point;

use crate::proof_cases::published_tool;
use crate::published_rotor;

pub const ALLOWANCE_MM: f64 = 0.889;

pub const ROUGHING: Roughing = Roughing {
    allowance_mm: ALLOWANCE_MM,
    axial_depth_max_mm: 2.54,
    interior_contact: 0.1,
    clearance_mm: 5.0,
    axis: AxisChoice::Blade,
};

/// Plans of the published tool by rank, searched once for all tests.
pub fn ranked() -> &'static [ValuedPlan] {
    static RANKED: OnceLock<Vec<ValuedPlan>> = OnceLock::new();
    RANKED.get_or_init(|| {
        let (blisk, tool) = (published_rotor::blisk(), published_tool());
        Problem::new(&blisk, &blisk.slot(), &tool, &ROUGHING).unwrap().ranked(|_| true).unwrap()
    })
}

fn proof(blisk: &Blisk, tool: &CupMill, plan: &SlotPlan) -> Proof {
    let fixture = [[Point::new(-40.0, -40.0, -80.0), Point::new(40.0, 40.0, -15.0)]];
    let case = ProofCase {
        blisk,
        tool,
        path: &plan.path,
        to_slot: plan.turn,
        allowance_mm: ALLOWANCE_MM,
        fixture: &fixture,
        earlier: &[],
    };
    prove(&case, &ProofResolution::default()).expect("blades above the hub")
}

#[test]
fn the_plan_of_the_published_tool_touches_no_finished_surface() {
    let (blisk, tool) = (published_rotor::blisk(), published_tool());
    let plan = plan(&blisk, &blisk.slot(), &tool, &ROUGHING).expect("a plan");
    let proof = proof(&blisk, &tool, &plan);
    for found in &proof.clearances {
        let Clearance { part, obstacle, bounds_mm: [low, high], pieces, .. } = found;
        println!("{part:?} {obstacle:?}: {low:.4} .. {high:.4} mm, {pieces} pieces");
    }
    assert_eq!((proof.open().count(), proof.clearances.len()), (0, 11));
    let ring = |obstacle| proof.clearance(ToolPart::Ring, obstacle).expect("a ring").beyond_mm(ALLOWANCE_MM);
    println!("beyond the allowance: blades {:.4?}, hub {:.4?} mm", ring(Obstacle::Blades), ring(Obstacle::Hub));
    // The chord error, the gap, and the planner's own tolerance.
    for obstacle in [Obstacle::Blades, Obstacle::Hub] {
        assert!(ring(obstacle)[0] > -0.0125, "{obstacle:?}");
    }
    assert!((4.9..5.1).contains(&proof.indexing_mm), "{}", proof.indexing_mm);
    let pieces: usize = proof.clearances.iter().map(|found| found.pieces).sum();
    println!("{pieces} pieces for {} steps and {} blades", plan.path.steps().len(), blisk.blades);
    assert!(pieces < 200_000);
}

#[test]
fn the_published_tool_takes_most_of_the_slot() {
    let (blisk, tool) = (published_rotor::blisk(), published_tool());
    let plan = plan(&blisk, &blisk.slot(), &tool, &ROUGHING).expect("a plan");
    let proof = proof(&blisk, &tool, &plan);
    for (name, map) in [("pressure", &proof.left.pressure), ("suction", &proof.left.suction), ("hub", &proof.left.hub)]
    {
        let [least, most] = map.range_mm();
        println!("{name}: {least:.3} to {most:.3} mm left beyond the allowance, {:.3} in the mean", map.mean_mm());
    }
    let RemovedVolumes { by_level_mm3, error_mm3, slot_mm3, slot_by_level_mm3 } = &proof.removed;
    for (level, (all_mm3, slot_mm3)) in by_level_mm3.iter().zip(slot_by_level_mm3).enumerate() {
        println!("level {}: {all_mm3:.0} mm3, {slot_mm3:.0} of them in the slot", level + 1);
        assert!(slot_mm3 < all_mm3);
    }
    println!("{:.0} +- {error_mm3:.0} mm3 in {} levels", proof.removed.total_mm3(), by_level_mm3.len());
    println!("{:.1} % of the slot's {slot_mm3:.0} mm3", 100.0 * proof.removed.share_ratio());
    assert!(*error_mm3 < 0.005 * proof.removed.total_mm3());
    assert!((0.6..0.9).contains(&proof.removed.share_ratio()));
    // The ring comes up to both sides somewhere.
    for map in [&proof.left.pressure, &proof.left.suction] {
        assert!((-0.01..0.05).contains(&map.range_mm()[0]));
    }
}
