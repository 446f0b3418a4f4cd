//! A full slot: every chip against the exact one, and its error against the distance of the rays.

use std::f64::consts::PI;

use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, EndMill};

use crate::chips::bench::{Seen, Straight};
use crate::cutting_forces::rows::rows;
use crate::cutting_forces::trochoid::Trochoid;

const MILL: EndMill = EndMill { diameter_mm: 10.0, corner_mm: 0.0, teeth: 4, helix_rad: 0.0, height_mm: 1.0 };
const EXACT: Trochoid = Trochoid { radius_mm: 5.0, teeth: 4, feed_mm_per_tooth: 0.1 };
/// Angle at both ends of the chip, which are accurate only to half of the dexel spacing.
const ENDS_RAD: f64 = 0.2;

fn slot(step_mm: f64) -> Vec<Seen> {
    let cutter = Cutter::end_mill(&MILL, Pieces::Slices { rise_mm: 1.0 }).unwrap();
    let straight = Straight {
        feed_mm_per_turn: 0.4,
        step_mm,
        material_mm: [-6.0 - step_mm / 3.0, 6.0],
        steps_a_turn: 720,
        turns: [3, 2],
    };
    straight.seen(cutter)
}

/// The largest error in front of the tool.
fn worst_mm(seen: &[Seen]) -> f64 {
    let inside = seen.iter().filter(|seen| (ENDS_RAD..PI - ENDS_RAD).contains(&seen.angle_rad));
    inside.map(|seen| (seen.thickness_mm - EXACT.chip_mm(seen.angle_rad)).abs()).fold(0.0, f64::max)
}

#[test]
fn chips_of_a_slot_are_the_exact_ones() {
    let worst = [0.4, 0.2, 0.1, 0.05].map(|step_mm| {
        let worst = worst_mm(&slot(step_mm));
        println!("{step_mm} mm between rays: {:.2e} mm off at most", worst);
        worst
    });
    // h/8 (step/r)^2 for linear interpolation, twice that at 45 degrees to the rays; then the steps of a turn.
    for (worst, step_mm) in worst.iter().zip([0.4, 0.2, 0.1, 0.05]) {
        let linear_mm = 0.1 / 8.0 * 2.0 * (step_mm / 5.0_f64).powi(2);
        assert!(*worst < 8.0 * linear_mm + 1e-6, "{worst} at {step_mm}");
    }
}

#[test]
fn chips_are_those_of_the_published_table() {
    let seen = slot(0.05);
    let rows = rows(include_str!("../cutting_forces/chip_thickness_exact.csv"));
    let mut compared = 0;
    for row in rows.iter().filter(|row| row.text("tool") == "endmill D10 z4") {
        let angle_rad = row.number("phi_deg").to_radians();
        if !(ENDS_RAD..PI - ENDS_RAD).contains(&angle_rad) {
            continue;
        }
        let there = row.number("h_exact_trochoid_mm");
        let nearest =
            seen.iter().min_by(|a, b| (a.angle_rad - angle_rad).abs().total_cmp(&(b.angle_rad - angle_rad).abs()));
        let found = nearest.expect("chips");
        assert!((found.angle_rad - angle_rad).abs() < 1e-6, "a step lies at every half degree");
        // A ten-thousandth of the feed per tooth.
        assert!((found.thickness_mm - there).abs() < 1e-5, "{angle_rad}: {} {there}", found.thickness_mm);
        compared += 1;
    }
    assert_eq!(compared, 6);
}

#[test]
fn nothing_is_in_front_of_an_edge_behind_the_tool() {
    let behind = slot(0.1).into_iter().filter(|seen| (PI + 0.05..2.0 * PI - 0.05).contains(&seen.angle_rad));
    assert!(behind.into_iter().all(|seen| seen.thickness_mm == 0.0));
}
