//! The report of a planned slot in a real browser.

use arcfeed_tests::{Scratch, run};
use serde_json::{Value, json};

use super::{has_browser, has_node, node};

#[test]
fn the_report_of_a_plan_shows_the_slot_and_leads_to_its_closest_places() {
    let test = "page-plan";
    if !(has_node(test) && has_browser(test)) {
        return;
    }
    let scratch = Scratch::new(test);
    let output = run(&["plan", "cup-mill", "examples/blisk-19/PART.toml", "--json", "--output", &scratch.path("plan")]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let figures: Value = serde_json::from_slice(&output.stdout).expect("one object");
    // A level has a turn about A or about B1 away from the base position, or both: the first one has that about B1.
    let levels = figures["levels"].as_array().expect("a list").len();
    let facts = json!({ "clearances": figures["clearances"], "turns": levels });
    let facts = scratch.write("facts.json", facts.to_string());
    println!("{}", node(&["test/plan.mjs", &scratch.path("plan/report.html"), &facts, &scratch.path("plan.png")]));
}
