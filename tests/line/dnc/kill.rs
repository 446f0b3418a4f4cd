//! The same with processes: `arcfeed stream` is killed (-9) while it sends to `arcfeed serve`, and resumed.

use arcfeed_tests::{Ended, Running, Scratch, of_full_set, root, run, wait_for};
use fastrand::Rng;
use serde_json::Value;

const EXAMPLE: &str = "examples/ibr-slot";

/// A copy of the example; its job.
pub fn job(scratch: &Scratch) -> String {
    for file in ["ibr-slot.nc", "job.toml"] {
        scratch.write(file, std::fs::read(root().join(EXAMPLE).join(file)).expect("the example is there"));
    }
    scratch.path("job.toml")
}

/// A control that listens; it ends in alarm PS0086 when its sender goes.
fn serve(scratch: &Scratch, name: &str, job: &str) -> (Running, String) {
    let executed = scratch.path(&format!("{name}.nc"));
    let arguments =
        ["serve", job, "--tcp", "127.0.0.1:0", "--once", "--json", "--executed", &executed, "--speed", "100"];
    let mut server = Running::start(scratch, name, &arguments);
    let port = server.line("port: ");
    (server, port)
}

/// The lines of a file.
pub fn lines(scratch: &Scratch, file: &str) -> Vec<String> {
    let text = std::fs::read_to_string(scratch.path(file)).unwrap_or_default();
    text.lines().map(str::to_owned).collect()
}

fn report(ended: &Ended) -> Value {
    let line = ended.out.lines().find(|line| line.starts_with('{')).unwrap_or_else(|| panic!("no JSON: {ended:?}"));
    serde_json::from_str(line).expect("JSON")
}

/// Kills a sender after so many records of its journal; answers what its control had executed and received.
fn killed(scratch: &Scratch, job: &str, records: usize) -> (Vec<String>, u64) {
    let (server, port) = serve(scratch, "first", job);
    let mut sender = Running::start(scratch, "stream", &["stream", job, "--port", &port, "--baudrate", "9600"]);
    wait_for("records of the journal", || {
        let journal = std::fs::read_to_string(scratch.path("job.journal")).unwrap_or_default();
        (journal.matches(" out ").count() >= records).then_some(())
    });
    sender.kill();
    drop(sender);
    let ended = server.end();
    let bytes = report(&ended)["link"]["bytes"].as_u64().expect("a number");
    (lines(scratch, "first.nc"), bytes)
}

#[test]
fn a_killed_sender_is_resumed_only_where_and_when_somebody_says_so() {
    let (cases, mut resumed_cases) = (of_full_set(200, 2), 0);
    for seed in 0..3 * cases {
        if resumed_cases == cases {
            break;
        }
        let scratch = Scratch::new(&format!("kill-{seed}"));
        let job = job(&scratch);
        let records = Rng::with_seed(seed).usize(3..11);
        let (executed, bytes) = killed(&scratch, &job, records);
        if executed.len() < 2 {
            continue;
        }
        let adapted = scratch.path("adapted.nc");
        assert!(run(&["adapt", &job, "-o", &adapted]).status.success());
        let program = lines(&scratch, "adapted.nc");
        // The operator reads at the control the block in which it stopped.
        let under_way = executed.last().expect("it had begun");
        let line = 1 + program.iter().position(|line| line == under_way).expect("a block of the program");
        let resume = |port: &str, more: &[&str]| {
            run(&[
                &["stream", &job, "--port", port, "--baudrate", "9600", "--resume", "--clearance", "0", "--json"][..],
                more,
            ]
            .concat())
        };
        let from = line.to_string();
        let said = |output: &std::process::Output| String::from_utf8_lossy(&output.stderr).into_owned();
        let blind = resume("socket://127.0.0.1:1", &[]);
        assert!(blind.status.code() == Some(1) && said(&blind).contains("--from"), "{}", said(&blind));
        let unasked = resume("socket://127.0.0.1:1", &["--from", &from]);
        assert!(unasked.status.code() == Some(4) && said(&unasked).contains("--approve"), "{}", said(&unasked));
        let plan: Value = serde_json::from_slice(&unasked.stdout).expect("the plan");
        let plan = &plan["resume"];
        let number = |value: &Value| value.as_u64().expect("a number") as usize;
        // Characters up to this line have arrived: the journal knows a range around it.
        let arrived = 1 + std::fs::read(&adapted).expect("adapted")[..bytes as usize]
            .iter()
            .filter(|byte| **byte == b'\n')
            .count();
        let [low, high] = [0, 1].map(|end| number(&plan["sent"][end]));
        assert!((low..=high).contains(&arrived), "{arrived} in {plan}");
        let (server, port) = serve(&scratch, "second", &job);
        let resumed = resume(&port, &["--from", &from, "--approve"]);
        assert_eq!(resumed.status.code(), Some(0), "{}", said(&resumed));
        let served = server.end();
        assert_eq!(served.code, Some(0), "{}", served.err);
        let blocks: Vec<&str> = plan["blocks"].as_array().expect("blocks").iter().filter_map(Value::as_str).collect();
        let rest = program[line - 1..].iter().map(String::as_str).filter(|line| *line != "%");
        let wanted: Vec<&str> = blocks[1..].iter().copied().chain(rest).collect();
        assert_eq!(lines(&scratch, "second.nc"), wanted, "seed {seed}");
        resumed_cases += 1;
    }
    assert_eq!(resumed_cases, cases, "killed processes taken up; the others before anything was executed");
}

#[test]
fn a_changed_program_or_job_is_not_resumed() {
    let scratch = Scratch::new("changed");
    let job = job(&scratch);
    let journal = scratch.path("sent.journal");
    let cut = ["stream", &job, "--port", "fault://disconnect=700/sim:", "--journal", &journal];
    let output = run(&cut);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(3) && stderr.contains("--resume"), "{stderr}");
    let resume = || run(&["stream", &job, "--resume", "--journal", &journal, "--from", "20", "--approve"]);
    for (file, old, new, what) in [
        ("ibr-slot.nc", "M30\n", "M30\n\n", "the program's file"),
        ("job.toml", "feed_per_tooth = 0.004", "feed_per_tooth = 0.003", "what the job"),
    ] {
        let as_it_was = std::fs::read_to_string(scratch.path(file)).expect("text");
        scratch.write(file, as_it_was.replace(old, new));
        let output = resume();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(1) && stderr.contains(what), "{stderr}");
        scratch.write(file, as_it_was);
    }
    let output = resume();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = String::from_utf8_lossy(&output.stdout).into_owned();
    for words in ["(RESUME AT LINE 20)", "tool 14", "RESET", "are cut again if they were executed"] {
        assert!(shown.contains(words), "{words}: {shown}");
    }
}

#[test]
fn restart_after_an_alarm_needs_no_line_if_the_control_reports_it() {
    let scratch = Scratch::new("stands");
    let job = job(&scratch);
    // A character without its parity bit is alarm PS0001 in a control that checks; here a letter becomes another.
    let journal = scratch.path("sent.journal");
    let corrupted = ["stream", &job, "--port", "fault://tx.flip=0.002,seed=5/sim:", "--journal", &journal];
    let output = run(&corrupted);
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
    let output = run(&["stream", &job, "--resume", "--journal", &journal, "--json"]);
    assert_eq!(output.status.code(), Some(4), "{}", String::from_utf8_lossy(&output.stderr));
    let plan: Value = serde_json::from_slice(&output.stdout).expect("the plan");
    let plan = &plan["resume"];
    assert_eq!((&plan["stopped"], &plan["line"]), (&Value::Bool(true), &plan["executed"]));
    assert_eq!(
        (&plan["possibly_repeated"]["count"], &plan["possibly_skipped"]["count"], &plan["skipped"]["count"]),
        (&0.into(), &0.into(), &0.into())
    );
}
