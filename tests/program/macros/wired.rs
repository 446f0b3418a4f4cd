//! Macro programs where users meet them: the control in software, `check`, and the commands that refuse them.

use arcfeed_control::{Control, ControlSettings};
use arcfeed_tests::{Scratch, root, run};
use arcfeed_units::{LengthUnit, Micros};
use serde_json::Value;

use crate::macros::run::corpus;

const STEP: Micros = Micros::from_ms(1);

fn execute(text: &str) -> Control {
    let mut control = Control::from_memory(ControlSettings::fanuc_16i(LengthUnit::Mm), text.as_bytes());
    for ms in 1..200_000 {
        control.step(Micros::from_ms(ms), STEP, 100);
        if control.is_over() {
            return control;
        }
    }
    panic!("the program does not end: {:?}", control.position());
}

#[test]
fn the_control_mills_a_thread_from_its_memory() {
    let control = execute(&corpus("thread-mill.nc"));
    assert!(control.has_ended() && control.alarm().is_none(), "{:?}", control.alarm());
    assert_eq!(control.position().linear.map(|axis| axis.to_mm()), [0.0, 0.0, 2.0 - 6.0 * 2.5]);
}

#[test]
fn the_control_stops_with_the_alarm_of_a_macro_in_its_line() {
    let control = execute("O1\nG0X1.\nG65P2A0\nM30\nO2\nG0X[1/#1]\nM99\n");
    let alarm = control.alarm().expect("an alarm");
    assert_eq!((alarm.line, alarm.fault.column), (6, 6));
    assert!(alarm.fault.cause.to_string().starts_with("PS0112"));
    assert_eq!(control.position().linear[0].to_mm(), 1.0);
}

#[test]
fn the_control_punches_and_waits_with_a_message() {
    let control = execute(&corpus("probing.nc"));
    assert!(control.has_ended(), "{:?}", control.alarm());
    assert_eq!(control.output().iter().filter(|byte| **byte == b'\n').count(), 3);
    assert_eq!(control.messages().collect::<Vec<_>>(), ["CHECK THE BORE"]);
}

#[test]
fn a_program_waits_for_the_clock_of_the_control() {
    let mut control =
        Control::from_memory(ControlSettings::fanuc_16i(LengthUnit::Mm), b"#3001=0\nWHILE[#3001LT500]DO1\nEND1\nM30\n");
    let ended = (1..2_000).find(|ms| {
        control.step(Micros::from_ms(*ms), STEP, 100);
        control.is_over()
    });
    assert!(ended.is_some_and(|ms| (500..=510).contains(&ms)), "{ended:?} {:?}", control.alarm());
}

#[test]
fn check_interprets_the_corpus_and_counts_the_moves_made() {
    let mut seen = 0;
    for entry in std::fs::read_dir(root().join("tests/corpus/macro")).expect("a corpus") {
        let path = entry.expect("an entry").path();
        let output = run(&["check", "--json", path.to_str().expect("ASCII")]);
        let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
        // The root of a vacant variable: Newton divides by zero.
        let is_newton = path.ends_with("newton.nc");
        assert_eq!(
            report["errors"].as_array().map(Vec::len),
            Some(usize::from(is_newton)),
            "{}: {report}",
            path.display()
        );
        if path.ends_with("thread-mill.nc") {
            let counts = &report["counts"];
            assert_eq!([&counts["helices"], &counts["linear"], &counts["rapids"]], [6, 1, 2], "{counts}");
        }
        seen += 1;
    }
    assert_eq!(seen, 5);
}

#[test]
fn check_names_the_place_in_the_main_program_and_in_the_library() {
    let scratch = Scratch::new("macro-library");
    let main = scratch.write("main.nc", "O1\nG0X1.\nG65P9010A0\nM30\n");
    scratch.write("O9010.nc", "O9010\n#2=3/#1\nM99\n");
    let output = run(&["check", &main, "--library", &scratch.path("")]);
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.starts_with(&format!("{main}:3:1: error PS0112: in ")), "{stderr}");
    assert!(stderr.contains("O9010.nc:2:5: "), "{stderr}");
    let without = String::from_utf8(run(&["check", &main]).stderr).expect("UTF-8");
    assert!(without.starts_with(&format!("{main}:3:4: error PS0078: ")), "{without}");
}

#[test]
fn check_misses_the_end_of_a_program_that_has_none() {
    let scratch = Scratch::new("macro-no-end");
    for (text, place) in [
        ("%\nO1\nG0X1.\n%\n", Some("4:1")),
        ("O1\n#1=1\nG0X#1", Some("3:1")),
        ("O1\nG65P2\nM30\nO2\nG0X1.", Some("5:1")),
        ("%\nO1\nG0X1.M2\n%\n", None),
        ("O1\nG0X1.\nM99\n", None),
        ("O1\n#1=2\nIF[#1GT1]GOTO9\nN9G0X1.M30\n", None),
    ] {
        let main = scratch.write("main.nc", text);
        let stderr = String::from_utf8(run(&["check", &main]).stderr).expect("UTF-8");
        let wanted = place.map(|place| format!("{main}:{place}: error PS5010: "));
        assert_eq!(wanted.is_some(), stderr.contains("PS5010"), "{text}: {stderr}");
        assert!(wanted.is_none_or(|wanted| stderr.starts_with(&wanted)), "{text}: {stderr}");
    }
}

#[test]
fn check_knows_the_offsets_of_its_settings_and_of_g10_as_variables() {
    let scratch = Scratch::new("macro-offsets");
    let settings = scratch.write("settings.toml", "unit = 'mm'\n[work]\nG54 = { X = -300.0 }\n[length]\n7 = 120.5\n");
    let main = scratch.write(
        "main.nc",
        "O1\nG10L2P2Y-8.\nG10L13P4R0.25\nIF[#5221NE-300]THEN#3000=1\nIF[#2207NE120.5]THEN#3000=2\n\
         IF[#5242NE-8]THEN#3000=3\nIF[#12004NE0.25]THEN#3000=4\n#2207=#2207+1\nIF[#11007NE121.5]THEN#3000=5\nM30\n",
    );
    let output = run(&["check", &main, "--settings", &settings]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn an_error_in_a_loop_is_reported_once() {
    let scratch = Scratch::new("macro-once");
    let main = scratch.write("main.nc", "#1=0\nWHILE[#1LT9]DO1\n#1=#1+1\nG2X#1\nEND1\n#2=1/0\nM30\n");
    let stderr = String::from_utf8(run(&["check", &main]).stderr).expect("UTF-8");
    let places: Vec<&str> = stderr.lines().filter(|line| line.contains(": error")).collect();
    assert_eq!(places.len(), 2, "{stderr}");
    assert!(places[0].contains(":4:1: error PS0022") && places[1].contains(":6:5: error PS0112"), "{stderr}");
}

/// The example, with these statements before N144.
fn example_with(scratch: &Scratch, statements: &str) -> String {
    let example =
        |file: &str| std::fs::read_to_string(root().join("examples/ibr-slot").join(file)).expect("the example");
    scratch.write("ibr-slot.nc", example("ibr-slot.nc").replacen("N144", &format!("{statements}N144"), 1));
    scratch.write("job.toml", example("job.toml"))
}

#[test]
fn a_counter_that_only_the_control_knows_is_refused_by_every_command_with_a_job() {
    let scratch = Scratch::new("macro-unset");
    let job = example_with(&scratch, "#100=#100+1\n");
    for command in ["adapt", "stream", "simulate"] {
        let output = run(&[command, &job]);
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(1), "{command}: {stderr}");
        let place = format!("{}:19:6: error: the value of #100 here", scratch.path("ibr-slot.nc"));
        assert!(stderr.starts_with(&place), "{command}: {stderr}");
    }
}

#[test]
fn statements_change_nothing_in_how_the_example_is_adapted() {
    let scratch = Scratch::new("macro-adapt");
    let statements = "#100=1\n#100=#100+1\n";
    let adapted = |statements: &str| {
        let (job, out) = (example_with(&scratch, statements), scratch.path("out.nc"));
        let output = run(&["adapt", &job, "-o", &out]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read_to_string(out).expect("the adapted program")
    };
    let plain = adapted("");
    assert_eq!(adapted(statements), plain.replacen("N144", &format!("{statements}N144"), 1));
}
