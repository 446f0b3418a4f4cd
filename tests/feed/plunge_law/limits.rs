//! Feeds of the law beside one earlier plunge, against closed forms of an independent program.

use std::f64::consts::TAU;

use arcfeed::axial_law::{AxialLaw, Edges, Inclination, torque_max_n_m};
use arcfeed::engagement::sections::{MappedSection, TangentialForce};

use crate::plunge_law::table::rows;

#[test]
fn feeds_by_chip_power_and_torque_are_those_of_an_independent_program() {
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
