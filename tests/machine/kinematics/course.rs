//! The choice over a whole path against every possible choice, on short paths.

use arcfeed_kinematics::forward::ToolPose;
use arcfeed_kinematics::vector::Vector;
use arcfeed_tests::of_full_set;

use crate::kinematics::bench::{direction, machine, pose, travels, with_first_range};

/// Both solutions of the A/C table as Tournier's table 1 prints them, A from -120 to 30, C with all its turns.
fn printed_solutions([i, j, k]: Vector, c_range: [f64; 2]) -> Vec<[f64; 2]> {
    let up = libm::acos(k).to_degrees();
    let quotient = -libm::atan(i / j).to_degrees();
    let [c_1, c_2] = if j < 0.0 { [quotient, quotient + 180.0] } else { [quotient + 180.0, quotient] };
    let mut all = Vec::new();
    for (a, c) in [(up, c_1), (-up, c_2)] {
        let turns = (-6..=6).map(|turn| [c + 360.0 * f64::from(turn), a]);
        all.extend(turns.filter(|[c, a]| (c_range[0]..=c_range[1]).contains(c) && (-120.0..=30.0).contains(a)));
    }
    all
}

/// The least travel of all ways through all solutions.
fn least_travel(layers: &[Vec<[f64; 2]>]) -> Option<f64> {
    fn onward(layers: &[Vec<[f64; 2]>], at: [f64; 2]) -> Option<f64> {
        let Some((next, rest)) = layers.split_first() else { return Some(0.0) };
        let ways =
            next.iter().filter_map(|to| Some((to[0] - at[0]).abs() + (to[1] - at[1]).abs() + onward(rest, *to)?));
        ways.min_by(f64::total_cmp)
    }
    let (first, rest) = layers.split_first()?;
    first.iter().filter_map(|at| onward(rest, *at)).min_by(f64::total_cmp)
}

#[test]
fn no_other_choice_of_branches_and_turns_travels_less() {
    let mikron = machine("mikron-ucp710");
    let mut random = fastrand::Rng::with_seed(11);
    let (paths, mut reached, mut worst) = (of_full_set(20_000, 400), 0, 0.0_f64);
    for _ in 0..paths {
        let half = 120.0 + random.f64() * 280.0;
        let (limited, c_range) = (with_first_range(&mikron, Some([-half, half])), [-half, half]);
        let mut azimuth = random.f64() * 360.0;
        let mut axis = || {
            azimuth += random.f64() * 200.0 - 60.0;
            direction(0.5 + random.f64() * if random.bool() { 28.0 } else { 110.0 }, azimuth)
        };
        let axes: Vec<Vector> = (0..6).map(|_| axis()).collect();
        let layers: Vec<Vec<[f64; 2]>> = axes.iter().map(|axis| printed_solutions(*axis, c_range)).collect();
        let poses: Vec<ToolPose> = axes.iter().map(|axis| pose(0.0, *axis)).collect();
        match (limited.select_branches(&poses, None), least_travel(&layers)) {
            (Ok(course), Some(least)) => {
                worst = worst.max((travels(&course).iter().sum::<f64>() - least).abs());
                reached += 1;
            }
            (Err(_), None) => {}
            (ours, brute) => panic!("{axes:?}: {ours:?}, of all choices {brute:?}"),
        }
    }
    println!(
        "{paths} paths of 6 points, {reached} within reach: least travel of all choices missed by {worst:.1e} deg at most"
    );
    assert!(reached > paths / 4 && worst < 1e-6);
}

#[test]
fn an_axis_without_end_goes_on_and_on() {
    let mikron = machine("mikron-ucp710");
    let poses: Vec<ToolPose> = (0..=400).map(|step| pose(0.0, direction(50.0, f64::from(step) * 3.0))).collect();
    let course = mikron.select_branches(&poses, None).expect("within reach");
    let [c, a] = travels(&course);
    println!("1200 degrees round: C travels {c:.6}, A {a:.1e}, C ends at {:.3}", course[400][0]);
    assert!((c - 1_200.0).abs() < 1e-9 && a < 1e-9);
    assert!(((course[400][0] - course[0][0]).abs() - 1_200.0).abs() < 1e-9, "unwrapped");
}

#[test]
fn in_a_pole_the_first_axis_stays_where_it_was() {
    let mikron = machine("mikron-ucp710");
    let tilts = [-3.0, -2.0, -1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0];
    let poses: Vec<ToolPose> = tilts.iter().map(|tilt| pose(0.0, direction(*tilt, 30.0))).collect();
    let course = mikron.select_branches(&poses, None).expect("within reach");
    let [c, a] = travels(&course);
    assert!(c < 1e-9 && (a - 6.0).abs() < 1e-9, "{course:?}");
    // A path that begins there begins where it will need C.
    let later = mikron.select_branches(&poses[4..], None).expect("within reach");
    assert!(travels(&later)[0] < 1e-9, "{later:?}");
    // From a given position, the axis holds it until it must turn.
    let held = mikron.select_branches(&poses[4..], Some([777.0, 0.0])).expect("within reach");
    assert_eq!(held[0][0], 777.0);
}

#[test]
fn unreachable_directions_are_reported_with_their_point() {
    let mikron = machine("mikron-ucp710");
    let poses = [10.0, 100.0, 125.0, 90.0].map(|tilt| pose(0.0, direction(tilt, 12.0)));
    let refused = mikron.select_branches(&poses, None).expect_err("beyond A -120");
    println!("{refused}");
    assert_eq!(refused.point, 2);
    assert!(format!("{refused}").starts_with("point 3: A would have to stand at"));
}
