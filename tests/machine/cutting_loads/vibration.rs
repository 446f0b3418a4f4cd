//! A flexible tool: which slots chatter, by the command's own verdict.

use crate::cutting_loads::slot_job::{PUBLISHED, Slot, number, simulation_report};

/// Flexible along the slot.
const ALONG: Slot<'_> = Slot {
    cutting: "cutting = [600, 200, 0]\nedge = [0, 0, 0]\n\
        modes = [{ frequency = 922, damping = 0.011, stiffness = 1340.05, direction = [1, 0, 0] }]\n",
    ..PUBLISHED
};

#[test]
fn a_slot_below_the_limit_is_steady() {
    let report = ALONG.simulation_report("steady");
    let vibration = &report["loads"]["vibration"];
    println!("{vibration}");
    assert_eq!(number(vibration, "/judged_blocks"), 1.0);
    assert!(number(vibration, "/metric_max") < 0.2 * number(vibration, "/floor"));
    assert_eq!([&vibration["unstable"], &vibration["baseline_unstable"]], [&serde_json::json!([]); 2]);
}

#[test]
fn springing_back_from_a_ramp_is_no_chatter() {
    // The end of a single tooth bends the tool by some hundredths of a millimetre. What is left of that after a window of 32 turns is less than the floor.
    let slot = Slot {
        teeth: 1,
        cutting: "cutting = [600, 200, 0]\nedge = [0, 0, 0]\n\
            modes = [{ frequency = 60, damping = 0.019, stiffness = 1e4, direction = [1, 0, 0] }]\n",
        ..PUBLISHED
    };
    let (job, _) = slot.texts();
    // 50 turns down, 150 on the level.
    let program = "%\nG21G17G90G94\nN1G0X0Y0\nN2G0Z5.\nN3G1Z0.F400.\nN4G1X1.Z-.3F100.\nN5G1X4.\nN6G0Z5.\nN7M30\n%\n";
    let report = simulation_report("ramp", &job, program);
    let vibration = &report["loads"]["vibration"];
    println!("{vibration}");
    assert_eq!([&vibration["unstable"], &vibration["baseline_unstable"]], [&serde_json::json!([]); 2]);
}

#[test]
fn a_slot_above_it_chatters() {
    let report = Slot { axial_depth_mm: 0.6, ..ALONG }.simulation_report("chatter");
    let vibration = &report["loads"]["vibration"];
    println!("{vibration}");
    for which in ["unstable", "baseline_unstable"] {
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
    let report = PUBLISHED.simulation_report("rigid");
    assert!(report["loads"]["vibration"].is_null());
}
