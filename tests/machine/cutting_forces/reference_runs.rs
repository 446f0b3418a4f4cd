//! Milling forces: closed forms, runs of an independent program, and figures that are exact.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::cutting_forces::closed_form::{Forces, Milling};
use crate::cutting_forces::milling::InPieces;
use crate::cutting_forces::rows::rows;

const STEPS: usize = 1440;
const PIECES: usize = 60;
const N_MM_PER_N_M: f64 = 1e3;

const HELICAL: Milling = Milling {
    radius_mm: 9.525,
    teeth: 4,
    helix_rad: PI / 6.0,
    depth_mm: 5.08,
    feed_mm_per_tooth: 0.05,
    engaged_rad: [0.0, FRAC_PI_2],
    cutting: [1825.0, 770.0, 735.0],
    edge: [29.7, 55.7, 1.8],
};

const STRAIGHT: Milling = Milling {
    teeth: 2,
    helix_rad: 0.0,
    depth_mm: 1.0,
    feed_mm_per_tooth: 0.1,
    engaged_rad: [0.0, PI],
    cutting: [600.0, 200.0, 0.0],
    edge: [0.0; 3],
    radius_mm: 5.0,
};

/// As they stand in the table.
fn cases() -> [(&'static str, Milling); 5] {
    [
        ("F1", Milling { teeth: 1, ..HELICAL }),
        ("F2", HELICAL),
        ("F3", Milling { engaged_rad: [FRAC_PI_2, PI], ..HELICAL }),
        ("F4", Milling { engaged_rad: [0.0, PI], ..HELICAL }),
        ("F5", STRAIGHT),
    ]
}

/// Forces of the library, in the axes of the closed form: the library's z points to the holder, the other z along the
/// axial force.
fn in_pieces(run: &InPieces, angle_rad: f64) -> Forces {
    let loads = run.loads(angle_rad);
    [loads.force_n.x, loads.force_n.y, -loads.force_n.z, loads.torque_n_m * N_MM_PER_N_M]
}

/// Equal steps.
fn turn(steps: usize) -> impl Iterator<Item = f64> {
    (0..steps).map(move |step| TAU * step as f64 / steps as f64)
}

fn off(a: &Forces, b: &Forces) -> f64 {
    (0..4).map(|i| (a[i] - b[i]).abs() / if i == 3 { 10.0 } else { 1.0 }).fold(0.0, f64::max)
}

#[test]
fn forces_are_the_closed_form_at_every_angle_and_in_the_mean() {
    for (name, milling) in cases() {
        let run = InPieces::new(milling, PIECES);
        let (mut worst_n, mut mean) = (0.0_f64, [0.0; 4]);
        for angle_rad in turn(STEPS) {
            let found = in_pieces(&run, angle_rad);
            worst_n = worst_n.max(off(&found, &milling.forces(angle_rad)));
            mean = std::array::from_fn(|i| mean[i] + found[i] / STEPS as f64);
        }
        let mean_off_n = off(&mean, &milling.mean());
        println!("{name}: {worst_n:.1e} N at worst, {mean_off_n:.1e} N in the mean");
        assert!(worst_n < 0.05 && mean_off_n < 0.01, "{name}: {worst_n} {mean_off_n}");
    }
}

#[test]
fn the_error_of_pieces_is_of_second_order() {
    let worst_n = |pieces| {
        let run = InPieces::new(HELICAL, pieces);
        turn(STEPS).map(|at| off(&in_pieces(&run, at), &HELICAL.forces(at))).fold(0.0, f64::max)
    };
    let [coarse_n, fine_n] = [10, 40].map(worst_n);
    let order = libm::log2(coarse_n / fine_n) / 2.0;
    println!("{coarse_n:.2e} N in 10 pieces, {fine_n:.2e} N in 40: order {order:.2}");
    assert!(order > 1.7, "{order}");
}

/// Angles at which tips and tops of edges enter and leave: there forces have their kinks.
fn kinks(milling: &Milling) -> impl Iterator<Item = f64> {
    let lag = libm::tan(milling.helix_rad) / milling.radius_mm * milling.depth_mm;
    let ends = milling.engaged_rad;
    ends.into_iter().flat_map(move |end| [end, end + lag])
}

#[test]
fn an_independent_program_finds_the_same() {
    let rows = rows(include_str!("force_reference_runs.csv"));
    assert_eq!(rows.len(), cases().len());
    for ((name, milling), row) in cases().iter().zip(&rows) {
        assert!(row.text("case").starts_with(name));
        let run = InPieces::new(*milling, PIECES);
        let fine: Vec<Forces> = turn(STEPS).chain(kinks(milling)).map(|angle_rad| in_pieces(&run, angle_rad)).collect();
        let means = milling.mean();
        for (i, axis) in ["Fx", "Fy", "Fz"].into_iter().enumerate() {
            let of_axis = |forces: &Forces| forces[i];
            assert_extreme(name, row.number(&format!("{axis}_max")), &fine, of_axis);
            assert_extreme(name, -row.number(&format!("{axis}_min")), &fine, |forces| -of_axis(forces));
            let mean_off_n = row.number(&format!("{axis}_mean_closed")) - means[i];
            assert!(mean_off_n.abs() < 1.1e-4, "{name}: mean {axis} is off by {mean_off_n}");
        }
        assert_extreme(name, row.number("Fxy_max"), &fine, |forces| libm::hypot(forces[0], forces[1]));
        assert_extreme(name, row.number("T_max_Nm"), &fine, |forces| forces[3] / N_MM_PER_N_M);
        assert!((row.number("T_mean_Nm") - means[3] / N_MM_PER_N_M).abs() < 1e-4);
    }
}

/// The largest value in a table is that of its own steps: not above the true one, and not further below it than the value
/// changes within a quarter of a degree.
fn assert_extreme(name: &str, printed: f64, fine: &[Forces], value: impl Fn(&Forces) -> f64) {
    let values: Vec<f64> = fine.iter().map(value).collect();
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let step = values[..STEPS].windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    let tenth = step * STEPS as f64 / 3600.0;
    let above = printed - largest;
    println!("{name}: {largest:.4}, there {printed:.4}: {above:+.4}, changes by {tenth:.2} in 0.1 deg");
    assert!(above < 2e-3 && above > -tenth.max(2e-3), "{name}: {largest} {printed}");
}

#[test]
fn straight_edges_give_exact_extremes() {
    // Fx = -fz ap (Kt sin a cos a + Kr sin^2 a) = -(10 + 10 sqrt(10) sin(2 a - b)), Fxy at its greatest in the middle.
    let run = InPieces::new(STRAIGHT, 1);
    let fx_n = |angle_rad: f64| run.loads(angle_rad).force_n.x;
    let swing_rad = libm::atan2(200.0, 600.0);
    let root = libm::sqrt(1e3);
    assert!((fx_n((FRAC_PI_2 + swing_rad) / 2.0) + 10.0 + root).abs() < 1e-12);
    assert!((fx_n((3.0 * FRAC_PI_2 + swing_rad) / 2.0) + 10.0 - root).abs() < 1e-12);
    assert!((run.loads(FRAC_PI_2).bending_n() - 20.0 * libm::sqrt(10.0)).abs() < 1e-12);
    assert!((run.loads(FRAC_PI_2).torque_n_m - 0.3).abs() < 1e-12);
}
