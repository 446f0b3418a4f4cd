//! A planned slot of a cup mill with its way down and the links between its levels under the plunge law.

use std::fs;

use arcfeed_tests::{Scratch, root, run};
use serde_json::Value;

/// Limit of the power, W.
const POWER_W: f64 = 3_000.0;
/// Tables that the planned job does not have; edges over the cavity's depth.
const LIMITS: &str = "[plunge]\nmap = \"first.engaged.toml\"\nramps = true\n\n[spindle]\nmax_power = \"3 kW\"\n";
const CUTTING: &str =
    "\n[cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 1.49\nlayers = 10\n";

fn output(arguments: &[&str]) -> Vec<u8> {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

#[test]
fn the_ways_down_of_a_planned_slot_keep_the_power_but_for_the_tooth_behind_an_arc() {
    let scratch = Scratch::new("plunge-planned-slot");
    let part = fs::read_to_string(root().join("examples/blisk-19/PART.toml")).expect("the example");
    let part = scratch.write("PART.toml", part.replace("[roughing]", "[roughing]\naxis = \"roomiest\""));
    let folder = scratch.path("out");
    output(&["plan", "cup-mill", &part, "-o", &folder]);
    let path = |name: &str| format!("{folder}/{name}");
    let text = fs::read_to_string(path("blisk-19.nc")).expect("the program");
    let (first, _) = text.split_once("(SLOT 2 OF").expect("more than one slot");
    fs::write(path("first.nc"), format!("{first}M30\n%\n")).expect("it can be written");
    let job = fs::read_to_string(path("job.toml")).expect("a job").replace("blisk-19.nc", "first.nc");
    let job = job.replace("blisk-19.engaged.toml", "first.engaged.toml").replacen("[spindle]\n", LIMITS, 1);
    fs::write(path("first.toml"), job.replace("step = 0.019685", "step = 0.04") + CUTTING).expect("it can be written");

    output(&["engage", &path("first.toml")]);
    let report: Value =
        serde_json::from_slice(&output(&["simulate", &path("first.toml"), "--json"])).expect("one object");
    assert_eq!(report["alarms"], Value::Array(Vec::new()));
    let blocks = report["loads"]["blocks"].as_array().expect("blocks");
    let of = |block: &Value, run: &str, key: &str| block[run][key].as_f64().unwrap_or(0.0);
    for (key, unit) in [("force_max_n", "N"), ("thrust_max_n", "N"), ("torque_max_n_m", "Nm"), ("power_max_w", "W")] {
        let most = |run: &str, is_descent: bool| {
            let chosen = blocks.iter().filter(|block| block["rule"].is_null() == is_descent);
            chosen.map(|block| of(block, run, key)).fold(0.0, f64::max)
        };
        let [descents, arcs] = [true, false].map(|is_descent| ["load", "baseline"].map(|run| most(run, is_descent)));
        println!(
            "{key}: on ways down {:.0} {unit} for {:.0}, on arcs {:.0} for {:.0}",
            descents[0], descents[1], arcs[0], arcs[1]
        );
    }
    let time_s = ["cycle_time_s", "baseline_cycle_time_s"].map(|key| report[key].as_f64().expect("a time"));
    println!("cycle {:.1} s for {:.1}", time_s[0], time_s[1]);

    let mut above = Vec::new();
    let mut before_w = 0.0;
    for block in blocks {
        let power_w = of(block, "load", "power_max_w");
        if block["rule"].is_null() {
            assert!(power_w <= POWER_W * 1.01 + before_w, "{block}: {before_w} W before");
            assert!(of(block, "load", "end_chip_max") <= 0.004 * 1.005, "{block}");
            above.extend((power_w > POWER_W).then_some(power_w));
        }
        before_w = power_w;
    }
    println!("above the limit behind an arc: {above:.0?} W");
    assert!(above.len() <= 1 && above.iter().all(|power_w| *power_w < 1.1 * POWER_W), "{above:?}");
    let peaks =
        ["load", "baseline"].map(|run| blocks.iter().map(|block| of(block, run, "power_max_w")).fold(0.0, f64::max));
    assert!(peaks[1] > 5.0 * POWER_W && peaks[0] < 1.1 * POWER_W && time_s[0] < time_s[1], "{peaks:?} {time_s:?}");
}
