//! The report of a run in a real browser, and the viewer's bundle against its sources.
//!
//! `host/web/test/page.mjs` drives the browser. The facts that it looks for come from closed forms of the program and from the figures of
//! `simulate --json`, which do not go through the page.

mod in_page;

mod moments;

mod planned;

pub mod scale;

mod served;

use std::path::{Path, PathBuf};
use std::process::Command;

use arcfeed_tests::{Scratch, root, run, skip_loudly};
use miniz_oxide::inflate::decompress_to_vec_zlib;
use serde_json::{Value, json};

/// Folder of the viewer.
const WEB: &str = "host/web";

/// Browsers, the one that takes the least processor time first.
const BROWSERS: [&str; 4] =
    ["/usr/bin/chromium-headless-shell", "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

const POCKET: &str = "examples/pocket/job-contour.toml";

/// A slot by a mill of R 5 mm, with forces and a limit of the spindle.
const SLOT: &str = "%\nG21G17G90G94\nN1G0X0.Y0.\nN2G0Z5.\nN3G1Z-4.F400.\nN4G1X20.F600.\nN5G0Z5.\nN6M30\n%\n";
const SLOT_JOB: &str = "units = \"mm\"\nprogram = \"program.nc\"\n\
    [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 30\n\
    [spindle]\nrev_per_min = 3000\nmax_power = \"200 W\"\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n\
    [workpiece]\nblock = { from = [-10, -10, -12], to = [40, 10, 0] }\nstep = 0.5\n\
    [cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 4\n";

/// Whether Node has the viewer's packages; says loudly if not.
fn has_node(test: &str) -> bool {
    let node = Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success());
    let found = node && root().join(WEB).join("node_modules/esbuild").exists();
    if !found {
        skip_loudly(test, "no Node with the packages of host/web (`cargo xtask test` installs them)");
    }
    found
}

fn has_browser(test: &str) -> bool {
    let found = BROWSERS.iter().any(|path| Path::new(path).exists());
    if !found {
        skip_loudly(test, "no Chromium (`cargo xtask test` installs it)");
    }
    found
}

/// Output of a script of the viewer, which succeeds.
#[track_caller]
fn node(arguments: &[&str]) -> String {
    let output = Command::new("node").args(arguments).current_dir(root().join(WEB)).output().expect("Node starts");
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(output.status.success(), "{arguments:?}\n{out}{err}");
    out
}

/// Runs a job by a command, and looks for the facts in its page.
#[track_caller]
fn check(test: &str, [command, job]: [&str; 2], facts: impl Fn(&Value) -> Value) {
    if !(has_node(test) && has_browser(test)) {
        return;
    }
    let scratch = Scratch::new(test);
    let page = scratch.path("run.html");
    let output = run(&[command, job, "--json", "--report", &page]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("one object");
    let mut facts = facts(&report);
    facts["cycle_time_s"] = report["cycle_time_s"].clone();
    let facts = scratch.write("facts.json", facts.to_string());
    println!("{}", node(&["test/page.mjs", &page, &facts]));
}

/// Largest measured chip load over its target, of the run or of the original program.
fn largest_chip(report: &Value) -> f64 {
    let ratio = |key: &str| 1.0 + report[key]["error_ratio_max_all"].as_f64().expect("a ratio");
    ratio("chip_load").max(ratio("baseline_chip_load"))
}

#[test]
fn a_report_opens_from_disk_and_shows_one_moment_in_path_curves_and_text() {
    check("page-pocket", ["simulate", POCKET], pocket_facts);
}

#[test]
fn a_run_over_the_simulated_line_has_the_same_viewer() {
    check("page-stream", ["stream", POCKET], pocket_facts);
    let scratch = Scratch::new("page-serial");
    let output = run(&["stream", POCKET, "--port", "loop://", "--report", &scratch.path("run.html")]);
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && words.contains("--report: a control on a serial line"), "{words}");
    assert!(scratch.files().is_empty());
}

#[test]
fn adapt_writes_the_report_that_simulate_writes_and_its_own_output() {
    let scratch = Scratch::new("page-adapt");
    let [adapted, simulated, program] = ["adapted.html", "simulated.html", "out.nc"].map(|name| scratch.path(name));
    for arguments in [
        ["adapt", POCKET, "-o", &program, "--report", &adapted].as_slice(),
        &["simulate", POCKET, "--report", &simulated],
    ] {
        assert_eq!(run(arguments).status.code(), Some(0), "{arguments:?}");
    }
    let data = |path: &str| {
        let html = std::fs::read_to_string(path).expect("a page");
        let (_, data) = html.split_once("id=\"arcfeed-data\">").expect("its data");
        data.split_once("</script>").expect("their end").0.to_owned()
    };
    assert!(data(&adapted).len() > 1_000 && data(&adapted) == data(&simulated));
    assert!(std::fs::read_to_string(&program).expect("the program").contains("N160G3X42.Y30.I-3.J.0F1200."));
}

/// Facts of the pocket. N160 is a corner of the contour's radius 8 mm, on which the centre of the mill of R 5 mm runs on 3 mm: the programmed
/// feed at the contour is 8/3 of the wanted one.
fn pocket_facts(report: &Value) -> Value {
    json!({
        "curves": 2,
        "tables": ["feed per tooth at the contour", "Along time", "Feed at the contour over its target along the path, after", "Governed moves: 6, of which 5 slowed, 0 raised."],
        "largest": [["contour", largest_chip(report), 2e-3]],
        "chip_head": "At contour / target",
        // A corner keeps 3/8 of its feed, the slot 25/30; nothing is raised.
        "feed_ratio": [3.0 / 8.0, 1.0],
        "find": "N160G3",
        "line": 15,
        "place": { "center": [42, 27], "radius": 3, "Z": -5, "tolerance": 6e-3 },
        "chip": { "before": 8.0 / 3.0, "after": 1.0 },
        "pixel": 0.6,
        "pixel_s": 0.03,
        // Before the adaptation: the four corners, which have the same radius, and the slot.
        "findings": 2,
    })
}

#[test]
fn a_report_shows_the_ring_its_removal_rate_and_the_remaining_stock() {
    // N144: about the centre that I and J give from the end of N142.
    check("page-ring", ["simulate", "examples/ibr-slot/job.toml"], |report| {
        json!({
            "curves": 4,
            "tables": ["Heights, seen along Z", "removal rate, in3/min"],
            "largest": [["chip", largest_chip(report), 2e-3]],
            "find": "N144G3",
            "line": 19,
            "place": { "center": [0.2495, 8.3369], "radius": 4.43706, "Z": -27.5688, "tolerance": 4e-4 },
            "pixel": 0.02,
            "pixel_s": 0.15,
            "findings": 0,
        })
    });
}

#[test]
fn a_report_shows_forces_and_leads_to_each_block_above_a_limit() {
    let scratch = Scratch::new("page-slot-job");
    scratch.write("program.nc", SLOT);
    let job = scratch.write("job.toml", SLOT_JOB);
    check("page-slot", ["simulate", &job], |report| {
        let [load, power] = [&report["loads"]["load"], &report["spindle"]["power"]];
        let above = ["above", "baseline_above"].map(|key| power[key].as_array().expect("a list").len());
        assert!(above[0] > 0, "{power}");
        json!({
            "curves": 4,
            "tables": ["Chips and forces", "power above the spindle's"],
            "largest": [["force", load["force_max_n"], 0.5]],
            "find": "N4G1",
            "line": 6,
            "place": { "Y": 0, "Z": -4, "tolerance": 1e-3 },
            // Parts of the picture's width and height, away from the path; parts of the run with the tool on its way along X.
            "stock": { "at": [[0.25, 0.3], [0.7, 0.75]], "moments": [0.55, 0.85] },
            "pixel": 0.2,
            "pixel_s": 0.02,
            "findings": above[0] + above[1],
        })
    });
}

#[test]
fn the_bundle_is_that_of_its_sources() {
    let test = "bundle";
    if !has_node(test) {
        return;
    }
    let scratch = Scratch::new(test);
    node(&["build.mjs", &scratch.path("built")]);
    node(&["node_modules/typescript/bin/tsc", "--noEmit"]);
    // Other versions of Node compress into other bytes.
    let text = |path: PathBuf| {
        let bytes = std::fs::read(&path).expect("a file");
        let is_compressed = path.extension().is_some_and(|extension| extension == "zlib");
        let bytes = if is_compressed { decompress_to_vec_zlib(&bytes).expect("compressed") } else { bytes };
        String::from_utf8(bytes).expect("text")
    };
    let kept = |file: &str| text(root().join(WEB).join(file));
    for file in ["viewer.js.zlib", "viewer.css", "start.js"] {
        let built = text(PathBuf::from(scratch.path(&format!("built/{file}"))));
        assert!(built == kept(file), "{WEB}/{file} is not built from its sources: `npm ci && npm run build` there");
    }
    assert!(!kept("viewer.js.zlib").contains("</script"), "the bundle would end its own element");
}
