//! Feeds of the law beside one earlier plunge, against closed forms of an independent program.

use std::f64::consts::TAU;

use arcfeed::axial_law::{AxialLaw, Edges, Inclination, torque_max_n_m};
use arcfeed::engagement::sections::{MappedDescent, MappedSection, TangentialForce};
use arcfeed_law::{FeedLaw, Place};

use crate::plunge_law::table::rows;

#[test]
fn point_7_feeds_by_chip_power_and_torque_are_those_of_an_independent_program() {
    let (mut worst, mut count) = (0.0_f64, 0);
    for row in rows(include_str!("an_feed.csv")) {
        let (teeth, rev_per_min) = (row.number("teeth"), row.number("rev_per_min"));
        let limit = |by: &str| match by {
            "chip" => [f64::INFINITY; 2],
            "power" => [f64::INFINITY, row.number("power_kW") * 1e3],
            _ => [row.number("torque_Nm"), f64::INFINITY],
        };
        let law = |[torque_n_m, power_w]: [f64; 2]| AxialLaw {
            feed_per_tooth_mm: row.number("fz_mm"),
            edges: Edges { side: teeth, end: teeth },
            diameter_mm: 2.0 * row.number("R_mm"),
            force: TangentialForce { specific_mpa: row.number("kc_N_mm2"), exponent_ratio: 0.0, edge_n_per_mm: 0.0 },
            torque_max_n_m: torque_max_n_m(Some(torque_n_m), Some(power_w), rev_per_min),
            floor_mm2: 0.0,
        };
        // The data limits the mean over a turn.
        let end_mm2 = teeth * row.number("area_mm2") / TAU;
        let section = MappedSection { at_mm: 0.0, end_mm2, side_mm2: 0.0 };
        let feed = |limits| {
            let path_mm = law(limits).path_mm(row.number("fz_mm"), &section, Inclination::PLUNGE).expect("a path");
            path_mm * teeth * rev_per_min
        };
        let all = feed([row.number("torque_Nm"), row.number("power_kW") * 1e3]);
        for found in [all, feed(limit(row.text("limited_by")))] {
            let error = found / row.number("feed_mm_min") - 1.0;
            worst = worst.max(error.abs());
            assert!(error.abs() < 1e-9, "{} at {}: {found}", row.text("case"), row.text("at_mm"));
        }
        count += 1;
    }
    println!("an_feed: {count} feeds, largest error {worst:.1e}, each by the limit that the data names");
    assert_eq!(count, 110);
}

/// Area of a disc of radius R beside a cut disc of the same radius at a distance d < 2 R.
fn crescent_mm2(radius_mm: f64, apart_mm: f64) -> f64 {
    let square = radius_mm * radius_mm;
    let chord_mm = libm::sqrt(4.0 * square - apart_mm * apart_mm);
    let lens_mm2 = 2.0 * square * libm::acos(apart_mm / (2.0 * radius_mm)) - apart_mm / 2.0 * chord_mm;
    TAU / 2.0 * square - lens_mm2
}

#[test]
fn point_7_along_the_plunges_of_a_fan_power_and_torque_stay_within_their_limits() {
    let (radius_mm, teeth, rev_per_min, depth_mm, specific_mpa) = (6.0, 3.0, 1_300.0, 33.0, 2_100.0);
    let area_mm2 = |at_mm: f64| crescent_mm2(radius_mm, 5.0 - 2.2 * at_mm / depth_mm);
    let sections = |every_mm: f64| -> Vec<MappedSection> {
        let count = (depth_mm / every_mm) as u32;
        let at = |step: u32| f64::from(step) * depth_mm / f64::from(count);
        let section = |at_mm| MappedSection { at_mm, end_mm2: teeth * area_mm2(at_mm) / TAU, side_mm2: 0.0 };
        (0..=count).map(|step| section(at(step))).collect()
    };
    let feed = |path_mm: f64| path_mm * teeth * rev_per_min;
    let mut worst = [0.0_f64; 2];
    for (torque_n_m, power_w) in [(f64::INFINITY, 500.0), (4.1, f64::INFINITY), (3.9, 540.0), (100.0, 1e5)] {
        let law = AxialLaw {
            feed_per_tooth_mm: 0.08,
            edges: Edges { side: teeth, end: teeth },
            diameter_mm: 2.0 * radius_mm,
            force: TangentialForce { specific_mpa, exponent_ratio: 0.0, edge_n_per_mm: 0.0 },
            torque_max_n_m: torque_max_n_m(Some(torque_n_m), Some(power_w), rev_per_min),
            floor_mm2: 0.0,
        };
        let moved = MappedDescent { line: 1, sequence: None, key: 0, sections: sections(0.25), joints: [None; 2] };
        let table = law.table(&moved, depth_mm, (1.0, true)).expect("a table");
        let mut least = f64::INFINITY;
        for step in 0..=3_300 {
            let at_mm = f64::from(step) * depth_mm / 3_300.0;
            let place = Place { center_mm: [0.0; 2], motion: [0.0; 2], towards: [0.0; 2], travelled_mm: at_mm as f32 };
            let path_mm = f64::from(table.demand(&place).expect("a demand").path_mm_per_tooth);
            least = least.min(path_mm);
            // (17): kc A F in W with mm and minutes, and kc F A / (2 pi n).
            let power = specific_mpa * area_mm2(at_mm) * feed(path_mm) / 60e3;
            let torque = power / (TAU * rev_per_min / 60.0);
            worst = [worst[0].max(power / power_w), worst[1].max(torque / torque_n_m)];
            assert!(
                power <= power_w * (1.0 + 1e-9) && torque <= torque_n_m * (1.0 + 1e-9),
                "{at_mm}: {power} {torque}"
            );
            assert!(path_mm <= 0.08);
        }
        // The limit acts: at the roof, where the section is largest, nothing more is possible but for the grid of the table.
        let most = law.path_mm(0.08, &sections(0.25)[0], Inclination::PLUNGE).expect("a path");
        assert!(least <= most.min(0.04) && least > 0.95 * most.min(0.04), "{least} {most}");
    }
    println!("power and torque over their limits at most {:.6}, {:.6}", worst[0], worst[1]);
    assert!(worst.iter().all(|ratio| *ratio > 0.95));
}
