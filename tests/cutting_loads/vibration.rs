//! A tool that gives way: which slots chatter, by the command's own verdict.

use crate::story::{PUBLISHED, Slot, number};

/// It gives way along the slot.
const ALONG: Slot<'_> = Slot {
    cutting: "cutting = [600, 200, 0]\nedge = [0, 0, 0]\n\
        modes = [{ frequency = 922, damping = 0.011, stiffness = 1340.05, direction = [1, 0, 0] }]\n",
    ..PUBLISHED
};

#[test]
fn a_slot_below_the_limit_is_steady() {
    let report = ALONG.told("steady");
    let vibration = &report["loads"]["vibration"];
    println!("{vibration}");
    assert_eq!(number(vibration, "/judged"), 1.0);
    assert!(number(vibration, "/metric_max") < 0.2 * number(vibration, "/floor"));
    assert_eq!([&vibration["unsteady"], &vibration["baseline_unsteady"]], [&serde_json::json!([]); 2]);
}

#[test]
fn a_slot_above_it_chatters() {
    let report = Slot { axial_depth_mm: 0.6, ..ALONG }.told("chatter");
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
    let report = PUBLISHED.told("rigid");
    assert!(report["loads"]["vibration"].is_null());
}
