//! The oracle for chip thickness against an independent program, and against what it must be by itself.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::cutting_forces::rows::rows;
use crate::cutting_forces::trochoid::Trochoid;

#[test]
fn chips_are_those_of_an_independent_program() {
    let rows = rows(include_str!("chip_thickness_exact.csv"));
    let mut worst = 0.0_f64;
    for row in &rows {
        let (radius_mm, feed_mm_per_tooth) = (row.number("R_mm"), row.number("fz_mm"));
        let teeth = row.number("N") as usize;
        let chip_mm = Trochoid { radius_mm, teeth, feed_mm_per_tooth }.chip_mm(row.number("phi_deg").to_radians());
        worst = worst.max((chip_mm - row.number("h_exact_trochoid_mm")).abs());
    }
    println!("{} rows, {worst:.1e} mm at worst", rows.len());
    // Nine decimals are printed.
    assert!(rows.len() == 48 && worst <= 0.51e-9, "{} {worst:e}", rows.len());
}

#[test]
fn ahead_the_chip_is_the_feed_and_a_large_cutter_follows_the_sine() {
    let of = |radius_mm| Trochoid { radius_mm, teeth: 4, feed_mm_per_tooth: 0.1 };
    assert!((of(5.0).chip_mm(FRAC_PI_2) - 0.1).abs() < 1e-15);
    for angle_rad in [0.3, 1.0, 2.0, PI - 0.3] {
        // Second order in fz / R: fz^2 / 2R at most, and z fz^2 / 4 pi R of the rotation.
        let off_mm = of(1e5).chip_mm(angle_rad) - 0.1 * libm::sin(angle_rad);
        assert!(off_mm.abs() < 1e-7, "{angle_rad} {off_mm:e}");
    }
}
