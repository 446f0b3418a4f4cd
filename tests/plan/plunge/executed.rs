//! The program of a plan as controls execute it: the simulated one, in process and over a line, and LinuxCNC's interpreter.

use std::process::Command;

use arcfeed_tests::{Scratch, object, of_full_set, run, skip_loudly};
use serde_json::Value;

/// Last decimal that rs274 prints, in the unit of the program and in degrees.
const PRINTED: f64 = 1e-4;

/// Program up to the end of its first passage, with its last lines.
pub fn first_passage(program: &str) -> String {
    let (from, _) = program.split_once("(PASSAGE 2 OF").expect("passages");
    let end = program.rfind("M9").and_then(|at| program[..at].rfind('\n')).expect("an end");
    from.to_owned() + program[end..].trim_start()
}

/// Ends of the moves of a program by its words: X, Y, Z, A and B, up to the way home.
fn ends(program: &str) -> Vec<[f64; 5]> {
    let (mut state, mut ends) = ([f64::NAN; 5], Vec::new());
    for line in program.lines().take_while(|line| !line.contains("G91")).filter(|line| line.starts_with('N')) {
        let before = state;
        for (letter, number) in super::command::words(line) {
            if let Some(axis) = "XYZAB".find(letter) {
                state[axis] = number;
            }
        }
        if state[..3].iter().zip(&before).any(|(now, then)| now != then) && !state[2].is_nan() {
            ends.push(state);
        }
    }
    ends
}

/// The same as rs274 reads them.
fn ends_by_rs274(folder: &Scratch, program: &str) -> Option<Vec<[f64; 5]>> {
    folder.write("p.ngc", program);
    folder.write("t.tbl", "T1 P1 D0.0\n");
    folder.write("v.var", "");
    // rs274 keeps its tool table in the user's home.
    let home = folder.path("");
    let arguments = ["60", "rs274", "-t", "t.tbl", "-v", "v.var", "-g", "p.ngc"];
    Command::new("rs274").arg("-h").output().ok()?;
    let output = Command::new("timeout").args(arguments).current_dir(&home).env("HOME", &home).output().ok()?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains("PROGRAM_END"), "{}", String::from_utf8_lossy(&output.stderr));
    let end = |line: &str| -> Option<[f64; 5]> {
        let (_, rest) = line.split_once("STRAIGHT_FEED(").or(line.split_once("STRAIGHT_TRAVERSE("))?;
        let numbers: Vec<f64> =
            rest.trim_end_matches(')').split(',').filter_map(|part| part.trim().parse().ok()).collect();
        numbers[..5].try_into().ok()
    };
    Some(said.lines().filter_map(end).collect())
}

/// Moves of the plan's program, adapted for LinuxCNC, as its interpreter makes them; a rapid of the first place has no Z yet.
pub fn assert_read_by_rs274(folder: &str, name: &str) {
    let scratch = Scratch::new(&format!("plunge-rs274-{name}"));
    let [job, adapted] = [format!("{folder}/rewritten.toml"), scratch.path("linuxcnc.ngc")];
    let text = std::fs::read_to_string(format!("{folder}/job.toml")).expect("a job");
    std::fs::write(&job, text.replace("[law]", "[override]\nmode = \"rewrite-only\"\n\n[law]")).expect("a job");
    let output = run(&["adapt", &job, "--for", "linuxcnc", "-o", &adapted]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let expected = ends(&std::fs::read_to_string(format!("{folder}/{name}.nc")).expect("a program"));
    let Some(found) = ends_by_rs274(&scratch, &std::fs::read_to_string(&adapted).expect("a program")) else {
        return skip_loudly("assert_read_by_rs274", "there is no rs274 of LinuxCNC (Debian's package linuxcnc-uspace)");
    };
    // The first move stands at Z0 there.
    let found = &found[1..];
    let off = |found: &[f64; 5], end: &[f64; 5]| (0..5).map(|axis| (found[axis] - end[axis]).abs()).fold(0.0, f64::max);
    let worst = found.iter().zip(&expected).map(|(found, end)| off(found, end)).fold(0.0, f64::max);
    println!("{name}: {} moves as rs274 reads them, off by {worst:.5} at most", expected.len());
    assert!(found.len() >= expected.len() && expected.len() > 500 && worst <= PRINTED);
}

/// Job with rays three times as far apart: what the control does with the program does not depend on them.
fn with_coarse_rays(job: &str) -> String {
    let (before, rest) = job.split_once("\nstep = ").expect("a workpiece");
    let (step, after) = rest.split_once('\n').expect("a line");
    let step: f64 = step.parse().expect("a number");
    format!("{before}\nstep = {}\n{after}", 3.0 * step)
}

/// A run of the program in process and one over a DNC line execute the same blocks without an alarm.
pub fn assert_streamed(folder: &str, name: &str) {
    let program = format!("{folder}/{name}.nc");
    let text = std::fs::read_to_string(&program).expect("a program");
    std::fs::write(&program, of_full_set(text.clone(), first_passage(&text))).expect("it was just read");
    let job = format!("{folder}/coarse.toml");
    let fine = std::fs::read_to_string(format!("{folder}/job.toml")).expect("a job");
    std::fs::write(&job, with_coarse_rays(&fine)).expect("a job");
    let journal = format!("{folder}/journal");
    let simulated = object(&["simulate", &job]);
    let streamed = object(&["stream", &job, "--port", "sim:", "--journal", &journal]);
    println!("{name}: {} blocks, {} s", streamed["blocks_executed"], streamed["cycle_time_s"]);
    for report in [&simulated, &streamed] {
        assert_eq!(report["alarms"], Value::Array(Vec::new()));
    }
    assert_eq!(streamed["blocks_executed"], simulated["blocks_executed"]);
    std::fs::write(&program, text).expect("it was just written");
}
