//! The published slot on LinuxCNC: arcs of all four movements, as programmed, in pieces, and with the component.

use std::fs;

use arcfeed_tests::root;
use serde_json::{Value, json};

use super::machine::{INCH_MM, Machine, Ran};

/// Largest chip over its target, and least without the thin side, of all samples in the cut.
const OVER: f64 = 0.005;
/// Largest distance from the programmed arcs, inches: their coordinates have four decimals.
const PATH_ERROR_IN: f64 = 0.000_1;

/// Writes the slot with one pair of its levels, and the job of the example in this mode; answers the job's path.
pub fn job(machine: &Machine, mode: &str) -> String {
    let folder = root().join("examples/ibr-slot");
    let program = fs::read_to_string(folder.join("ibr-slot.nc")).expect("the example");
    let number = |line: &str| line.strip_prefix('N')?.split_once('G')?.0.parse::<u32>().ok();
    let is_kept =
        |line: &&str| number(line).is_none_or(|number| !(128..142).contains(&number) && !(154..204).contains(&number));
    let program = program.lines().filter(is_kept).collect::<Vec<_>>().join("\n");
    // The level begins with a line in the feed mode of those before it.
    let program = program.replace("N142G1", "N142G94F25.G1");
    fs::write(machine.path("ibr-slot.nc"), program).expect("a file");
    let job = fs::read_to_string(folder.join("job.toml")).expect("the example");
    let path = machine.path(&format!("{mode}.toml"));
    fs::write(&path, job.replace("safe-base", mode)).expect("a file");
    path
}

/// Figures of the slot in a mode, with or without the component's feed.
fn figures(machine: &Machine, mode: &str, arms: bool) -> (Ran, Value) {
    let job = job(machine, mode);
    machine.adapt(&job);
    let ran = machine.run(arms, json!([]));
    let figures = machine.measure(&job, &ran.samples, INCH_MM);
    let ranges: Vec<String> = figures["movements"].as_array().expect("movements").iter().map(range).collect();
    println!(
        "{mode}, component {arms}: {} samples, {} in the cut; chip over target {}; all samples {:+.4}; {:.1} s; path {:.6} in",
        ran.samples.len(),
        figures["chip_load"]["samples"],
        ranges.join(", "),
        figures["chip_load"]["error_ratio_max_all"].as_f64().expect("a ratio"),
        figures["cycle_time_s"].as_f64().expect("a time"),
        figures["path_error"].as_f64().expect("a length"),
    );
    (ran, figures)
}

fn range(movement: &Value) -> String {
    let chip = |key: &str| movement["chip_load"][key].as_f64().unwrap_or(f64::NAN);
    format!("{}: {:+.4} .. {:+.4}", movement["rule"], chip("error_ratio_min"), chip("error_ratio_max"))
}

#[test]
fn linuxcnc_cuts_the_slot_at_its_target_with_f_words_and_with_the_component() {
    let Some(machine) = Machine::or_skip("linuxcnc-slot") else { return };
    let (_, before) = figures(&machine, "override-only", false);
    let mut shares_thin = Vec::new();
    for (mode, arms) in [("rewrite-only", false), ("safe-base", true)] {
        let (ran, after) = figures(&machine, mode, arms);
        let chip = &after["chip_load"];
        let number = |key: &str| chip[key].as_f64().expect("a figure");
        assert!(number("error_ratio_max_all") <= OVER, "{mode}: {chip}");
        assert!(number("error_ratio_max_all") >= -OVER, "{mode}: the target is reached: {chip}");
        assert!(number("samples") > 2_000.0, "{mode}: {chip}");
        let thin = number("samples_thin") / number("samples");
        shares_thin.push(thin);
        assert!(after["path_error"].as_f64().expect("a length") < PATH_ERROR_IN, "{mode}: {after}");
        assert!(after["cycle_time_s"].as_f64() < before["cycle_time_s"].as_f64(), "{mode}");
        println!("{mode}: {:.1} % of the samples below the target by more than 2 %", 1e2 * thin);
        println!(
            "component {} clocks, at most {}; motion-controller {}",
            ran.last("time"),
            ran.last("most"),
            ran.last("motion")
        );
    }
    assert!(shares_thin[1] < 0.06, "as on sim: {shares_thin:?}");
    let most = before["chip_load"]["error_ratio_max_all"].as_f64().expect("a figure");
    assert!(most < -0.3, "the meter notices the programmed feed: {most}");
}
