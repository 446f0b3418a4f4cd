//! The reports of plans in a real browser.

use arcfeed_tests::{Scratch, run};
use serde_json::{Value, json};

use super::{has_browser, has_node, node};

/// Plans a part, and looks for the facts that follow from its figures on the page.
fn check(test: &str, [command, part]: [&str; 2], facts: impl FnOnce(&Value) -> Value) {
    if !(has_node(test) && has_browser(test)) {
        return;
    }
    let scratch = Scratch::new(test);
    let output = run(&["plan", command, part, "--json", "--output", &scratch.path("plan")]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let figures: Value = serde_json::from_slice(&output.stdout).expect("one object");
    let mut facts = facts(&figures);
    facts["clearances"] = figures["clearances"].clone();
    let facts = scratch.write("facts.json", facts.to_string());
    println!("{}", node(&["test/plan.mjs", &scratch.path("plan/report.html"), &facts, &scratch.path("plan.png")]));
}

#[test]
fn the_report_of_a_plan_shows_the_slot_and_leads_to_its_closest_places() {
    check("page-plan", ["cup-mill", "examples/blisk-19/PART.toml"], |figures| {
        // A level has a turn about A or about B1 away from the base position, or both: the first one has that about B1.
        let levels = figures["levels"].as_array().expect("a list").len();
        json!({ "turns": levels, "find": "level 2: movement 2, about A" })
    });
}

#[test]
fn the_report_of_plunges_leads_to_the_closest_places_of_the_tilted_mill() {
    check("page-plunge", ["plunge", "examples/impeller-13/PART.toml"], |figures| {
        let plunges = figures["plunges"].as_u64().expect("a number");
        json!({ "turns": 0, "find": format!("plunge {plunges}, radial: plunge") })
    });
}

#[test]
fn the_report_of_finishing_passes_leads_to_the_closest_places_on_the_blade() {
    check(
        "page-finish",
        ["finish", "examples/finish-blisk/PART.toml"],
        |_| json!({ "find": "move 100: cut", "move_mm": 1.5 }),
    );
}

#[test]
fn the_report_of_a_repair_shows_the_maps_of_its_allowance_on_the_blade() {
    check("page-repair", ["repair", "examples/repaired-blade/REPAIR.toml"], |_| {
        let maps = [
            "Allowance before",
            "Allowance planned",
            "Depth to be taken",
            "Predicted result above the planned allowance",
        ];
        json!({ "find": "move 100: cut", "move_mm": 1.5, "surfaces": maps.map(|map| format!("{map}, mm")) })
    });
}
