//! The loop closed on the example: stock, map, law, machine, and the chips that the edges then find.

use serde_json::Value;

use arcfeed_tests::{Scratch, root, run};

/// Wanted, inches.
const CHIP_IN: f64 = 0.004;

fn example(file: &str) -> String {
    std::fs::read_to_string(root().join("examples/ibr-slot").join(file)).expect("a file of the example")
}

/// The example's job with these changes, its map made.
fn engaged(name: &str, changes: &[(&str, &str)]) -> (Scratch, String) {
    let scratch = Scratch::new(&format!("engage-{name}"));
    scratch.write("ibr-slot.nc", example("ibr-slot.nc"));
    let job = changes.iter().fold(example("job-engaged.toml"), |job, (from, to)| {
        assert!(job.contains(from), "{from}");
        job.replace(from, to)
    });
    let job = scratch.write("job.toml", job);
    assert!(run(&["engage", &job]).status.success());
    (scratch, job)
}

/// The thickest chip of any edge in each movement, over the wanted one, by a job that is the example's with these changes.
fn thickest(name: &str, changes: &[(&str, &str)]) -> Vec<f64> {
    let (_scratch, job) = engaged(name, changes);
    let output = run(&["simulate", &job, "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).expect("one object");
    // The geometric meter measures no pieces of a move with a map.
    let is_whole = changes.iter().all(|(_, to)| !to.contains("rewrite-only"));
    for movement in report["movements"].as_array().expect("movements").iter().filter(|_| is_whole) {
        let runs = ["chip_load", "baseline_chip_load"];
        let metered = runs.map(|run| movement[run]["error_ratio_max_all"].as_f64().expect("it is measured"));
        assert!(metered[0].abs() < 5e-3 && metered[1] < -0.4, "{name}: {metered:?}");
    }
    let chips = |rule: &Value| {
        let circles = rule["load"]["chip_max"].as_array().expect("two circles").iter().filter_map(Value::as_f64);
        circles.fold(0.0, f64::max) / CHIP_IN
    };
    let rules = report["loads"]["rules"].as_array().expect("rules").iter().filter(|rule| !rule["rule"].is_null());
    let thickest: Vec<f64> = rules.map(chips).collect();
    println!("{name}: {thickest:.4?} of the chip wanted, {} s", report["cycle_time_s"]);
    thickest
}

#[test]
fn no_edge_finds_a_thicker_chip_than_wanted_whoever_makes_the_feed() {
    let live = thickest("live", &[]);
    let pieces = thickest("pieces", &[("mode = \"safe-base\"", "mode = \"rewrite-only\"")]);
    for thickest in [live, pieces] {
        // Movement 4 would need more than 200 % of its least feed.
        assert_eq!(thickest.len(), 4);
        assert!(thickest.iter().all(|ratio| *ratio <= 1.002), "{thickest:?}");
        assert!(thickest[..3].iter().all(|ratio| *ratio >= 0.98), "{thickest:?}");
    }
}

#[test]
fn an_override_that_falls_slowly_begins_early_enough_for_the_corner_of_the_stock() {
    for (name, slew_down) in [("slow", "slew_down = 60"), ("fast", "slew_down = 2000")] {
        let thickest = thickest(name, &[("slew_down = 200", slew_down)]);
        assert!(thickest.len() == 4 && thickest.iter().all(|ratio| *ratio <= 1.002), "{thickest:?}");
        assert!(thickest.iter().all(|ratio| *ratio >= 0.95), "{thickest:?}");
    }
}

#[test]
fn a_board_on_its_link_gets_the_engagement_and_one_that_reads_the_line_is_refused() {
    // Without edges: only times are asked.
    let job = example("job-engaged.toml");
    let cutting = &job[job.find("[cutting]").expect("edges")..job.find("[spindle]").expect("a spindle")];
    let (scratch, job) = engaged("board", &[(cutting, "")]);
    let time_s = |arguments: &[&str]| {
        let output = run(&[&["stream", &job, "--port", "sim:", "--json"], arguments].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let report: Value = serde_json::from_slice(&output.stdout).expect("one object");
        report["cycle_time_s"].as_f64().expect("a time")
    };
    let [in_process, by_board] = [time_s(&[]), time_s(&["--board", "sim:"])];
    println!("in process {in_process} s, a board on its link {by_board} s");
    // A period or two a block, and the way it takes to be heard.
    assert!((in_process - by_board).abs() < 0.1, "{in_process} {by_board}");
    let refused = run(&["parameters", &job, "-o", &scratch.path("page.bin")]);
    let words = String::from_utf8_lossy(&refused.stderr);
    println!("{}", words.trim_end());
    assert!(refused.status.code() == Some(1) && words.contains("job.toml:") && words.contains("rule"), "{words}");
}
