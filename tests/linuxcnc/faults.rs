//! Faults and the operator's actions while the component has the feed: the chip is never above its target.

use serde_json::{Value, json};

use super::machine::{INCH_MM, Machine, Ran};
use super::slot::job;

/// Component's state after a fault.
const FAULTED: i64 = 5;

/// Runs the slot with the component and these events, once the second arc is in execution; the largest chip over its
/// target, and the run.
fn with(machine: &Machine, events: impl Fn(Value) -> Value) -> (f64, Ran) {
    let job = job(machine, "safe-base");
    machine.adapt(&job);
    let events = events(json!({ "line": machine.arc_line(1) }));
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
    let after = |seconds: f64| json!({ "after": seconds });
    let run = |events: &dyn Fn(Value) -> Value| with(&machine, events);
    for (name, (most, ran)) in [
        ("feed hold and resume", run(&|cut| json!([[cut, "pause"], [after(1.0), "resume"]]))),
        ("user-space half frozen", run(&|cut| json!([[cut, "kill", "arcfeed-program"]]))),
        (
            "component no longer called",
            run(&|cut| json!([[cut, "halcmd", "delf", "arcfeed", "servo-thread"], [after(2.5), "abort"]])),
        ),
        ("disarmed by the operator", run(&|cut| json!([[cut, "press", "arcfeed.disarm"]]))),
        ("abort in the cut", run(&|cut| json!([[cut, "abort"]]))),
    ] {
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
    let ran = machine.run(true, json!([[{ "after": 3 }, "abort"]]));
    assert_eq!(ran.reports[0]["moves"], "0", "no moves are in force");
    assert!(ran.samples.iter().all(|sample| sample.ratio <= 1.0 + 1e-9), "100 %");
    assert!(!states(&ran).iter().any(|state| (1..=4).contains(state) || *state == FAULTED), "{:?}", states(&ran));
}
