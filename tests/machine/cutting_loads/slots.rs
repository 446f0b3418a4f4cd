//! Full slots by an end mill: what the summary says against the integrals of the chip by hand.

use std::f64::consts::{PI, TAU};

use crate::cutting_forces::trochoid::Trochoid;
use crate::cutting_loads::slot_job::{Slot, assert_near, block, number};

const LINEAR: &str = "cutting = [600, 200, 0]\nedge = [0, 0, 0]\n";

const TWO_TEETH: Slot<'_> = Slot {
    diameter_mm: 10.0,
    teeth: 2,
    rev_per_min: 3000.0,
    feed_mm_per_tooth: 0.1,
    axial_depth_mm: 1.0,
    way_mm: 20.0,
    cutting: LINEAR,
};

/// Relative; steps of 3 degrees meet a maximum within 1.5 degrees of it, and rays 0.25 mm apart give a chip to 3e-4.
const NEAR: f64 = 1e-3;

#[test]
fn two_teeth_in_a_slot_have_the_forces_in_closed_form() {
    // Ft = 600 N/mm2 x 0.1 mm x 1 mm, Fr a third of it, at R 5 mm; one tooth at a time.
    let report = TWO_TEETH.simulation_report("linear");
    let load = block(&report, 4);
    assert_near("largest force, N", number(load, "/force_max_n"), 20.0 * libm::sqrt(10.0), NEAR);
    assert_near("largest torque, N m", number(load, "/torque_max_n_m"), 0.3, NEAR);
    assert_near("largest power, W", number(load, "/power_max_w"), TAU * 50.0 * 0.3, NEAR);
    assert_near("thickest chip, mm", number(load, "/chip_max/0"), 0.1, NEAR);
    // Two teeth, each half of the time, for 20 mm at 600 mm/min; in the first turn chips grow from nothing.
    let path = Trochoid { radius_mm: 5.0, teeth: 2, feed_mm_per_tooth: 0.1 };
    let chips_mm = (0..9000).map(|step| path.chip_mm((f64::from(step) + 0.5) * PI / 9000.0).max(0.0));
    let mean_n_m = 600.0 * chips_mm.sum::<f64>() / 9000.0 * 5e-3;
    let impulse_n_m_s = number(load, "/torque_mean_n_m") * number(load, "/time_s");
    assert_near("torque times time, N m s", impulse_n_m_s, mean_n_m * 2.0, 4e-3);
    // Half a wave: nothing to the largest, over the mean.
    assert_near("variation", number(load, "/force_variation_ratio"), 0.3 / mean_n_m, 4e-3);
}

#[test]
fn four_teeth_have_kienzles_force_of_their_chips() {
    let slot = Slot {
        diameter_mm: 10.0,
        teeth: 4,
        rev_per_min: 3000.0,
        feed_mm_per_tooth: 0.05,
        axial_depth_mm: 4.0,
        way_mm: 20.0,
        cutting: "kc11 = 800\nmc = 0.25\nradial = 0.4\naxial = 0.2\n",
    };
    let report = slot.simulation_report("kienzle");
    let load = block(&report, 4);
    let path = Trochoid { radius_mm: 5.0, teeth: 4, feed_mm_per_tooth: 0.05 };
    let force_n = |angle_rad: f64| 800.0 * 4.0 * libm::pow(path.chip_mm(angle_rad).max(0.0), 0.75);
    let (mut most_n, mut most_n_m) = (0.0_f64, 0.0_f64);
    for step in 0..9000 {
        let first_rad = f64::from(step) / 9000.0 * PI / 2.0;
        let [tangential, next] = [first_rad, first_rad + PI / 2.0].map(force_n);
        // The second tooth's directions are the first one's, a quarter of a turn on.
        most_n = most_n.max(libm::hypot(tangential + 0.4 * next, next - 0.4 * tangential));
        most_n_m = most_n_m.max((tangential + next) * 5e-3);
    }
    assert_near("largest torque, N m", number(load, "/torque_max_n_m"), most_n_m, NEAR);
    assert_near("largest force, N", number(load, "/force_max_n"), most_n, NEAR);
    assert_near("largest power, W", number(load, "/power_max_w"), TAU * 50.0 * most_n_m, NEAR);
}

#[test]
fn a_helix_in_layers_has_the_forces_of_an_independent_program() {
    // docs/forces.md: the linear coefficients of titanium that are for tests.
    let slot = Slot {
        diameter_mm: 19.05,
        teeth: 4,
        rev_per_min: 1000.0,
        feed_mm_per_tooth: 0.05,
        axial_depth_mm: 5.08,
        way_mm: 4.0,
        cutting: "cutting = [1825, 770, 735]\nedge = [29.7, 55.7, 1.8]\nhelix = 30\nlayers = 20\n",
    };
    let report = slot.simulation_report("helix");
    let load = block(&report, 4);
    assert_near("largest force, N", number(load, "/force_max_n"), 954.52, 3e-3);
    assert_near("largest torque, N m", number(load, "/torque_max_n_m"), 9.094, 3e-3);
    // The way, short here, begins and ends at rest.
    assert_near("mean torque, N m", number(load, "/torque_mean_n_m"), 8.496, 5e-3);
}

#[test]
fn nothing_is_met_out_of_the_cut() {
    let report = TWO_TEETH.simulation_report("zero");
    let blocks = report["loads"]["blocks"].as_array().expect("a list");
    // The plunge has chips on its end, the way back is above.
    assert_eq!(blocks.iter().map(|block| block["n"].as_i64()).collect::<Vec<_>>(), [Some(3), Some(4)]);
    // Each of two teeth cuts for half a turn, 20 mm at 600 mm/min, but where its chip is below a thousandth.
    let time_s = number(block(&report, 4), "/time_s");
    assert!((1.95..2.03).contains(&time_s), "{time_s}");
    assert_eq!(report["loads"]["load"], report["loads"]["baseline"]);
    assert_eq!(report["loads"]["load"]["chip_max"][1], serde_json::Value::Null);
}
