//! The planned job under the plunge law, as the planner writes it: power, torque and chip of a passage, and without the law.

use arcfeed_tests::{Scratch, of_full_set, root, run};
use serde_json::Value;

use super::executed::first_passage;

/// Part, its plunge law, and the limit of the power in it, W.
struct Case {
    folder: &'static str,
    before: &'static str,
    power_w: f64,
    /// In the unit of the part file.
    feed_per_tooth: f64,
    /// Plunges of the first passage in an ordinary run.
    plunges: usize,
}

fn output(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Program up to the end of a plunge, with its last lines; a plunge ends with its rapid out.
fn first_plunges(program: &str, count: usize) -> String {
    let outs: Vec<usize> = program.match_indices("G0Z").map(|(at, _)| at).collect();
    let at = outs[count - 1];
    let line_end = at + program[at..].find('\n').expect("a line's end") + 1;
    let end = program.rfind("M9").and_then(|at| program[..at].rfind('\n')).expect("an end");
    program[..line_end].to_owned() + program[end..].trim_start()
}

fn assert_governed(case: &Case) {
    let scratch = Scratch::new(&format!("plunge-governed-{}", case.folder));
    let path = root().join("examples").join(case.folder);
    let sections = path.join("rotor-b.csv");
    let law = format!(
        "law = {{ material = \"Ti-6Al-4V\", radial = 0.4, axial = 0.2, max_power = \"{} W\" }}\n{}",
        case.power_w, case.before
    );
    let part = std::fs::read_to_string(path.join("PART.toml")).expect("an example");
    let part = part.replacen(case.before, &law, 1).replace("rotor-b.csv", sections.to_str().expect("a path"));
    let (part, folder) = (scratch.write("PART.toml", part), scratch.path("out"));
    output(&["plan", "plunge", &part, "-o", &folder]);
    let (program, job) = (format!("{folder}/{}.nc", case.folder), format!("{folder}/job.toml"));
    let text = first_passage(&std::fs::read_to_string(&program).expect("a program"));
    std::fs::write(&program, of_full_set(text.clone(), first_plunges(&text, case.plunges))).expect("a program");
    let text = std::fs::read_to_string(&job).expect("a job");
    std::fs::write(&job, text.replace("[law]", "[override]\nmode = \"rewrite-only\"\n\n[law]")).expect("a job");

    output(&["engage", &job]);
    let report: Value = serde_json::from_str(&output(&["simulate", &job, "--json"])).expect("one object");
    assert_eq!(report["alarms"], Value::Array(Vec::new()));
    let blocks = report["loads"]["blocks"].as_array().expect("blocks");
    let most = |run: &str, key: &str| blocks.iter().filter_map(|block| block[run][key].as_f64()).fold(0.0, f64::max);
    for key in ["power_max_w", "torque_max_n_m", "force_max_n", "thrust_max_n", "end_chip_max"] {
        println!("{}: {key} {:.5}, as programmed {:.5}", case.folder, most("load", key), most("baseline", key));
    }
    let peaks = |run: &str| -> Vec<f64> {
        blocks.iter().filter_map(|block| block[run]["power_max_w"].as_f64()).filter(|power_w| *power_w > 0.0).collect()
    };
    for run in ["load", "baseline"] {
        let peaks = peaks(run);
        let mean = peaks.iter().sum::<f64>() / peaks.len() as f64;
        let spread =
            libm::sqrt(peaks.iter().map(|peak| (peak - mean) * (peak - mean)).sum::<f64>() / peaks.len() as f64);
        println!(
            "{}, {run}: {} blocks, peaks of power {mean:.0} W on average, {:.2} of it deviation",
            case.folder,
            peaks.len(),
            spread / mean
        );
    }
    println!("{}: {} s, as programmed {} s", case.folder, report["cycle_time_s"], report["baseline_cycle_time_s"]);
    let power = ["load", "baseline"].map(|run| most(run, "power_max_w"));
    assert!(power[0] <= case.power_w * 1.01 && power[1] > case.power_w * 1.01, "{power:?}");
    assert!(power[0] >= 0.8 * case.power_w, "the law uses the power that there is: {power:?}");
    assert!(most("load", "end_chip_max") <= case.feed_per_tooth * 1.01);
}

#[test]
fn the_planned_passage_of_impeller_13_keeps_the_power_under_the_law() {
    let (folder, before) = ("impeller-13", "approach_feed = 2000");
    assert_governed(&Case { folder, before, power_w: 900.0, feed_per_tooth: 0.08, plunges: 4 });
}

#[test]
fn the_planned_passage_of_blisk_19_keeps_the_power_under_the_law() {
    let (folder, before) = ("blisk-19", "rev_per_min = 1600");
    // The eighth and the ninth plunge end below the flat bottoms of the first row.
    let feed_per_tooth = 0.06 / 25.4;
    assert_governed(&Case { folder, before, power_w: 300.0, feed_per_tooth, plunges: 9 });
}
