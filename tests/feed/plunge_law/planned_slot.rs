//! A planned slot of a cup mill with its way down and the links between its levels under the plunge law.

use std::fs;

use arcfeed_tests::{Scratch, root, run};
use serde_json::Value;

/// Limits of the power, W: below and above the largest of the program at its own feeds.
const POWERS_W: [f64; 2] = [2_000.0, 3_000.0];
/// Largest power of the way down as long as it entered the blank at `approach_feed`, W (docs/plunge.md).
const FAST_APPROACH_W: f64 = 25_000.0;
/// Tables that the planned job does not have; edges over the cavity's depth.
const LIMITS: &str = "[plunge]\nmap = \"first.engaged.toml\"\nramps = true\n\n[spindle]\nmax_power = \"POWER W\"\n";
const CUTTING: &str =
    "\n[cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 1.49\nlayers = 10\n";

fn output(arguments: &[&str]) -> Vec<u8> {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// Plans the first slot of the example in a folder, and returns its job without a limit of the power in `POWER`.
fn planned(scratch: &Scratch, folder: &str) -> String {
    let part = fs::read_to_string(root().join("examples/blisk-19/PART.toml")).expect("the example");
    let part = scratch.write("PART.toml", part.replace("[roughing]", "[roughing]\naxis = \"roomiest\""));
    output(&["plan", "cup-mill", &part, "-o", folder]);
    let path = |name: &str| format!("{folder}/{name}");
    let text = fs::read_to_string(path("blisk-19.nc")).expect("the program");
    let (first, _) = text.split_once("(SLOT 2 OF").expect("more than one slot");
    fs::write(path("first.nc"), format!("{first}M30\n%\n")).expect("it can be written");
    let job = fs::read_to_string(path("job.toml")).expect("a job").replace("blisk-19.nc", "first.nc");
    let job = job.replace("blisk-19.engaged.toml", "first.engaged.toml").replacen("[spindle]\n", LIMITS, 1);
    // Coarse cells.
    job.replace("step = 0.019685", "step = 0.04") + CUTTING
}

#[test]
fn ways_down_of_a_planned_slot_keep_the_power_also_behind_an_arc() {
    let scratch = Scratch::new("plunge-planned-slot");
    let folder = scratch.path("out");
    let job = planned(&scratch, &folder);
    for power_w in POWERS_W {
        let file = format!("{folder}/first.toml");
        fs::write(&file, job.replace("POWER", &power_w.to_string())).expect("it can be written");
        output(&["engage", &file]);
        let report: Value = serde_json::from_slice(&output(&["simulate", &file, "--json"])).expect("one object");
        assert_eq!(report["alarms"], Value::Array(Vec::new()));
        let blocks = report["loads"]["blocks"].as_array().expect("blocks");
        let most = |run: &str, key: &str, is_descent: bool| {
            let chosen = blocks.iter().filter(|block| block["rule"].is_null() == is_descent);
            chosen.filter_map(|block| block[run][key].as_f64()).fold(0.0, f64::max)
        };
        for (key, unit) in [("force_max_n", "N"), ("thrust_max_n", "N"), ("torque_max_n_m", "Nm"), ("power_max_w", "W")]
        {
            let [descents, arcs] =
                [true, false].map(|is_descent| ["load", "baseline"].map(|run| most(run, key, is_descent)));
            println!(
                "{power_w} W: {key}: on ways down {:.0} {unit} for {:.0}, on arcs {:.0} for {:.0}",
                descents[0], descents[1], arcs[0], arcs[1]
            );
        }
        let time_s = ["cycle_time_s", "baseline_cycle_time_s"].map(|key| report[key].as_f64().expect("a time"));
        println!("{power_w} W: cycle {:.1} s for {:.1}", time_s[0], time_s[1]);
        let descents = blocks.iter().filter(|block| block["rule"].is_null()).count();
        let [power, chip] = ["power_max_w", "end_chip_max"].map(|key| most("load", key, true));
        assert!(descents >= 12 && power <= power_w * 1.01 && chip <= 0.004 * 1.005, "{descents} {power} {chip}");
        // The program enters the blank slowly before any law sees it.
        let programmed = most("baseline", "power_max_w", true);
        assert!(programmed > POWERS_W[0] * 1.1 && programmed < FAST_APPROACH_W / 8.0, "{programmed}");
        assert!(time_s[0] < time_s[1], "{time_s:?}");
    }
}
