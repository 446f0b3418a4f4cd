//! Chips of pieces by the chip meter, with the published tool and its stock lines; the machine needs no override.

use arcfeed_tests::{Scratch, root, run};
use serde_json::Value;

/// Steady speed is known to this, and so is a measured chip.
const STEADY: f64 = 5e-3;
/// Largest deviation of a measured chip from the stated range: a tooth is not a point.
const TOOTH: f64 = 2e-4;

/// A folder's job in the mode rewrite-only.
fn job(scratch: &Scratch, folder: &str, program: &str) -> String {
    let text = |file: &str| std::fs::read_to_string(root().join(folder).join(file)).expect("the folder is there");
    scratch.write(program, text(program));
    let old = text("job.toml").replace("mode = \"safe-base\"", "mode = \"rewrite-only\"");
    let added = "[override]\nmode = \"rewrite-only\"\n[control]";
    let job = if old.contains("rewrite-only") { old } else { old.replace("[control]", added) };
    assert!(job.contains("rewrite-only"));
    scratch.write("job.toml", job)
}

fn objects(arguments: &[&str]) -> Vec<Value> {
    let output = run(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("JSON is text");
    text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect()
}

fn number(value: &Value, field: &str) -> f64 {
    value[field].as_f64().unwrap_or_else(|| panic!("no {field} in {value}"))
}

#[test]
fn the_chip_is_measured_within_the_stated_error_with_the_override_at_100() {
    for (folder, program) in [("examples/ibr-slot", "ibr-slot.nc"), ("tests/cases/table-5-4", "program.nc")] {
        let scratch = Scratch::new(&format!("measured-{program}"));
        let job = job(&scratch, folder, program);
        let blocks = objects(&["adapt", &job]);
        let report = &objects(&["simulate", &job])[0];
        for movement in report["movements"].as_array().expect("a list") {
            let mine = |block: &&Value| {
                block["reason"] == "law"
                    && ["rotation", "direction", "side"].iter().all(|field| block[*field] == movement[*field])
            };
            let said = |field: &'static str| blocks.iter().filter(mine).map(move |block| number(block, field));
            let least = said("chip_error_min").fold(f64::INFINITY, f64::min);
            let most = said("chip_error_max").fold(f64::NEG_INFINITY, f64::max);
            let measured = ["error_ratio_min", "error_ratio_max"].map(|field| number(&movement["chip_load"], field));
            println!(
                "{program}, movement {}: said {least:+.4} .. {most:+.4}, measured {measured:+.4?}",
                movement["rule"]
            );
            assert!(measured[0] >= least - TOOTH && measured[1] <= most + TOOTH, "{movement}");
            assert!(measured[0] <= least + STEADY && measured[1] >= most - STEADY, "{movement}");
            assert_eq!(movement["arcs"], blocks.iter().filter(mine).count());
            let set = [number(&movement["override"], "min"), number(&movement["override"], "max")];
            assert_eq!((set, number(&movement["override"], "changes")), ([100.0; 2], 0.0));
        }
    }
}

#[test]
fn over_a_line_the_same_is_measured() {
    let scratch = Scratch::new("measured-stream");
    let job = job(&scratch, "examples/ibr-slot", "ibr-slot.nc");
    let [simulated, streamed] =
        [vec!["simulate", &job], vec!["stream", &job]].map(|arguments| objects(&arguments).remove(0));
    assert_eq!(streamed["blocks_sent"], streamed["blocks_executed"]);
    assert_eq!(streamed["link"]["starved_ms"], 0);
    for field in ["chip_load", "movements", "override", "cycle_time_s"] {
        assert_eq!(streamed[field], simulated[field], "{field}");
    }
}

#[test]
fn the_settings_trade_chip_error_for_f_words() {
    let scratch = Scratch::new("settings");
    let path = job(&scratch, "examples/ibr-slot", "ibr-slot.nc");
    let text = std::fs::read_to_string(&path).expect("just written");
    let figures = |settings: &str| {
        let mode = "mode = \"rewrite-only\"\n";
        let job = scratch.write("other.toml", text.replace(mode, &format!("{mode}{settings}\n")));
        let blocks = objects(&["adapt", &job]);
        let law = || blocks.iter().filter(|block| block["reason"] == "law");
        let pieces: f64 = law().map(|block| number(block, "pieces")).sum();
        let most = law().map(|block| number(block, "pieces")).fold(0.0, f64::max);
        let mean = law().map(|block| number(block, "chip_error_mean")).sum::<f64>() / law().count() as f64;
        println!("{settings}: {pieces} pieces, at most {most} an arc, chips {:+.2} % off on average", 1e2 * mean);
        (pieces, most, mean)
    };
    let fine = figures("piece_step = 0.5\npiece_hysteresis = 0\npiece_length = \"1 mm\"");
    let default = figures("");
    let coarse = figures("piece_step = 5\npiece_hysteresis = 5");
    let few = figures("pieces_max = 2");
    let one = figures("pieces_max = 1");
    assert!(fine.0 > 2.0 * default.0 && default.0 > 1.5 * coarse.0 && coarse.0 > one.0 && few.1 == 2.0);
    assert!(fine.2 > default.2 && default.2 > coarse.2 && coarse.2 > one.2 && few.2 > one.2);
    assert_eq!((one.0, one.1, figures("piece_length = 100").0), (20.0, 1.0, 20.0));
}
