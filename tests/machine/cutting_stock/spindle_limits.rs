//! The spindle's limits: simulated and estimated power against them, with the blocks above.

use crate::cutting_stock::scratch_job::{MILL, SLOT, ScratchJob};

const LIMITS: &str = "rev_per_min = 3000\nmax_power = \"200 W\"\nmax_torque = \"0.5 Nm\"\n";
const KIENZLE: &str = "[cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 4\n";

fn job(cutting: &str) -> String {
    MILL.replace("rev_per_min = 3000\n", LIMITS) + cutting
}

#[test]
fn blocks_above_a_limit_are_a_warning_with_their_numbers_before_and_after() {
    let output = ScratchJob::new("spindle-cutting", &job(KIENZLE), SLOT).run(&[]);
    println!("{}", output.complaints);
    let spindle = &output.report["spindle"];
    assert_eq!(spindle["source"], "cutting");
    for (quantity, words) in
        [("power", "power above the spindle's 0.2000 kW"), ("torque", "torque above the spindle's 0.5000 N m")]
    {
        let above = spindle[quantity]["above"].as_array().expect("a list");
        assert_eq!(above.len(), spindle[quantity]["baseline_above"].as_array().expect("a list").len());
        let slot = above.iter().find(|block| block["n"] == 4).expect("N4 is the slot");
        assert!(slot["value"].as_f64() <= spindle[quantity]["max"].as_f64());
        for side in ["before", "after"] {
            let line = format!("warning: {side}: {words} in {} blocks: ", above.len());
            assert!(output.complaints.contains(&line) && output.complaints.contains("N4 ("), "{line}");
        }
    }
    let (code, words) = ScratchJob::new("spindle-assert", &job(KIENZLE), SLOT).failed(&["--assert", "torque<=0.1Nm"]);
    assert!(code == Some(1) && words.contains("program.nc:5: N3: torque is "), "{words}");
}

#[test]
fn the_estimate_of_a_slot_is_near_the_mean_power_of_its_simulated_forces() {
    let with = |material: &str, cutting: &str| {
        let job = job(cutting).replace("step = 0.25\n", &format!("step = 0.25\n{material}"));
        ScratchJob::new("spindle-estimate", &job, SLOT).run(&[]).report
    };
    let simulated = with("", KIENZLE);
    let blocks = simulated["loads"]["blocks"].as_array().expect("a list");
    let slot = blocks.iter().find(|block| block["n"] == 4).expect("N4 is the slot");
    let mean_w = slot["load"]["power_mean_w"].as_f64().expect("a power");
    let estimated = with("material = \"Ti-6Al-4V\"\n", "");
    let spindle = &estimated["spindle"];
    assert_eq!((&spindle["source"], spindle["torque"].is_null()), (&"estimate".into(), true));
    let above = spindle["power"]["above"].as_array().expect("a list");
    let slot = above.iter().find(|block| block["n"] == 4).expect("N4 is above 200 W");
    let value_w = slot["value"].as_f64().expect("a power");
    println!("slot: {mean_w:.0} W by forces, {value_w:.0} W estimated");
    assert!((value_w / mean_w - 1.0).abs() < 0.1);
    // 40 mm2 at 600 mm/min, with the specific force that the report names.
    let force = spindle["specific_force_n_per_mm2"].as_f64().expect("a force");
    assert!((value_w / (force * 40.0 * 600.0 / 60.0 / 1e3) - 1.0).abs() < 2e-3);
}

#[test]
fn limits_that_nothing_can_be_compared_with_are_a_warning() {
    let output = ScratchJob::new("spindle-nothing", &job(""), SLOT).run(&[]);
    assert!(output.report["spindle"].is_null());
    assert!(output.complaints.contains("limits in [spindle] are not checked"), "{}", output.complaints);
}

#[test]
fn a_limit_without_a_unit_and_an_unknown_material_have_their_places() {
    for (from, to, words) in [
        ("\"200 W\"", "\"200\"", "job.toml:10:13: max_power is a power such as"),
        ("\"200 W\"", "\"-1 kW\"", "job.toml:10:13: max_power is a power such as"),
        ("\"0.5 Nm\"", "\"1 ft lb\"", "job.toml:11:14: max_torque is a torque such as"),
        ("step = 0.25\n", "step = 0.25\nmaterial = \"cheese\"\n", "no coefficients are known of `cheese`"),
    ] {
        let (code, found) = ScratchJob::new("spindle-wrong", &job("").replace(from, to), SLOT).failed(&[]);
        assert!(code == Some(1) && found.contains(words), "{words}: {found}");
    }
}
