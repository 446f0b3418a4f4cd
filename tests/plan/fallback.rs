//! The best plan whose proof holds: where a fixture stands in the way of the best one, another direction is taken.

use arcfeed_plan::cup_mill::plan::ValuedPlan;
use arcfeed_plan::cutter::{CupMill, ToolPart};
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::vector::Point;

use crate::proof_cases::{poses, published_tool};
use crate::proof_published::{ROUGHING, ranked};
use crate::published_rotor::blisk;

/// Half of a fixture's edge, mm.
const HALF_MM: f64 = 2.0;
/// Distance by which the other plan stays clear of it, mm.
const CLEAR_MM: f64 = 6.0;

/// Sampled poses of a plan.
fn poses_of(valued: &ValuedPlan) -> Vec<Point> {
    valued.plan.path.steps().iter().flat_map(|step| poses(step, 2.0)).collect()
}

/// Whether the tool stays clear of a point of the part in all these poses of a plan.
fn is_clear(valued: &ValuedPlan, poses: &[Point], tool: &CupMill, point: &Point) -> bool {
    let at = valued.plan.turn * point;
    poses.iter().all(|pose| {
        let (radius_mm, height_mm) = ((at.xy() - pose.xy()).norm(), at.z - pose.z);
        let parts = [ToolPart::Ring, ToolPart::Body, ToolPart::Holder];
        parts.into_iter().all(|part| tool.distance_of_mm(part, radius_mm, height_mm) > CLEAR_MM)
    })
}

#[test]
fn a_plan_whose_proof_fails_gives_way_to_the_next_one() {
    let (blisk, tool) = (blisk(), published_tool());
    let slot = blisk.slot();
    let problem = || Problem::new(&blisk, &slot, &tool, &ROUGHING).unwrap();
    let ranked = ranked();
    assert!(ranked.windows(2).all(|pair| pair[0].share_ratio >= pair[1].share_ratio) && ranked.len() > 1);
    // A point of the best plan's ring, where that is lowest, from which another plan stays away.
    let first = &ranked[0].plan;
    let lowest = poses_of(&ranked[0]).into_iter().min_by(|a, b| a.z.total_cmp(&b.z)).expect("poses");
    let middle_mm = (tool.outer_radius_mm + tool.inner_radius_mm) / 2.0;
    let around = (0..72).map(|k| {
        let (sin, cos) = libm::sincos(f64::from(k) * core::f64::consts::TAU / 72.0);
        first.turn.inverse() * Point::new(lowest.x + middle_mm * cos, lowest.y + middle_mm * sin, lowest.z + 1.0)
    });
    let others: Vec<_> = ranked[1..].iter().map(|other| (other, poses_of(other))).collect();
    let free = |point: &Point| others.iter().any(|(other, poses)| is_clear(other, poses, &tool, point));
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
