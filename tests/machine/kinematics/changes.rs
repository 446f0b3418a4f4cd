//! Changes of branch: never in the cut, always reported, with a path around it.

use arcfeed_kinematics::branch_change::{BranchChange, Transition};
use arcfeed_kinematics::forward::ToolPose;
use arcfeed_kinematics::machine::{Letter, Machine};
use arcfeed_kinematics::vector::{angle_deg, difference, length};

use crate::kinematics::bench::{SETUP, direction, machine, pose, with_first_range};
use crate::kinematics::oracle;

/// Largest deviation of the tool axis from its arc.
const ALLOWED_DEG: f64 = 0.5;

fn changes(machine: &Machine, poses: &[ToolPose]) -> (Vec<[f64; 2]>, Vec<Transition>, Vec<BranchChange>) {
    let course = machine.select_branches(poses, None).expect("within reach");
    let passages = machine.transitions(poses, &course, ALLOWED_DEG);
    let of = |passage: &Transition| if let Transition::Change(change) = passage { Some(*change) } else { None };
    let changes = passages.iter().filter_map(of).collect();
    (course, passages, changes)
}

fn ring(tilt: f64, to: f64, step: f64) -> Vec<ToolPose> {
    let points = (to / step) as u32;
    (0..=points).map(|point| pose(f64::from(point), direction(tilt, f64::from(point) * step))).collect()
}

#[test]
fn a_range_that_ends_forces_one_change_and_names_its_axis() {
    let mikron = with_first_range(&machine("mikron-ucp710"), Some([-360.0, 360.0]));
    let poses = ring(40.0, 600.0, 2.0);
    let (course, passages, changes) = changes(&mikron, &poses);
    let smooth = passages.iter().filter(|passage| **passage == Transition::Smooth).count();
    println!("600 degrees round, C from -360 to 360: {changes:?}");
    assert_eq!((changes.len(), smooth), (1, passages.len() - 1));
    let change = changes[0];
    // A 40 is out of reach, so C turns back by a whole turn; half way round the tool would lean 80 degrees the other way.
    assert!(((change.to_deg[0] - change.from_deg[0]).abs() - 358.0).abs() < 1e-9);
    assert!(change.departure_deg > 79.0 && change.forced_by.is_some_and(|(letter, _)| letter == Letter::C));
    assert!(course.iter().all(|place| place[0].abs() <= 360.0 + 1e-9));
}

#[test]
fn the_jump_of_the_paper_is_found_where_the_tilt_reaches_its_end() {
    // From 20 degrees on one side over the pole to 60 on the other: A 20 to -60, C still. The other way round C must turn.
    let mikron = machine("mikron-ucp710");
    let line = |from: i32, to: i32| -> Vec<ToolPose> {
        (from..=to).map(|tilt| pose(f64::from(tilt), direction(f64::from(tilt), 25.0))).collect()
    };
    let (_, passages, none) = changes(&mikron, &line(-60, 20));
    assert!(none.is_empty() && passages.iter().all(|passage| *passage == Transition::Smooth));
    let (_, _, forced) = changes(&mikron, &line(-60, 60));
    println!("from 60 over the pole to 60: {forced:?}");
    assert_eq!(forced.len(), 1);
    assert!(((forced[0].to_deg[0] - forced[0].from_deg[0]).abs() - 180.0).abs() < 1e-9);
    assert!(matches!(forced[0].forced_by, Some((Letter::A, point)) if point > 60), "{forced:?}");
}

#[test]
fn a_coarse_move_is_no_change() {
    let mikron = machine("mikron-ucp710");
    let poses = [pose(0.0, direction(40.0, 0.0)), pose(1.0, direction(40.0, 30.0))];
    let (_, passages, changes) = changes(&mikron, &poses);
    assert!(changes.is_empty() && matches!(passages[0], Transition::Coarse { departure_deg } if departure_deg > 0.9));
}

#[test]
fn every_swing_of_random_paths_is_reported() {
    let mut random = fastrand::Rng::with_seed(5);
    let (mut moves, mut reported) = (0, 0);
    for file in crate::kinematics::bench::FILES {
        let machine = with_first_range(&machine(file), Some([-200.0, 200.0]));
        for _ in 0..40 {
            let (mut tilt, mut azimuth, turn) = (random.f64() * 60.0, random.f64() * 360.0, random.f64() * 6.0 - 3.0);
            let poses: Vec<ToolPose> = (0..200)
                .map(|at| {
                    (tilt, azimuth) = (tilt + random.f64() - 0.5, azimuth + turn);
                    pose(f64::from(at), direction(tilt, azimuth))
                })
                .collect();
            let Ok(course) = machine.select_branches(&poses, None) else { continue };
            let passages = machine.transitions(&poses, &course, ALLOWED_DEG);
            for (at, passage) in passages.iter().enumerate() {
                moves += 1;
                let reported_here = *passage != Transition::Smooth;
                reported += u32::from(reported_here);
                // Looked at with matrices at 50 points: the tool axis stays near both ends, or the move is reported.
                let worst = (0..=50)
                    .map(|part| leaning(&machine, [&poses[at], &poses[at + 1]], [course[at], course[at + 1]], part));
                assert!(reported_here || worst.fold(0.0, f64::max) < ALLOWED_DEG + 1e-9);
            }
        }
    }
    println!(
        "{moves} moves of random paths, {reported} reported; no other one leaves its arc by more than {ALLOWED_DEG} degrees"
    );
    assert!(reported > 0);
}

/// Excess of the distances of the tool axis from both ends over the distance of the ends: zero on their arc.
fn leaning(machine: &Machine, poses: [&ToolPose; 2], places: [[f64; 2]; 2], part: i32) -> f64 {
    let at = |axis: usize| places[0][axis] + (places[1][axis] - places[0][axis]) * f64::from(part) / 50.0;
    let axes = arcfeed_kinematics::forward::Axes { linear_mm: [0.0; 3], rotary_deg: [at(0), at(1)] };
    let axis = oracle::forward(machine, &axes, &SETUP).axis;
    let [to_first, to_second] = poses.map(|pose| angle_deg(axis, pose.axis));
    (to_first + to_second - angle_deg(poses[0].axis, poses[1].axis)) / 2.0
}

#[test]
fn the_way_round_leaves_along_the_tool_turns_in_the_clear_and_comes_back() {
    let mikron = with_first_range(&machine("mikron-ucp710"), Some([-360.0, 360.0]));
    let poses = ring(40.0, 600.0, 2.0);
    let (_, _, changes) = changes(&mikron, &poses);
    let change = changes[0];
    let [last, next] = [&poses[change.point - 1], &poses[change.point]];
    let way = mikron.branch_change_moves(&change, [last, next], &SETUP, 50.0);
    let at = |axes| oracle::forward(&mikron, axes, &SETUP);
    for (retracted, pose, place) in [(&way.retract, last, change.from_deg), (&way.above, next, change.to_deg)] {
        let off = difference(at(retracted).tip_mm, pose.tip_mm);
        assert!(length(difference(off, pose.axis.map(|component| 50.0 * component))) < 1e-9);
        assert_eq!(retracted.rotary_deg, place);
    }
    assert_eq!(way.clear.linear_mm, [way.retract.linear_mm[0], way.retract.linear_mm[1], 700.0]);
    assert_eq!((way.reorient.linear_mm, way.reorient.rotary_deg), (way.clear.linear_mm, change.to_deg));
    assert!(length(difference(at(&way.back).tip_mm, next.tip_mm)) < 1e-9);
    assert!(angle_deg(at(&way.back).axis, next.axis) < 1e-9);
}
