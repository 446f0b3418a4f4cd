//! `arcfeed stream --port linuxcnc:`: the same figures as on the simulated control, and what it says where LinuxCNC cannot run the program.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Command, Output, Stdio};

use arcfeed_tests::{arcfeed, run};
use libm::fabs;
use serde_json::Value;

use super::machine::Machine;
use super::slot::{Levels, job};

/// Largest chip over its target.
const OVER: f64 = 0.005;

/// Names of the table of a run, and of the outcomes of its assertions.
const TRACE: &str = "run.csv";
const OUTCOMES: &str = "outcomes.xml";

fn stream(machine: &Machine, job: &str, options: &str) -> Command {
    machine.command(&format!("exec {} stream {job} --port linuxcnc: {options}", arcfeed().display()))
}

fn refused(machine: &Machine, job: &str) -> (Option<i32>, String) {
    let Output { status, stderr, .. } = stream(machine, job, "").stdin(Stdio::null()).output().expect("it runs");
    let message = String::from_utf8_lossy(&stderr).into_owned();
    println!("{message}");
    (status.code(), message)
}

/// Does this in LinuxCNC, `c` being its command channel.
fn in_linuxcnc(machine: &Machine, python: &str) {
    let script = format!("import linuxcnc; c = linuxcnc.command(); {python}; c.wait_complete()");
    let status = machine.command(&format!("/usr/bin/python3 -c '{script}'")).status();
    assert!(status.is_ok_and(|status| status.success()), "{script}");
}

/// Runs a job; types the word that arms the component where that is requested.
fn streamed(machine: &Machine, job: &str) -> Value {
    let limits =
        format!("--assert \"chip<=1.005\" --assert \"time<=60s\" --assert \"feed<=200in/min\" --junit {OUTCOMES}");
    let mut child = stream(machine, job, &format!("--json --trace {TRACE} {limits}"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it runs");
    let (mut stdin, mut messages) = (child.stdin.take(), String::new());
    let mut lines = BufReader::new(child.stderr.take().expect("stderr")).lines().map_while(Result::ok);
    for line in &mut lines {
        if line.contains("type arm")
            && let Some(stdin) = &mut stdin
        {
            writeln!(stdin, "arm").expect("it reads");
        }
        messages += &(line + "\n");
    }
    let mut text = String::new();
    child.stdout.take().expect("stdout").read_to_string(&mut text).expect("text");
    let status = child.wait().expect("it ends");
    println!("{messages}{text}");
    assert!(status.success() && messages.contains(" 0 missing"), "{messages}");
    serde_json::from_str(&text).expect("JSON")
}

fn simulated(job: &str) -> Value {
    let output = run(&["stream", job, "--port", "sim:", "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn number(report: &Value, path: &str) -> f64 {
    report.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}: {report}"))
}

#[test]
fn streaming_to_linuxcnc_runs_the_program_and_reports_as_the_simulated_control_does() {
    let Some(mut machine) = Machine::or_skip("linuxcnc-stream") else { return };
    for mode in ["rewrite-only", "safe-base"] {
        let job = job(&machine, mode, Levels::Two);
        let [cnc, sim] = [streamed(&machine, &job), simulated(&job)];
        for path in ["/chip_load/error_ratio_max_all", "/chip_load/target", "/override/max", "/override/min"] {
            let (there, here) = (number(&cnc, path), number(&sim, path));
            println!("{mode}: {path} {there} on LinuxCNC, {here} simulated");
        }
        let most = number(&cnc, "/chip_load/error_ratio_max_all");
        assert!((-OVER..=OVER).contains(&most), "{mode}: {most}");
        assert_eq!(number(&cnc, "/chip_load/target"), number(&sim, "/chip_load/target"), "{mode}");
        assert_eq!(cnc["movements"].as_array().map(Vec::len), sim["movements"].as_array().map(Vec::len), "{mode}");
        assert!(fabs(number(&cnc, "/override/max") - number(&sim, "/override/max")) <= 1.0, "{mode}: whole percent");
        assert!(number(&cnc, "/cycle_time_s") > 5.0, "{mode}");
        check_trace(&machine, mode, &cnc);
        let outcomes = std::fs::read_to_string(machine.path(OUTCOMES)).expect("the outcomes");
        assert!(outcomes.contains("tests=\"3\" failures=\"0\" errors=\"0\""), "{mode}: {outcomes}");
    }
    check_interrupt(&machine);
    check_refusals(&mut machine);
}

/// The table of samples has the columns of the simulated control's, and the figures of the report.
fn check_trace(machine: &Machine, mode: &str, report: &Value) {
    let table = std::fs::read_to_string(machine.path(TRACE)).expect("the table");
    let mut rows = table.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let head = rows.next().expect("the names of columns");
    let names: Vec<&str> = arcfeed::trace::tables::SAMPLES.columns.iter().map(|column| column.name).collect();
    assert_eq!(head, names);
    let column = |name: &str| names.iter().position(|other| *other == name).expect("a column");
    let rows: Vec<Vec<&str>> = rows.collect();
    let value = |row: &[&str], name: &str| row[column(name)].parse::<f64>().ok();
    let is_steady = |row: &&Vec<&str>| row[column("is_steady")] == "true";
    let chips =
        rows.iter().filter(is_steady).filter_map(|row| Some((value(row, "chip_mm")?, value(row, "target_chip_mm")?)));
    let chips: Vec<f64> = chips.map(|(chip, target)| chip / target - 1.0).collect();
    let most = chips.iter().copied().fold(f64::MIN, f64::max);
    let reported = number(report, "/chip_load/error_ratio_max");
    println!(
        "{mode}: {} rows, {} steady chips, the largest {most:+.5}, reported {reported:+.5}",
        rows.len(),
        chips.len()
    );
    assert!(fabs(most - reported) < 1e-6 && chips.len() as f64 >= number(report, "/chip_load/samples"), "{mode}");
    // A row for each servo period.
    let times: Vec<f64> = rows.iter().filter_map(|row| value(row, "time_s")).collect();
    assert!(times.windows(2).all(|pair| fabs(pair[1] - pair[0] - 1e-3) < 1e-6), "{mode}: every millisecond");
    let states = rows.iter().filter(|row| row[column("state")] == "running").count();
    assert_eq!(states > 1_000, mode == "safe-base", "{mode}: {states} periods governed");
}

/// Ctrl-C: the program is paused in LinuxCNC, the axes are at rest.
fn check_interrupt(machine: &Machine) {
    let job = job(machine, "rewrite-only", Levels::Two);
    let child = stream(machine, &job, "").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
    let child = child.expect("it runs");
    std::thread::sleep(std::time::Duration::from_secs(5));
    in_linuxcnc(machine, "import os; os.system(\"pkill -INT -x arcfeed -u $(id -u)\")");
    let output = child.wait_with_output().expect("it ends");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    println!("{message}");
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.contains("the program is paused, axes at rest"), "{message}");
    // It is still in execution there, and its file stays as it is.
    let written = || std::fs::metadata(machine.path("rewrite-only.linuxcnc.ngc")).and_then(|file| file.modified());
    let before = written().expect("the program");
    let (code, message) = refused(machine, &job);
    assert_eq!(before, written().expect("the program"));
    assert!(code == Some(3) && message.contains("is executing"), "{message}");
    in_linuxcnc(machine, "c.abort()");
}

/// What a person must do first, each with its exit code.
fn check_refusals(machine: &mut Machine) {
    let job = job(machine, "rewrite-only", Levels::Two);
    let output = stream(machine, &job, "--tui").output().expect("it runs");
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    for (action, words) in [
        (
            "c.mode(linuxcnc.MODE_MANUAL); c.wait_complete(); c.teleop_enable(0); c.wait_complete(); c.unhome(0)",
            "joint 0 is not homed",
        ),
        ("c.state(linuxcnc.STATE_OFF)", "the machine is off"),
        ("c.state(linuxcnc.STATE_ESTOP)", "emergency stop"),
    ] {
        in_linuxcnc(machine, action);
        let (code, message) = refused(machine, &job);
        assert!(code == Some(3) && message.contains(words), "{words}: {message}");
    }
    machine.stop();
    let (code, message) = refused(machine, &job);
    assert!(code == Some(3) && message.contains("LinuxCNC does not run"), "{message}");
}
