//! Faults and the operator's actions while the component has the feed: the chip is never above its target.

use serde_json::{Value, json};

use super::machine::{INCH_MM, Machine, Ran};
use super::slot::job;

/// Component's state after a fault.
const FAULTED: i64 = 5;

/// Runs the slot with the component and these events; the largest chip over its target, and the run.
fn with(machine: &Machine, events: Value) -> (f64, Ran) {
    let job = job(machine, "safe-base");
    machine.adapt(&job);
    let ran = machine.run(true, events.clone());
    let figures = machine.measure(&job, &ran.samples, INCH_MM);
    let most = figures["chip_load"]["error_ratio_max_all"].as_f64().expect("a figure");
    println!(
        "{events}: largest chip {most:+.4} over its target, {} samples in the cut",
        figures["chip_load"]["samples"]
    );
    (most, ran)
}

fn states(ran: &Ran) -> Vec<i64> {
    let mut states: Vec<i64> = ran.samples.iter().map(|sample| sample.state).collect();
    states.dedup();
    states
}

#[test]
fn no_fault_and_no_action_of_the_operator_puts_the_chip_above_its_target() {
    let Some(machine) = Machine::or_skip("linuxcnc-faults") else { return };
    // The first arc begins 12.6 s after the start, the second runs from 13.5 to 15.4 s.
    for (name, events) in [
        ("feed hold and resume", json!([[14.5, "pause"], [15.5, "resume"]])),
        ("user-space half frozen", json!([[14.5, "kill", "arcfeed-program"]])),
        ("component no longer called", json!([[14.5, "halcmd", "delf", "arcfeed", "servo-thread"], [17, "abort"]])),
        ("disarmed by the operator", json!([[14.5, "press", "arcfeed.disarm"]])),
        ("abort in the cut", json!([[16.5, "abort"]])),
    ] {
        let (most, ran) = with(&machine, events);
        println!("{name}: states {:?}, ended {}", states(&ran), ran.last("ended"));
        assert!(most <= 0.005, "{name}: {most}");
    }
}

#[test]
fn a_program_other_than_the_prepared_one_is_not_governed() {
    let Some(machine) = Machine::or_skip("linuxcnc-other-program") else { return };
    machine.adapt(&job(&machine, "safe-base"));
    let program = machine.path("program.ngc");
    let text = std::fs::read_to_string(&program).expect("the program");
    std::fs::write(&program, text.replace("O1546", "O1547")).expect("a file");
    let ran = machine.run(true, json!([[3, "abort"]]));
    assert_eq!(ran.reports[0]["moves"], "0", "no moves are in force");
    assert!(ran.samples.iter().all(|sample| sample.ratio <= 1.0 + 1e-9), "100 %");
    assert!(!states(&ran).iter().any(|state| (1..=4).contains(state) || *state == FAULTED), "{:?}", states(&ran));
}
