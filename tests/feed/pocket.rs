//! `examples/pocket`: two laws on one program say what its README says.

use arcfeed_tests::run;
use serde_json::Value;

/// The blocks of `adapt --json` for one of the two jobs.
fn blocks(job: &str) -> Vec<Value> {
    let output = run(&["adapt", &format!("examples/pocket/{job}.toml"), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("JSON is text");
    text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect()
}

/// Sent feed of a block, mm/min, and its reason.
fn sent(blocks: &[Value], sequence: i64) -> (f64, &str) {
    let block = blocks.iter().find(|block| block["n"] == sequence).expect("the block has a move");
    (block["sent_feed"].as_f64().expect("it has a feed"), block["reason"].as_str().expect("and a reason"))
}

#[test]
fn the_contour_law_slows_inside_arcs_by_their_radii_and_speeds_no_outside_arc_up() {
    let blocks = blocks("job-contour");
    // Path radius 3, contour radius 8.
    assert_eq!(sent(&blocks, 140), (3200.0 * 3.0 / 8.0, "law"));
    assert_eq!(sent(&blocks, 310), (3200.0, "law"));
    // The slot's outer wall: path radius 25, contour radius 30, rounded to the thin side.
    assert_eq!(sent(&blocks, 440), (1333.3, "law"));
    assert_eq!(sent(&blocks, 130), (3200.0, "no-rule"));
}

#[test]
fn the_engagement_law_asks_for_less_in_corners_than_on_lines_but_for_more_than_the_contour_law() {
    let blocks = blocks("job-engagement");
    let (corner, reason) = sent(&blocks, 140);
    let factor = corner / 3200.0;
    println!("corner factor {factor:.3} at tool diameter over contour radius 1.25, radial depth a tenth");
    // Between the published 0.63 (1.20) and 0.42 (1.60), far above the contour law's 0.375.
    assert!(reason == "law" && (0.42..0.64).contains(&factor), "{factor}");
    assert_eq!(sent(&blocks, 130), (3200.0, "law"));
    assert_eq!(sent(&blocks, 440), (1600.0, "law"));
}

/// The report of `simulate --json` for one of the two jobs.
fn simulated(job: &str) -> Value {
    let output = run(&["simulate", &format!("examples/pocket/{job}.toml"), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one object")
}

/// Measured least and largest of a rule, `chip_load` after or `baseline_chip_load` before, mm.
fn measured(report: &Value, rule: usize, run: &str) -> [f64; 2] {
    ["min", "max"].map(|field| report["movements"][rule][run][field].as_f64().expect("it is measured"))
}

#[test]
fn the_machine_keeps_the_feed_at_the_contour_as_the_readme_has_it() {
    let report = simulated("job-contour");
    assert_eq!(report["blocks_executed"], 32);
    // Corner: path 3, contour 8. Island: path 15, contour 10. Slot: path 25, wall 30.
    let before = [0.1 * 8.0 / 3.0, 0.1 * 10.0 / 15.0, 0.05 * 30.0 / 25.0];
    for (rule, (before_mm, after_mm)) in before.into_iter().zip([0.1, 0.1 * 10.0 / 15.0, 0.05]).enumerate() {
        for (run, wanted_mm) in [("baseline_chip_load", before_mm), ("chip_load", after_mm)] {
            let [least, most] = measured(&report, rule, run);
            println!("rule {} {run}: {least:.5} .. {most:.5}, closed form {wanted_mm:.5}", rule + 1);
            assert!(most < wanted_mm * 1.0001 && least > wanted_mm * 0.994, "{least} {most} {wanted_mm}");
        }
    }
    assert!(report["chip_load"]["error_ratio_max_all"].as_f64().expect("measured") < 5e-3);
}

#[test]
fn under_the_engagement_law_no_chip_is_above_its_target_and_lines_are_at_it() {
    let report = simulated("job-engagement");
    assert!(report["chip_load"]["error_ratio_max_all"].as_f64().expect("measured") < 5e-3);
    // The corners take 0.61 of the feed by the published factor; before, their thickest chip is that of 60 degrees, at most.
    let [least, most] = measured(&report, 0, "baseline_chip_load");
    assert!(least > 0.1 * 0.6 && most < 0.1 * libm::sin(60.0_f64.to_radians()), "{least} {most}");
    assert!(measured(&report, 0, "chip_load")[1] < 0.06 && measured(&report, 3, "chip_load")[0] > 0.06 * 0.98);
}
