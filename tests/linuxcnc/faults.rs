//! Faults and the operator's actions while the component has the feed: the chip is never above its target.

use std::fs;

use arcfeed_link::message::prepared::seal;
use serde_json::{Value, json};

use super::machine::Machine;
use super::run::{INCH_MM, Ran, Run};
use super::slot::{Levels, job};

/// Component's states.
const RUNNING: i64 = 2;
const FAULTED: i64 = 5;
/// Largest chip over its target.
const OVER: f64 = 0.005;

/// Largest chip of a run over its target.
fn largest_chip(machine: &Machine, job: &str, name: &str, ran: &Ran) -> f64 {
    let figures = machine.measure(job, &ran.samples, INCH_MM);
    let most = figures["chip_load"]["error_ratio_max_all"].as_f64().expect("a figure");
    println!(
        "{name}: largest chip {most:+.4} over its target, {} samples in the cut, states {:?}, ended {}",
        figures["chip_load"]["samples"],
        ran.states(),
        ran.last("ended")
    );
    most
}

/// Events of each fault and action, once the second arc is in execution, and those that remove the fault.
fn faults(cut: &Value) -> Vec<(&'static str, Value)> {
    let after = |seconds: f64| json!({ "after": seconds });
    let idle = json!({ "idle": true });
    vec![
        ("feed hold and resume", json!([[cut, "pause"], [after(1.0), "resume"]])),
        (
            "dial to 50, 120 and 200 %",
            json!([[cut, "dial", 0.5], [after(1.0), "dial", 1.2], [after(1.0), "dial", 2.0]]),
        ),
        (
            "user-space half frozen",
            json!([[cut, "freeze", "arcfeed-program"], [after(3.0), "abort"], [after(0.3), "thaw", "arcfeed-program"]]),
        ),
        ("disarmed by the operator", json!([[cut, "press", "arcfeed.disarm"], [after(1.5), "abort"]])),
        ("abort in the cut", json!([[cut, "abort"]])),
        (
            "component no longer called",
            json!([
                [cut, "halcmd", "delf", "arcfeed", "servo-thread"],
                [after(1.5), "abort"],
                [idle, "halcmd", "addf", "arcfeed", "servo-thread", "2"],
                // The watchdog begins again when the machine is switched on.
                [after(0.3), "power"],
            ]),
        ),
    ]
}

#[test]
fn no_fault_and_no_action_of_the_operator_puts_the_chip_above_its_target() {
    let Some(machine) = Machine::or_skip("linuxcnc-faults") else { return };
    let job = job(&machine, "safe-base", Levels::Two);
    machine.adapt(&job);
    let cut = json!({ "line": machine.arc_line(1) });
    let armed = |events: Value| Run { events, ..Run::whole(true) };
    for (name, events) in faults(&cut) {
        let ran = machine.run(&armed(events));
        assert!(ran.states().contains(&RUNNING), "{name}: governed before the fault");
        assert!(largest_chip(&machine, &job, name, &ran) <= OVER, "{name}");
    }
    check_restart(&machine, &job);
    check_single_block(&machine, &job);
    check_wrong_radius(&machine, &job);
    let unloaded = machine.run(&armed(json!([[cut, "halcmd", "unloadrt", "arcfeed"], [{ "after": 1.5 }, "abort"]])));
    assert!(largest_chip(&machine, &job, "component unloaded", &unloaded) <= OVER);
}

/// A program that begins again behind the arc where it was aborted: the line in between is not governed, the arcs behind it are.
fn check_restart(machine: &Machine, job: &str) {
    let between = machine.arc_line(1) + 1;
    machine.run(&Run { events: json!([[{ "line": machine.arc_line(1) }, "abort"]]), ..Run::whole(true) });
    // LinuxCNC starts no spindle of the lines before.
    let ran = machine.run(&Run { mdi: "S1000 M3", line: between, ..Run::whole(true) });
    let most = largest_chip(machine, job, "restart in the middle", &ran);
    assert!((-OVER..=OVER).contains(&most), "the arcs behind the restart are governed: {most}");
    let is_full = |sample: &&super::run::Sample| sample.line == between as i64 && sample.ratio > 1.0 + 1e-9;
    assert_eq!(ran.samples.iter().filter(is_full).count(), 0, "100 % at most on the way to them");
}

/// Single block: a stop at the end of each block.
fn check_single_block(machine: &Machine, job: &str) {
    let ran = machine.run(&Run { steps: machine.arc_line(3), ..Run::whole(true) });
    let most = largest_chip(machine, job, "single block", &ran);
    assert!((-OVER..=OVER).contains(&most) && ran.last("ended") == "true", "{most}");
}

/// Moves for the component from arcs of another radius, with the checksums of the program: it is not governed where they differ.
fn check_wrong_radius(machine: &Machine, job: &str) {
    // The arc of N146 about centres that are 0.02, 0.1 and 0.5 in farther from its start and its end, and 0.5 in nearer.
    for center in ["I4.0537J-3.0648", "I4.1102J-3.1215", "I4.3916J-3.4057", "I3.6880J-2.6951"] {
        check_center(machine, job, center);
    }
    machine.adapt(job);
}

fn check_center(machine: &Machine, job: &str, center: &str) {
    machine.adapt(job);
    let [program, prepared] = ["program.ngc", "program.ngc.arcfeed"].map(|file| machine.path(file));
    let (text, header) = (fs::read(&program).expect("the program"), fs::read(&prepared).expect("its moves"));
    let nc = fs::read_to_string(machine.path("ibr-slot.nc")).expect("the program");
    let other = nc.replace("I4.0398J-3.0504", center);
    assert_ne!(nc, other);
    fs::write(machine.path("ibr-slot.nc"), other).expect("a file");
    machine.adapt(job);
    let mut moves = fs::read(&prepared).expect("moves");
    moves.truncate(moves.len() - 4);
    moves[8..16].copy_from_slice(&header[8..16]);
    moves.extend(seal(&moves));
    for (file, bytes) in [(machine.path("ibr-slot.nc"), nc.into_bytes()), (program, text), (prepared, moves)] {
        fs::write(file, bytes).expect("a file");
    }
    // Until the arc is over.
    let events = json!([[{ "line": machine.arc_line(2) }, "abort"]]);
    let ran = machine.run(&Run { events, ..Run::whole(true) });
    assert_ne!(ran.reports[0]["moves"], "0", "the moves are in force: {:?}", ran.reports[0]);
    let of_arc = ran.samples.iter().filter(|sample| sample.line == machine.arc_line(1) as i64);
    println!("{center}: largest feed over F on its arc {:.3}", of_arc.map(|sample| sample.ratio).fold(0.0, f64::max));
    assert!(largest_chip(machine, job, "moves of another radius", &ran) <= OVER);
}

#[test]
fn a_program_other_than_the_prepared_one_is_not_governed() {
    let Some(machine) = Machine::or_skip("linuxcnc-other-program") else { return };
    machine.adapt(&job(&machine, "safe-base", Levels::Two));
    let program = machine.path("program.ngc");
    let text = fs::read_to_string(&program).expect("the program");
    fs::write(&program, text.replace("O1546", "O1547")).expect("a file");
    let ran = machine.run(&Run { events: json!([[{ "after": 3 }, "abort"]]), ..Run::whole(true) });
    assert_eq!(ran.reports[0]["moves"], "0", "no moves are in force");
    assert!(ran.samples.iter().all(|sample| sample.ratio <= 1.0 + 1e-9), "100 %");
    let states = ran.states();
    assert!(!states.iter().any(|state| (1..=4).contains(state) || *state == FAULTED), "{states:?}");
}
