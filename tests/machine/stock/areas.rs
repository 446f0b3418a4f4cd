//! Areas that discs and rings sweep on lines and arcs, against closed forms made elsewhere, and how fast the error falls
//! with the step. An independent program of the same model kept, for a slot of R 5 mm and 40 mm, 0.30 h/R of the area where
//! rays stand on end and 0.10 (h/R)^1.5 where they lie in the plane. The first error grows with the length of the
//! boundary, the second arises where rays touch a circle, as h^1.5 R^0.5; so for other shapes these bounds are 0.258 h
//! times the boundary and 1.91 h^1.5 R^0.5 a circle.

use std::f64::consts::PI;

use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::tool::Tool;
use fastrand::Rng;

use crate::stock::figures::{area_mm2, order, published, rms, sheet, turn, upright};

const MM_PER_IN: f64 = 25.4;

/// Swept area: its circles, the length of its boundary, the step between rays.
struct Shape<'a> {
    radii_mm: &'a [f64],
    boundary_mm: f64,
    step_mm: f64,
}

/// Checks that areas by rays along x, y and z are within the bounds.
#[track_caller]
fn assert_close(what: &str, areas_mm2: [f64; 3], exact_mm2: f64, shape: &Shape<'_>) {
    let off = areas_mm2.map(|area_mm2| area_mm2 - exact_mm2);
    let [x, y, z] = off.map(|off| off / exact_mm2);
    println!("{what}: {exact_mm2:.4} mm2, off by {x:+.1e} (x) {y:+.1e} (y) {z:+.1e} (z)");
    let lying = 1.91 * libm::pow(shape.step_mm, 1.5) * shape.radii_mm.iter().map(|r| libm::sqrt(*r)).sum::<f64>();
    let standing = 0.258 * shape.step_mm * shape.boundary_mm;
    assert!(off[0].abs().max(off[1].abs()) <= lying && off[2].abs() <= standing, "{what}: {off:?} {lying} {standing}");
}

fn straight(from: Pose, to: Pose) -> Move {
    Move::Straight { from, to }
}

#[test]
fn the_error_of_a_slot_falls_with_the_step_as_it_must() {
    let exact_mm2 = published("same, full swept (stadium)");
    let tool = Tool::cylinder(5.0, 100.0).unwrap();
    let mut rng = Rng::with_seed(5);
    println!("angle  h/R      rms z     max z     rms lying max lying");
    for (angle_deg, orders_min) in [(0.0_f64, [1.1, 1.2]), (17.0, [1.1, 1.2]), (45.0, [0.6, 1.2])] {
        let (sin, cos) = libm::sincos(angle_deg.to_radians());
        let (mut standing, mut lying) = (Vec::new(), Vec::new());
        for step_mm in [1.0, 0.5, 0.25, 0.125, 0.0625] {
            let (mut z, mut xy) = (Vec::new(), Vec::new());
            for _ in 0..8 {
                let mut sheet = sheet([-8.0, -8.0], [48.0, 40.0], step_mm);
                let from = upright(rng.f64() * step_mm, rng.f64() * step_mm);
                let to = upright(from.tip_mm[0] + 40.0 * cos, from.tip_mm[1] + 40.0 * sin);
                let areas = area_mm2(&mut sheet, &tool, &straight(from, to).sweeps(&tool, 1e-3).unwrap());
                let [x, y, upward] = areas.map(|area_mm2| (area_mm2 / exact_mm2 - 1.0).abs());
                let ratio = step_mm / 5.0;
                assert!(upward <= 0.30 * ratio && x.max(y) <= 0.10 * libm::pow(ratio, 1.5), "{x} {y} {upward}");
                z.push(upward);
                xy.extend([x, y]);
            }
            let max = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
            let (h, rms_z, rms_xy) = (step_mm / 5.0, rms(&z), rms(&xy));
            println!("{angle_deg:5}  {h:.4}   {rms_z:.2e}  {:.2e}  {rms_xy:.2e}  {:.2e}", max(&z), max(&xy));
            standing.push(rms_z);
            lying.push(rms_xy);
        }
        let orders = [order(&standing), order(&lying)];
        println!("{angle_deg:5}  order    {:.2}                {:.2}", orders[0], orders[1]);
        assert!(orders[0] >= orders_min[0] && orders[1] >= orders_min[1], "{angle_deg}: {orders:?}");
    }
}

#[test]
fn side_milling_takes_depth_times_length() {
    let tool = Tool::cylinder(5.0, 100.0).unwrap();
    for (depth_mm, name) in [(1.0, "1.0"), (2.5, "2.5"), (5.0, "5.0"), (7.5, "7.5")] {
        let exact_mm2 = published(&format!("side milling ae={name}, steady per L=40"));
        // Depth and length are whole steps: no face along the rays is off, and the errors at both ends cancel.
        let mut sheet = sheet([-10.0, 5.0 - depth_mm], [55.0, 15.0], 0.1);
        let (from, to) = (upright(0.013, 0.0), upright(40.013, 0.0));
        area_mm2(&mut sheet, &tool, &straight(from, from).sweeps(&tool, 1e-3).unwrap());
        let areas = area_mm2(&mut sheet, &tool, &straight(from, to).sweeps(&tool, 1e-3).unwrap());
        let shape = Shape { radii_mm: &[5.0], boundary_mm: 80.0 + 10.0 * PI, step_mm: 0.1 };
        assert_close(&format!("ae {depth_mm}"), areas, exact_mm2, &shape);
    }
}

#[test]
fn an_arc_sweeps_as_pappus_says_and_less_about_a_pivot_inside_the_tool() {
    let tool = Tool::cylinder(5.0, 100.0).unwrap();
    for (radius_mm, check) in [
        (20.0, "flat endmill R5 full slot along arc rho=20, 60deg, ADDED area"),
        (3.0, "flat endmill R5 arc rho=3 (<R, pivot inside disc), 60deg, ADDED"),
    ] {
        let exact_mm2 = published(check);
        let mut sheet = sheet([-12.0, -12.0], [30.0, 30.0], 0.05);
        let from = upright(radius_mm + 0.0123, 0.0321);
        area_mm2(&mut sheet, &tool, &straight(from, from).sweeps(&tool, 1e-3).unwrap());
        let arc = turn(from, [0.0123, 0.0321], 60.0);
        let areas = area_mm2(&mut sheet, &tool, &arc.sweeps(&tool, 1e-4).unwrap());
        let shape = Shape { radii_mm: &[5.0], boundary_mm: (10.0 + 2.0 / 3.0 * radius_mm) * PI, step_mm: 0.05 };
        assert_close(check, areas, exact_mm2, &shape);
    }
}

/// The cup mill of the published job about a pivot on its inner or outer circle, in stock without end or up to a line.
/// The line is turned to lie along y, the pivot is the origin.
fn cup(line: &str) -> Option<()> {
    let check = line.strip_prefix("cup ")?;
    let (before, _) = check.split_once("ADDED area")?;
    let number = |name: &str, end: char| -> Option<f64> {
        before.split_once(name)?.1.split([end, ' ']).next()?.trim_end_matches(':').parse().ok()
    };
    let radii_mm = [5.06205, 4.43706].map(|radius_in| radius_in * MM_PER_IN);
    let pivot_mm = if before.starts_with("interior") { radii_mm[1] } else { radii_mm[0] };
    let (line_deg, line_mm) = (number("n@", 'd').unwrap_or(0.0), number("c=", ' ').unwrap_or(-10.3) * MM_PER_IN);
    let (sin, cos) = libm::sincos(-line_deg.to_radians());
    let tool = Tool::ring(radii_mm, 0.0, 100.0, 1e-3).ok()?;
    let mut sheet = sheet([line_mm, -262.0], [262.0, 262.0], 1.0);
    let from = upright(pivot_mm * cos, pivot_mm * sin);
    area_mm2(&mut sheet, &tool, &straight(from, from).sweeps(&tool, 1e-3).ok()?);
    let arc = turn(from, [0.0, 0.0], number("phi=", ' ')?);
    let areas = area_mm2(&mut sheet, &tool, &arc.sweeps(&tool, 1e-3).ok()?);
    let exact_mm2 = published(&format!("cup {before}ADDED area")) * MM_PER_IN * MM_PER_IN;
    let shape = Shape { radii_mm: &radii_mm, boundary_mm: 2.0 * PI * (radii_mm[0] + radii_mm[1]), step_mm: 1.0 };
    assert_close(before, areas, exact_mm2, &shape);
    Some(())
}

#[test]
fn the_cup_mill_sweeps_what_the_closed_forms_say() {
    let lines = include_str!("mrr_checks.csv").lines();
    assert_eq!(lines.filter_map(cup).count(), 28);
}
