//! All slots of a wheel in the dexels of `simulate`: their volume is that of the plan, and the blank's that of its closed form.

use std::f64::consts::PI;

use arcfeed_tests::{Scratch, number, object, of_full_set, root, run};
use serde_json::Value;

const SLOTS: usize = 19;
pub const MM3_PER_IN3: f64 = 25.4 * 25.4 * 25.4;
/// Volume of the example's blank, from its bore 5 mm below the hub.
const BLANK_MM3: f64 = PI * (98.6 * 98.6 - 65.0 * 65.0) * 28.0;

/// The example's part file with ten times the spindle speed, so a tenth of the machine's time.
pub fn fast_part() -> String {
    let text = std::fs::read_to_string(root().join("examples/blisk-19/PART.toml")).expect("the example");
    text.replace("rev_per_min = 100\n", "rev_per_min = 1000\n").replace("axial_feed = 2\n", "axial_feed = 20\n")
}

/// [`fast_part`] with one tool axis to try.
fn part() -> String {
    fast_part().replace("[roughing]", "[roughing]\naxis = \"roomiest\"")
}

/// Sequence number with which each slot begins.
fn first_numbers(program: &str) -> Vec<i64> {
    let number = |slot: &str| slot.split_once("\nN")?.1.split('G').next()?.parse().ok();
    program.split("(SLOT ").skip(1).map(|slot| number(slot).expect("an N")).collect()
}

/// Volume that each slot loses, mm3.
fn slot_volumes_mm3(starts: &[i64], blocks: &Value) -> Vec<f64> {
    let mut slots = vec![0.0; starts.len()];
    for block in blocks.as_array().expect("blocks") {
        let slot = block["n"].as_i64().map_or(0, |n| starts.partition_point(|start| *start <= n));
        if let Some(slot) = slot.checked_sub(1) {
            slots[slot] += number(block, "/removal/removed") * MM3_PER_IN3;
        }
    }
    slots
}

#[test]
fn a_wheel_loses_the_planned_volume_in_every_slot() {
    let scratch = Scratch::new("plan-wheel");
    let (part, folder) = (scratch.write("PART.toml", part()), scratch.path("out"));
    let plan = object(&["plan", "cup-mill", &part, "-o", &folder, "--wheel"]);
    let starts = first_numbers(&std::fs::read_to_string(format!("{folder}/blisk-19.nc")).expect("the program"));
    assert_eq!(starts.len(), SLOTS);
    // Coarse rays are enough for volumes.
    let step = of_full_set("0.019685", "0.08");
    let text = std::fs::read_to_string(format!("{folder}/job.toml")).expect("the job");
    assert!(text.contains("step = 0.019685\n") && text.contains("indexed = true\n"), "{text}");
    let job = scratch.write("out/coarse.toml", text.replace("step = 0.019685\n", &format!("step = {step}\n")));
    object(&["engage", "--alike", &job]);
    let report = object(&["simulate", &job]);

    let material = &report["material"];
    let slots_mm3 = slot_volumes_mm3(&starts, &material["blocks"]);
    let [removed_mm3, left_mm3] = ["/removal/removed", "/left"].map(|pointer| number(material, pointer) * MM3_PER_IN3);
    let planned_mm3 = number(&plan, "/removed/total_mm3");
    println!("{planned_mm3:.0} mm3 a slot planned, {slots_mm3:.0?} simulated; {}", report["cycle_time_s"]);
    println!("{removed_mm3:.0} + {left_mm3:.0} mm3 of {BLANK_MM3:.0}");
    assert!((removed_mm3 / (SLOTS as f64 * planned_mm3) - 1.0).abs() < 0.01, "{removed_mm3}");
    assert!(((removed_mm3 + left_mm3) / BLANK_MM3 - 1.0).abs() < 2e-3, "{left_mm3}");
    assert!(slots_mm3.iter().all(|slot_mm3| (slot_mm3 / planned_mm3 - 1.0).abs() < 0.03), "{slots_mm3:?}");
    assert_eq!(number(material, "/at_rapid"), 0.0);
}

#[test]
fn a_wheel_needs_a_machine_that_turns_it() {
    let scratch = Scratch::new("plan-wheel-refused");
    let part = scratch.write("PART.toml", part().replace("[machine]\npreset = \"mitsui-seiki-hu80a-5x\"\n", ""));
    let output = run(&["plan", "cup-mill", &part, "-o", &scratch.path("out"), "--wheel"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && said.contains("--wheel needs a [machine]"), "{said}");
    assert!(!std::path::Path::new(&scratch.path("out")).exists());
}
