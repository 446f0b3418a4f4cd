//! The cup mill's slot with its way down and its links between levels under the plunge law.

use arcfeed_tests::{Scratch, root, run};
use serde_json::Value;

/// Limit of the power, W.
const POWER_W: f64 = 15_000.0;

#[test]
fn the_ways_down_of_the_slot_keep_the_power_of_the_spindle() {
    let scratch = Scratch::new("plunge-slot");
    let folder = root().join("examples/ibr-slot");
    let read = |file: &str| std::fs::read_to_string(folder.join(file)).expect("an example");
    // F of the first way down is an inverse time, which no law governs.
    scratch.write("ibr-slot.nc", read("ibr-slot.nc").replace("G1G93Z-27.2876F50.", "G1Z-27.2876F25."));
    let plunge = "[plunge]\nmap = \"ibr-slot.engaged.toml\"\nramps = true\n\n[spindle]\nmax_power = \"15 kW\"\n";
    let job = scratch.write("job.toml", read("job-engaged.toml").replace("[spindle]\n", plunge));
    let output = |arguments: &[&str]| {
        let output = run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    output(&["engage", &job]);
    let report: Value = serde_json::from_slice(&output(&["simulate", &job, "--json"])).expect("one object");
    let blocks = report["loads"]["blocks"].as_array().expect("blocks");
    let most = |run: &str, key: &str, is_descent: bool| {
        let chosen = blocks.iter().filter(|block| block["rule"].is_null() == is_descent);
        chosen.filter_map(|block| block[run][key].as_f64()).fold(0.0, f64::max)
    };
    for (key, unit) in [("force_max_n", "N"), ("thrust_max_n", "N"), ("torque_max_n_m", "Nm"), ("power_max_w", "W")] {
        println!(
            "{key}: on ways down and links {:.0} {unit} for {:.0}, on arcs {:.0} for {:.0}",
            most("load", key, true),
            most("baseline", key, true),
            most("load", key, false),
            most("baseline", key, false)
        );
    }
    let time_s = |key: &str| report[key].as_f64().expect("a time");
    println!("cycle {:.1} s for {:.1}", time_s("cycle_time_s"), time_s("baseline_cycle_time_s"));
    assert!(most("load", "power_max_w", true) <= POWER_W && most("baseline", "power_max_w", true) > 3.0 * POWER_W);
    assert!(most("load", "power_max_w", true) > 0.85 * POWER_W, "the law uses the power that there is");
    assert!(most("load", "end_chip_max", true) <= 0.004);
    assert!(report["spindle"]["power"]["above"].as_array().is_some_and(Vec::is_empty));
}
