//! The best plan whose proof holds: where a fixture stands in the way of the best one, another direction is taken.

use arcfeed_plan::cutter::{CupMill, ToolPart};
use arcfeed_plan::optimisation::{Problem, ValuedPlan};
use arcfeed_plan::vector::Point;

use crate::proof_cases::{poses, published_tool};
use crate::proof_published::{ROUGHING, ranked};
use crate::published_rotor::blisk;

/// Half of a fixture's edge, mm.
const HALF_MM: f64 = 2.0;
/// Distance by which the other plan stays clear of it, mm.
const CLEAR_MM: f64 = 6.0;

/// Least distance of the tool from a point of the part over sampled poses, mm.
fn distance_mm(valued: &ValuedPlan, tool: &CupMill, point: &Point) -> f64 {
    let at = valued.plan.turn * point;
    let poses = valued.plan.path.steps().iter().flat_map(|step| poses(step, 2.0)).collect::<Vec<_>>();
    let off = |pose: &Point| {
        let (radius_mm, height_mm) = ((at.xy() - pose.xy()).norm(), at.z - pose.z);
        let parts = [ToolPart::Ring, ToolPart::Body, ToolPart::Holder];
        parts.map(|part| tool.distance_of_mm(part, radius_mm, height_mm)).into_iter().fold(f64::INFINITY, f64::min)
    };
    poses.iter().map(off).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_plan_whose_proof_fails_gives_way_to_the_next_one() {
    let (blisk, tool) = (blisk(), published_tool());
    let slot = blisk.slot();
    let problem = || Problem::new(&blisk, &slot, &tool, &ROUGHING).unwrap();
    let ranked = ranked();
    assert!(ranked.windows(2).all(|pair| pair[0].share_ratio >= pair[1].share_ratio) && ranked.len() > 1);
    // A point of the best plan's ring from which another plan stays away.
    let first = &ranked[0].plan;
    let lowest = poses(&first.path.steps()[1], 5.0)[0];
    let middle_mm = (tool.outer_radius_mm + tool.inner_radius_mm) / 2.0;
    let around = (0..72).map(|k| {
        let (sin, cos) = libm::sincos(f64::from(k) * core::f64::consts::TAU / 72.0);
        first.turn.inverse() * Point::new(lowest.x + middle_mm * cos, lowest.y + middle_mm * sin, lowest.z + 10.0)
    });
    let free = |point: &Point| ranked[1..].iter().any(|other| distance_mm(other, &tool, point) > CLEAR_MM);
    let point = around.into_iter().find(free).expect("a point that only the best plan meets");
    let by = nalgebra::Vector3::repeat(HALF_MM);
    let small = [[point - by, point + by]];
    let (valued, proof) = problem().with_fixture(&small).proven(None, |_| true).unwrap();
    let allowance_mm = ROUGHING.allowance_mm;
    println!("{:.2} % and, with a fixture, {:.2} %", 100.0 * ranked[0].share_ratio, 100.0 * valued.share_ratio);
    assert!(proof.holds(allowance_mm, 0.15 * allowance_mm));
    assert!((valued.plan.tool_axis() - first.tool_axis()).norm() > 0.05);
    assert!(valued.share_ratio <= ranked[0].share_ratio);
    // Where no plan is safe, the first one and its collision are returned.
    let large = [[Point::new(-300.0, -300.0, -300.0), Point::new(300.0, 300.0, 300.0)]];
    let (valued, proof) = problem().with_fixture(&large).proven(None, |_| true).unwrap();
    assert!(!proof.holds(allowance_mm, 0.15 * allowance_mm) && valued.share_ratio == ranked[0].share_ratio);
}
