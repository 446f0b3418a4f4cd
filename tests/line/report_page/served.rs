//! Pages that arcfeed serves, in a real browser: a transmission, and a program that is adapted.

use arcfeed_tests::{Running, Scratch, wait_for};
use serde_json::json;

use super::{has_browser, has_node, node};

const SLOT: &str = "examples/ibr-slot/job.toml";

/// A round pocket and no word about its tool.
const PROGRAM: &str =
    "%\nO1\nG21G17G90G94\nS3000M3\nN1G0X0.Y0.Z5.\nN2G1Z-2.F300.\nN3G1X10.F600.\nN4G3I-10.\nN5G0Z5.\nN6M30\n%\n";

#[test]
fn a_live_page_shows_the_machine_and_holds_resumes_and_aborts() {
    let test = "page-live";
    if !(has_node(test) && has_browser(test)) {
        return;
    }
    let scratch = Scratch::new(test);
    // Slowly, so that it lasts as long as a browser without a graphics card needs.
    let stream = Running::start(&scratch, "stream", &["stream", SLOT, "--port", "sim:", "--baudrate", "300", "--web"]);
    let url =
        wait_for("the address", || Some(stream.said().split_once("live page: ")?.1.split_once('\n')?.0.to_owned()));
    println!("{}", node(&["test/live.mjs", &url, &scratch.path("live.png")]));
    let ended = stream.end();
    assert!(ended.code == Some(130) && ended.err.contains("stopped by the operator"), "{}", ended.err);
}

#[test]
fn a_program_is_dropped_in_completed_seen_and_downloaded() {
    let test = "page-view";
    if !(has_node(test) && has_browser(test)) {
        return;
    }
    let scratch = Scratch::new(test);
    let mut view = Running::start(&scratch, "view", &["view"]);
    let url = view.line("page: ");
    let program = scratch.write("round.nc", PROGRAM);
    let facts = json!({
        "form": { "feed_per_tooth": "0.05", "milling": "climb", "mode": "rewrite-only" },
        "job": ["feed_per_tooth = 0.05", "side = \"inside\"", "program = \"round.nc\""],
        "found": "likely an end mill, diameter not in the program",
        "wrong": { "tool": "-8", "teeth": "2.5", "max": "20" },
        "answers": { "tool": "8", "teeth": "3" },
        "adapted": "round-adapted.nc",
        "job_file": "round.toml",
    });
    let facts = scratch.write("facts.json", facts.to_string());
    println!("{}", node(&["test/view.mjs", &url, &program, &facts, &scratch.path("")]));
    // By hand: 0.05 mm a tooth, 3 teeth and 3000 rev/min are 450 mm/min at the wall of radius 10 + 4 mm, and 450 * 10 / 14 at the centre.
    let adapted = std::fs::read_to_string(scratch.path("round-adapted.nc")).expect("a download");
    let feed = adapted.split_once("I-10.").and_then(|(_, rest)| rest.split_once('F')).map(|(_, rest)| rest);
    let feed: f64 = feed.and_then(|rest| rest.split(['\n', 'G']).next()?.parse().ok()).expect("an F word");
    assert!((feed - 450.0 * 10.0 / 14.0).abs() < 0.1, "{adapted}");
    view.interrupt();
    assert_eq!(view.end().code, Some(0));
}
