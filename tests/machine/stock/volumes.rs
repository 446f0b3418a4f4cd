//! Volumes in space, against closed forms.
//!
//! A convex body moved straight by v sweeps its own volume and |v| times its shadow along v; a shadow of a cylinder of radius
//! R and height H at the angle b to its axis is pi R^2 |cos b| + 2 R H sin b.

use std::f64::consts::PI;

use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::solid::Block;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;

use crate::stock::figures::{MEMORY_MAX, UP, order, rms};

/// Errors relative to the exact volume, of each grid, at each step.
fn errors(tool: &Tool, moved: &Move, exact_mm3: f64, steps_mm: &[f64]) -> Vec<[f64; 3]> {
    let block = Block { lowest_mm: [-14.03, -14.07, -14.01], highest_mm: [14.0, 14.0, 14.0] };
    let at = |step_mm: &f64| {
        let mut stock = Stock::new(&block, *step_mm, MEMORY_MAX).unwrap();
        let sweeps = moved.sweeps(tool, step_mm / 200.0).unwrap();
        let off = stock.cut(tool, &sweeps).unwrap().by_axis.map(|volume_mm3| volume_mm3 / exact_mm3 - 1.0);
        println!("  step {step_mm:5} mm: {:+.1e} {:+.1e} {:+.1e}", off[0], off[1], off[2]);
        off
    };
    steps_mm.iter().map(at).collect()
}

/// The errors fall from step to step as `order_min` says, and the last is below `last_max`.
fn assert_converges(what: &str, errors: &[[f64; 3]], order_min: f64, last_max: f64) {
    let all: Vec<f64> = errors.iter().map(|off| rms(off)).collect();
    println!("{what}: order {:.2}", order(&all));
    assert!(order(&all) >= order_min, "{what}: {all:?}");
    assert!(all.last().is_some_and(|last| *last <= last_max), "{what}: {all:?}");
}

const STEPS_MM: [f64; 4] = [0.8, 0.4, 0.2, 0.1];

#[test]
fn a_tilted_cylinder_on_any_line_sweeps_itself_and_its_shadow() {
    let (radius_mm, height_mm) = (3.0, 7.0);
    let tool = Tool::cylinder(radius_mm, height_mm).unwrap();
    let axis = [0.36, 0.48, 0.8];
    for way in [[6.0, -5.0, 1.0], [2.0, 3.0, -6.0], [0.0, 0.0, 4.0]] {
        let from = Pose { tip_mm: [-4.0, -1.0, -2.0], axis };
        let to = Pose { tip_mm: [0, 1, 2].map(|i| from.tip_mm[i] + way[i]), axis };
        let length_mm = libm::sqrt(way.iter().map(|part| part * part).sum());
        let cos = (0..3).map(|i| way[i] * axis[i]).sum::<f64>() / length_mm;
        let shadow_mm2 =
            PI * radius_mm * radius_mm * cos.abs() + 2.0 * radius_mm * height_mm * libm::sqrt(1.0 - cos * cos);
        let exact_mm3 = PI * radius_mm * radius_mm * height_mm + length_mm * shadow_mm2;
        let off = errors(&tool, &Move::Straight { from, to }, exact_mm3, &STEPS_MM);
        assert_converges(&format!("cylinder along {way:?}"), &off, 1.3, 4e-4);
    }
}

#[test]
fn a_ball_end_mill_sweeps_itself_and_its_outline() {
    let tool = Tool::ball(4.0, 9.0, 1e-5).unwrap();
    let from = Pose { tip_mm: [-5.0, -3.0, -3.0], axis: UP };
    let to = Pose { tip_mm: [4.0, 4.0, -3.0], axis: UP };
    let own_mm3 = PI * (2.0 / 3.0 * 64.0 + 16.0 * 5.0);
    let exact_mm3 = own_mm3 + libm::hypot(9.0, 7.0) * (8.0 * 5.0 + PI * 8.0);
    // The upper end is perpendicular to z, see below.
    let off = errors(&tool, &Move::Straight { from, to }, exact_mm3, &STEPS_MM[..3]);
    assert_converges("ball", &off, 1.0, 1e-3);
}

#[test]
fn a_ring_leaves_the_lens_that_its_hole_never_leaves() {
    let (outer_mm, inner_mm, height_mm, way_mm) = (8.0, 6.0, 5.0, 6.5);
    let tool = Tool::ring([outer_mm, inner_mm], 0.0, height_mm, 1e-3).unwrap();
    let from = Pose { tip_mm: [-3.0, -0.3, -2.0], axis: UP };
    let to = Pose { tip_mm: [way_mm - 3.0, -0.3, -2.0], axis: UP };
    let lens_mm2 = 2.0 * inner_mm * inner_mm * libm::acos(way_mm / (2.0 * inner_mm))
        - way_mm / 2.0 * libm::sqrt(4.0 * inner_mm * inner_mm - way_mm * way_mm);
    let exact_mm3 = height_mm * (PI * outer_mm * outer_mm + 2.0 * outer_mm * way_mm - lens_mm2);
    // Two flat faces square to z: whole layers of the rays along x and y are in or out, an error of first order.
    let off = errors(&tool, &Move::Straight { from, to }, exact_mm3, &STEPS_MM);
    for (off, step_mm) in off.iter().zip(STEPS_MM) {
        let bounds = [step_mm / height_mm, step_mm / height_mm, 0.30 * step_mm / outer_mm];
        assert!(off.iter().zip(bounds).all(|(off, bound)| off.abs() <= bound), "{off:?} {bounds:?}");
    }
}

#[test]
fn a_helix_sweeps_what_its_front_and_its_top_pass_over() {
    let (radius_mm, height_mm, about_mm, angle_rad, rise_mm) = (2.5, 6.0, 6.0, 3.0, 3.3);
    let tool = Tool::cylinder(radius_mm, height_mm).unwrap();
    let from = Pose { tip_mm: [about_mm, 0.0, -4.0], axis: UP };
    let helix = Move::Turn { from, center_mm: [0.0; 3], normal: UP, angle_rad, rise_mm };
    let disc_mm2 = PI * radius_mm * radius_mm;
    let exact_mm3 = disc_mm2 * height_mm + 2.0 * radius_mm * height_mm * about_mm * angle_rad + disc_mm2 * rise_mm;
    let off = errors(&tool, &helix, exact_mm3, &STEPS_MM[..3]);
    assert_converges("helix", &off, 1.0, 4e-3);
}
