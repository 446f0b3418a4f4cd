//! Tournier's appendix: what the post-processor of a Mikron UCP710 gave for published CL points.

use arcfeed_kinematics::branch_selection::{Branch, PathStart};
use arcfeed_kinematics::forward::ToolPose;
use arcfeed_kinematics::singularity::{RepairLimits, RepairOutcome, ToolEnd};
use arcfeed_kinematics::vector::{difference, length, scaled, sum, unit};
use arcfeed_tests::root;

use crate::kinematics::bench::{machine, travels};

/// Half of the last printed digit of an angle.
const ANGLE_DIGIT: f64 = 0.000_5;
/// Half of the last printed digit of i, j and k.
const COMPONENT_DIGIT: f64 = 0.000_000_5;
/// The ball end mill of the tests.
const BALL_MM: f64 = 5.0;

/// Start of each strategy on the machine: strategy 3 begins in the second turn of C, as earlier passes left it, and strategy 4 on the branch with A above 0.
fn start(strategy: u8) -> PathStart {
    match strategy {
        3 => PathStart { rotary_deg: Some([360.0, 0.0]), branch: None },
        4 => PathStart { rotary_deg: None, branch: Some(Branch::Positive) },
        _ => PathStart::default(),
    }
}

struct Row {
    strategy: u8,
    n: u16,
    tip: [f64; 3],
    ijk: [f64; 3],
    a_deg: f64,
    c_deg: f64,
}

fn rows(strategy: u8) -> Vec<Row> {
    let text = std::fs::read_to_string(root().join("tests/cases/tournier-ikt/pairs.csv")).expect("the case");
    let read = |line: &str| {
        let v: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let (tip, ijk) = ([v[2], v[3], v[4]], [v[5], v[6], v[7]]);
        Row { strategy: v[0] as u8, n: v[1] as u16, tip, ijk, a_deg: v[8], c_deg: v[9] }
    };
    let rows: Vec<Row> = text.lines().skip(1).map(read).filter(|row| row.strategy == strategy).collect();
    assert_eq!(rows.len(), 5);
    rows
}

fn poses(rows: &[Row]) -> Vec<ToolPose> {
    rows.iter().map(|row| ToolPose { tip_mm: row.tip, axis: unit(row.ijk).expect("a direction") }).collect()
}

/// Error in A and in C of half a digit of i and j.
fn supported(ijk: [f64; 3]) -> [f64; 2] {
    let radius = libm::hypot(ijk[0], ijk[1]);
    let along = COMPONENT_DIGIT * (ijk[0].abs() + ijk[1].abs()) / radius;
    [along.to_degrees(), (along / radius).to_degrees()]
}

#[test]
fn every_row_is_reproduced_as_far_as_its_printed_digits_go() {
    let mikron = machine("mikron-ucp710");
    let (mut by_k, mut not_by_ij) = (0, Vec::new());
    for strategy in [1, 2, 3, 4] {
        let rows = rows(strategy);
        let course = mikron.select_branches(&poses(&rows), start(strategy)).expect("all within reach");
        for (row, [c_deg, a_deg]) in rows.iter().zip(&course) {
            let [a_digit, c_digit] = supported(row.ijk);
            let is_pole = row.ijk[2] == 1.0;
            // The paper's post-processor took A from k; near 1 a digit of k is worth dk / sin A.
            let of_k = libm::acos(row.ijk[2]).to_degrees();
            let a_off = a_deg - row.a_deg;
            println!(
                "strategy {} N{}: C {:8.3} printed, {c_deg:8.4} found (digits of i, j: {c_digit:.4}); A {:6.3} printed, {a_deg:8.5} \
                 found ({a_digit:.5}), acos k {of_k:.5}",
                row.strategy, row.n, row.c_deg, row.a_deg
            );
            assert!((of_k - row.a_deg.abs()).abs() <= ANGLE_DIGIT, "the printed A is that of the printed k");
            by_k += 1;
            let k_digit = COMPONENT_DIGIT / libm::sin(of_k.to_radians());
            assert!(is_pole || a_off.abs() <= ANGLE_DIGIT + k_digit.to_degrees(), "A within the digits of k");
            if a_off.abs() > ANGLE_DIGIT + if is_pole { 0.0 } else { a_digit } {
                not_by_ij.push((row.strategy, row.n));
            }
            // In the pole C is undefined and held; what is held is that of the row before.
            let c_digit = if is_pole { supported(rows[1].ijk)[1] } else { c_digit };
            assert!((c_deg - row.c_deg).abs() <= ANGLE_DIGIT.max(c_digit) + 1e-9, "C");
        }
    }
    println!(
        "{by_k} of 20 rows: A is acos of the printed k to {ANGLE_DIGIT}; i and j, which are sharper, do not give: {not_by_ij:?}"
    );
    let of_strategy_3 = [2450, 2460, 2480, 2490].map(|n| (3, n));
    let expected = [(1, 2910), (1, 2940), (2, 2920), (2, 2930), (2, 2940)].into_iter().chain(of_strategy_3).collect();
    assert_eq!((by_k, not_by_ij), (20, expected));
}

#[test]
fn only_strategy_2_is_called_incoherent() {
    let mikron = machine("mikron-ucp710");
    let nothing = RepairLimits { error_deg: -1.0, ..RepairLimits::default() };
    for strategy in [1, 2, 3, 4] {
        let mut path = poses(&rows(strategy));
        let course = mikron.select_branches(&path, start(strategy)).expect("within reach");
        let found = mikron.repair(&mut path, &course, ToolEnd::Other, &nothing);
        for interval in &found {
            println!(
                "strategy {strategy}: {:.0} degrees a degree, {:.2} degrees from the pole, {:.2} degrees there and back",
                interval.gain_ratio, interval.from_pole_deg, interval.reversal_deg
            );
        }
        let faults = found.iter().filter(|interval| interval.is_fault()).count();
        assert_eq!(faults, usize::from(strategy == 2), "strategy {strategy}");
    }
}

#[test]
fn a_branch_that_the_start_names_is_taken_or_refused() {
    let mikron = machine("mikron-ucp710");
    let path = poses(&rows(4));
    let on = |branch: Branch| {
        let start = PathStart { rotary_deg: None, branch: Some(branch) };
        mikron.select_branches(&path, start).expect("within reach")
    };
    assert!(on(Branch::Positive).iter().all(|place| place[1] > 0.0));
    let negative = on(Branch::Negative);
    assert!(negative.iter().all(|place| place[1] < 0.0));
    assert!((negative[0][0] + 112.721).abs() < 0.001, "{negative:?}");
    // A ends at 30 degrees: a tilt of 40 exists with A below 0 only.
    let tilted = [ToolPose { tip_mm: [0.0; 3], axis: crate::kinematics::bench::direction(40.0, 90.0) }];
    let steep = |branch: Branch| mikron.select_branches(&tilted, PathStart { rotary_deg: None, branch: Some(branch) });
    assert!(steep(Branch::Negative).is_ok());
    assert!(steep(Branch::Positive).is_err_and(|error| error.to_string().contains("A would have to stand at 40.000")));
}

#[test]
fn the_jump_of_strategy_2_is_found_and_repaired() {
    let mikron = machine("mikron-ucp710");
    let old = poses(&rows(2));
    let before = mikron.select_branches(&old, None).expect("within reach");
    let mut new = old.clone();
    let limits = RepairLimits::default();
    let found = mikron.repair(&mut new, &before, ToolEnd::Ball { radius_mm: BALL_MM }, &limits);
    let after = mikron.select_branches(&new, None).expect("within reach");
    let [[c_before, _], [c_after, _]] = [travels(&before), travels(&after)];
    println!("C before {:?}", before.iter().map(|place| place[0]).collect::<Vec<_>>());
    println!("C after  {:?}", after.iter().map(|place| place[0]).collect::<Vec<_>>());
    println!("C travel {c_before:.3} -> {c_after:.3} deg; {found:?}");
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].before, found[0].after, found[0].outcome), (1, 3, RepairOutcome::Repaired));
    // Travel of the printed column, and the least possible: monotone from the first to the last.
    assert!((c_before - 107.106).abs() < 0.01, "{c_before}");
    let least =
        (before[1][0] - before[0][0]).abs() + (before[3][0] - before[1][0]).abs() + (before[4][0] - before[3][0]).abs();
    assert!((c_after - least).abs() < 1e-9, "{c_after} {least}");
    // The error is the chord on the circle of radius hypot(i, j), computed here from the printed components.
    let radius = libm::hypot(old[2].axis[0], old[2].axis[1]);
    let by = (before[2][0] - after[2][0]).to_radians();
    let error = (2.0 * libm::asin(radius * libm::sin(by / 2.0))).to_degrees();
    println!(
        "orientation error {error:.5} deg; the tip moves {:.5} mm",
        length(difference(old[2].tip_mm, new[2].tip_mm))
    );
    assert!((found[0].error_deg - error).abs() < 1e-9, "{error}");
    for (place, kept) in after.iter().zip(&before) {
        assert!((place[1] - kept[1]).abs() < 1e-9, "A keeps its value");
    }
    for (new, old) in new.iter().zip(&old) {
        let center = |pose: &ToolPose| sum(pose.tip_mm, scaled(pose.axis, BALL_MM));
        assert!(length(difference(center(new), center(old))) < 1e-12, "the ball's centre stays");
        assert!((libm::hypot(new.axis[0], new.axis[1]) - libm::hypot(old.axis[0], old.axis[1])).abs() < 1e-15);
    }
}

#[test]
fn strategy_1_has_nothing_to_repair_although_a_changes_its_sign() {
    let mikron = machine("mikron-ucp710");
    let mut path = poses(&rows(1));
    let course = mikron.select_branches(&path, None).expect("within reach");
    assert!(course[0][1] > 0.0 && course[4][1] < 0.0);
    assert!(mikron.repair(&mut path, &course, ToolEnd::Other, &RepairLimits::default()).is_empty());
    println!("strategy 1: C travel {:.3} deg", travels(&course)[0]);
}

#[test]
fn a_tool_that_is_no_ball_is_left_alone() {
    let mikron = machine("mikron-ucp710");
    let old = poses(&rows(2));
    let course = mikron.select_branches(&old, None).expect("within reach");
    let mut new = old.clone();
    let found = mikron.repair(&mut new, &course, ToolEnd::Other, &RepairLimits::default());
    assert_eq!((found.len(), found[0].outcome), (1, RepairOutcome::Refused));
    assert_eq!(new, old);
    let wide = RepairLimits { error_deg: 0.1, ..RepairLimits::default() };
    assert_eq!(mikron.repair(&mut new, &course, ToolEnd::Other, &wide)[0].outcome, RepairOutcome::Repaired);
    assert_eq!(new[2].tip_mm, old[2].tip_mm);
}
