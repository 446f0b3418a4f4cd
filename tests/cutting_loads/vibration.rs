//! A tool that gives way: which slots chatter, by the command's own verdict.

use crate::story::{Slot, number};

/// Set A of the published benchmarks along X: at 5000 rev/min a slot of 0.409 mm is at its limit.
const MODES: &str = "cutting = [600, 200, 0]\nedge = [0, 0, 0]\n\
    modes = [{ frequency = 922, damping = 0.011, stiffness = 1340.05, direction = [1, 0, 0] }]\n";

/// So large that its teeth go in circles, as those of the theory do.
const SLOT: Slot<'_> = Slot {
    diameter_mm: 100.0,
    teeth: 2,
    rev_per_min: 5000.0,
    feed_mm_per_tooth: 0.02,
    axial_depth_mm: 0.3,
    way_mm: 4.0,
    cutting: MODES,
};

#[test]
fn a_slot_below_the_limit_is_steady() {
    let report = SLOT.told("steady");
    let vibration = &report["loads"]["vibration"];
    println!("{vibration}");
    assert_eq!(number(vibration, "/judged"), 1.0);
    assert!(number(vibration, "/metric_max") < 0.2 * number(vibration, "/floor"));
    assert_eq!([&vibration["unsteady"], &vibration["baseline_unsteady"]], [&serde_json::json!([]); 2]);
}

#[test]
fn a_slot_above_it_chatters() {
    let report = Slot { axial_depth_mm: 0.6, ..SLOT }.told("chatter");
    let vibration = &report["loads"]["vibration"];
    println!("{vibration}");
    for which in ["unsteady", "baseline_unsteady"] {
        assert_eq!(vibration[which].as_array().map(Vec::len), Some(1));
        assert_eq!(
            [&vibration[which][0]["verdict"], &vibration[which][0]["n"]],
            [&serde_json::json!("chatter"), &serde_json::json!(4)]
        );
    }
    assert!(number(vibration, "/metric_max") > number(vibration, "/floor"));
}

#[test]
fn a_rigid_tool_is_not_judged() {
    let report = Slot { cutting: "cutting = [600, 200, 0]\nedge = [0, 0, 0]\n", ..SLOT }.told("rigid");
    assert!(report["loads"]["vibration"].is_null());
}
