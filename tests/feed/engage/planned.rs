//! From blades to chips: a planned rotor, its engagement found, its feeds by the law, its chips by the edges.

use arcfeed_tests::{Scratch, root, run};
use serde_json::Value;

const PART: &str = "examples/blisk-19/PART.toml";
/// Wanted, inches.
const CHIP_IN: f64 = 0.004;

fn object(arguments: &[&str]) -> Value {
    let output = run(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one object")
}

/// Line by line: tables of the job that the map replaces, or that the edges need.
fn with_map(job: &str) -> String {
    let lines = job.lines().filter(|line| !line.starts_with("z = ")).map(|line| match line {
        "kind = \"circumference\"" => "kind = \"engaged-arc\"",
        line if line.starts_with("stock = ") => "stock = { map = \"map.toml\" }",
        line => line,
    });
    let cutting = "[cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 0.0958";
    lines.chain([cutting]).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_planned_rotor_cuts_with_the_wanted_chip_in_every_slot_that_is_alike() {
    let scratch = Scratch::new("engage-planned");
    // Ten times the spindle speed: a tenth of the machine's time. One direction of the axis is enough here.
    let text = std::fs::read_to_string(root().join(PART)).expect("the example");
    let text = text
        .replace("rev_per_min = 100\n", "rev_per_min = 1000\n")
        .replace("axial_feed = 2\n", "axial_feed = 20\n")
        .replace("[roughing]", "[roughing]\naxis = \"roomiest\"");
    let folder = scratch.path("out");
    object(&["plan", "cup-mill", &scratch.write("PART.toml", text), "-o", &folder]);
    let job = format!("{folder}/job.toml");
    let by_lines = std::fs::read_to_string(&job).expect("a job");
    std::fs::write(&job, with_map(&by_lines)).expect("it can be written");

    let first_slot = object(&["engage", &job]);
    let found = |report: &Value| {
        let moves = report["moves"].as_array().expect("moves").iter();
        let [all, mapped] = [moves.clone().count(), moves.filter(|found| found["knots"] != 0).count()];
        (all, mapped)
    };
    let (all, mapped) = found(&first_slot);
    assert_eq!(mapped * 19, all, "one slot of 19 is where the workpiece is known to be");
    assert_eq!(found(&object(&["engage", &job, "--alike"])), (all, all));

    let report = object(&["simulate", &job]);
    let rules = report["loads"]["rules"].as_array().expect("rules").iter().filter(|rule| !rule["rule"].is_null());
    let thickest = |rule: &Value| {
        let circles = rule["load"]["chip_max"].as_array().expect("two circles").iter().filter_map(Value::as_f64);
        circles.fold(0.0, f64::max) / CHIP_IN
    };
    let thickest: Vec<f64> = rules.map(thickest).collect();
    println!("{all} arcs; thickest chip of each movement over the wanted one: {thickest:.3?}");
    assert_eq!(thickest.len(), 4);
    // The arcs are shallow cuts at the faces: mostly more is wanted than 200 % of the least feed.
    assert!(thickest.iter().all(|ratio| *ratio <= 1.02) && thickest.iter().any(|ratio| *ratio > 0.85), "{thickest:?}");
}
