//! Incoherent movement on paths made for it.

use arcfeed_kinematics::forward::ToolPose;
use arcfeed_kinematics::singularity::{RepairLimits, RepairOutcome, ToolEnd};
use arcfeed_kinematics::vector::{angle_deg, difference, length, unit};

use crate::kinematics::bench::{machine, pose, travels};

const BALL: ToolEnd = ToolEnd::Ball { radius_mm: 5.0 };

/// Directions on a straight line in the (i, j) plane that passes the pole at a distance, in degrees, to 6 decimals.
fn beside_the_pole(beside_deg: f64, step_deg: f64) -> Vec<ToolPose> {
    let steps = (3.0 / step_deg) as i32;
    let at = |step: i32| {
        let (i, j) = (beside_deg.to_radians(), (f64::from(step) * step_deg).to_radians());
        pose(f64::from(step), unit([i, j, libm::sqrt(1.0 - i * i - j * j)]).expect("a direction"))
    };
    (-steps..=steps).map(at).collect()
}

#[test]
fn a_path_close_by_the_pole_goes_through_it_and_the_error_is_the_distance() {
    let mikron = machine("mikron-ucp710");
    for (beside, step) in [(0.06, 0.3), (0.06, 0.05), (0.02, 0.1), (0.3, 0.1)] {
        let old = beside_the_pole(beside, step);
        let mut new = old.clone();
        let before = mikron.select_branches(&old, None).expect("within reach");
        let found = mikron.repair(&mut new, &before, BALL, &RepairLimits::default());
        let after = mikron.select_branches(&new, None).expect("within reach");
        let [[c_before, _], [c_after, _]] = [travels(&before), travels(&after)];
        println!("{beside} deg beside the pole, every {step} deg: C travel {c_before:.2} -> {c_after:.2}, {found:?}");
        assert!(found.len() == 1 && found[0].outcome == RepairOutcome::Repaired);
        assert!(c_before > 150.0 && c_after < 0.25 * c_before);
        // On its circle no direction moves by more than a quarter turn about the pole.
        let farthest = new.iter().zip(&old).map(|(new, old)| angle_deg(new.axis, old.axis)).fold(0.0, f64::max);
        assert!((farthest - found[0].error_deg).abs() < 1e-12 && farthest < beside * 1.5);
        let tilts = new.iter().zip(&old).map(|(new, old)| (new.axis[2] - old.axis[2]).abs()).fold(0.0, f64::max);
        assert!(tilts < 1e-15, "k stays");
        // Against the turn of the tool that the path asked for.
        let race = after.windows(2).zip(old.windows(2));
        let race = race.map(|(at, of)| (at[1][0] - at[0][0]).abs() / angle_deg(of[0].axis, of[1].axis));
        assert!(race.fold(0.0, f64::max) < RepairLimits::default().gain_ratio, "C no longer races");
    }
}

#[test]
fn poles_of_other_machines_are_as_good() {
    for file in ["ferrari-rtttr", "mitsui-seiki-hu80a-5x"] {
        let machine = machine(file);
        let about_y = file.starts_with("mitsui");
        let lay = |pose: ToolPose| {
            let [x, y, z] = pose.axis;
            ToolPose { axis: if about_y { [x, z, y] } else { [x, y, z] }, ..pose }
        };
        let old: Vec<ToolPose> = beside_the_pole(0.06, 0.1).into_iter().map(lay).collect();
        let mut new = old.clone();
        let before = machine.select_branches(&old, None).expect("within reach");
        let found = machine.repair(&mut new, &before, BALL, &RepairLimits::default());
        let after = machine.select_branches(&new, None).expect("within reach");
        let [[first_before, second_before], [first_after, second_after]] = [travels(&before), travels(&after)];
        println!("{file}: {first_before:.2} -> {first_after:.2}, second axis {second_before:.3} -> {second_after:.3}");
        assert!(found.len() == 1 && found[0].outcome == RepairOutcome::Repaired);
        assert!(first_before > 150.0 && first_after < 25.0);
    }
}

#[test]
fn points_far_from_the_pole_or_slow_turns_are_not_repaired() {
    let mikron = machine("mikron-ucp710");
    for beside in [8.0, 20.0] {
        let mut path = beside_the_pole(beside, 0.25);
        let course = mikron.select_branches(&path, None).expect("within reach");
        assert!(mikron.repair(&mut path, &course, BALL, &RepairLimits::default()).is_empty());
    }
}

#[test]
fn a_stretch_at_the_end_of_the_path_has_no_room() {
    let mikron = machine("mikron-ucp710");
    let whole = beside_the_pole(0.06, 0.3);
    let mut half = whole[..12].to_vec();
    let (old, course) = (half.clone(), mikron.select_branches(&half, None).expect("within reach"));
    let found = mikron.repair(&mut half, &course, BALL, &RepairLimits::default());
    assert_eq!(found.last().map(|stretch| stretch.outcome), Some(RepairOutcome::NoRoom));
    let moved = half.iter().zip(&old).map(|(new, old)| length(difference(new.axis, old.axis))).fold(0.0, f64::max);
    assert_eq!(moved, 0.0);
}

#[test]
fn two_passes_of_one_path_are_two_stretches() {
    let mikron = machine("mikron-ucp710");
    let there = beside_the_pole(0.06, 0.1);
    let back = there.iter().rev().skip(1).copied();
    let old: Vec<ToolPose> = there.iter().copied().chain(back).collect();
    let mut new = old.clone();
    let before = mikron.select_branches(&old, None).expect("within reach");
    let found = mikron.repair(&mut new, &before, BALL, &RepairLimits::default());
    let after = mikron.select_branches(&new, None).expect("within reach");
    println!("there and back beside the pole: C travel {:.2} -> {:.2}", travels(&before)[0], travels(&after)[0]);
    assert!(found.len() == 2 && found.iter().all(|stretch| stretch.outcome == RepairOutcome::Repaired));
    assert!(found[0].after <= found[1].before && travels(&after)[0] < 50.0);
}
