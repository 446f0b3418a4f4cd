//! One program, three ways onto the line: the embedded simulator, a pseudo-terminal, and a sender that knows nothing of
//! arcfeed. Whatever the way, the control must execute the same blocks and its machine measure the same chips; only
//! what the line itself was like may differ. And a sender that is stopped, or finds no line, says what to do.
#![cfg(unix)]

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::time::Duration;

use arcfeed_tests::{Ended, Running, Scratch, root, run, wait_for};
use serde_json::Value;

const JOB: &str = "examples/ibr-slot/job.toml";
const PROGRAM: &str = "examples/ibr-slot/ibr-slot.nc";
const DC1: u8 = 0x11;
const DC3: u8 = 0x13;
/// Characters a control takes after DC3.
const AFTER_DC3_MAX: u64 = 10;
/// Reads that find nothing come back at once.
const O_NONBLOCK: i32 = if cfg!(target_os = "linux") { 0o4000 } else { 4 };
/// Figures measured on the machine, independent of the way the program arrived.
const MEASURED: [&str; 6] = ["alarms", "blocks_executed", "cycle_time_s", "chip_load", "override", "movements"];

/// The one JSON object in what a command wrote.
fn report(out: &str) -> Value {
    let line = out.lines().find(|line| line.starts_with('{')).unwrap_or_else(|| panic!("no JSON in {out:?}"));
    serde_json::from_str(line).expect("JSON")
}

fn read(path: &str) -> Vec<u8> {
    std::fs::read(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The blocks of a program, each with a line end: all lines but `%` and empty ones.
fn blocks(program: &[u8]) -> Vec<u8> {
    let lines = program.split_inclusive(|&byte| byte == b'\n');
    lines.filter(|line| !matches!(line.trim_ascii(), b"" | b"%")).flatten().copied().collect()
}

/// The program that the job sends.
fn adapted(scratch: &Scratch) -> Vec<u8> {
    let out = scratch.path("adapted.nc");
    assert!(run(&["adapt", JOB, "-o", &out]).status.success());
    read(&out)
}

/// A control on a pseudo-terminal, and the name of its line.
fn serve(scratch: &Scratch, speed: &str, baudrate: &str) -> (Running, String) {
    let executed = scratch.path("served.nc");
    let arguments =
        ["serve", JOB, "--pty", "--once", "--json", "--executed", &executed, "--speed", speed, "--baudrate", baudrate];
    let mut server = Running::start(scratch, "serve", &arguments);
    let port = server.line("port: ");
    (server, port)
}

/// Arguments that send the job to a port.
fn to_port<'a>(journal: &'a str, port: &'a str, baudrate: &'a str) -> [&'a str; 9] {
    ["stream", JOB, "--port", port, "--baudrate", baudrate, "--journal", journal, "--json"]
}

/// Report of the embedded simulator, and the executed blocks.
fn through_sim(scratch: &Scratch) -> (Value, Vec<u8>) {
    let executed = scratch.path("sim.nc");
    let output = run(&["stream", JOB, "--port", "sim:", "--executed", &executed, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    (report(&String::from_utf8(output.stdout).expect("text")), read(&executed))
}

/// Report of the machine behind a pseudo-terminal, and the executed blocks.
fn through_pty(scratch: &Scratch) -> (Value, Vec<u8>) {
    let (server, port) = serve(scratch, "10", "115200");
    let sender = Running::start(scratch, "stream", &to_port(&scratch.path("journal"), &port, "115200"));
    let sent = sender.end();
    assert_eq!(sent.code, Some(0), "{}", sent.err);
    let served = server.end();
    assert_eq!(served.code, Some(0), "{}", served.err);
    (report(&served.out), read(&scratch.path("served.nc")))
}

fn assert_flow_control_worked(report: &Value) {
    let link = &report["link"];
    println!("line: {link}");
    assert!(link["xoff_count"].as_u64() >= Some(1), "{link}");
    assert!(link["max_bytes_after_xoff"].as_u64().is_some_and(|after| after <= AFTER_DC3_MAX), "{link}");
}

/// Sends a program as any terminal program would: a few characters at a time while the control wants them.
fn send_raw(port: &str, program: &[u8]) {
    let open = OpenOptions::new().read(true).write(true).custom_flags(O_NONBLOCK).open(port);
    let mut line = open.expect("the line opens");
    let mut wanted = false;
    for characters in program.chunks(8) {
        wait_for("DC1", || {
            wanted = latest_said(&mut line).map_or(wanted, |byte| byte == DC1);
            wanted.then_some(())
        });
        line.write_all(characters).expect("the line takes what the control asked for");
        std::thread::sleep(Duration::from_micros(500));
    }
}

/// The latest DC1 or DC3 that waits to be read.
fn latest_said(line: &mut File) -> Option<u8> {
    let mut bytes = [0; 64];
    match line.read(&mut bytes) {
        Ok(len) => bytes[..len].iter().copied().rfind(|byte| matches!(*byte, DC1 | DC3)),
        Err(error) if error.kind() == ErrorKind::WouldBlock => None,
        Err(error) => panic!("the line broke: {error}"),
    }
}

fn assert_stopped(ended: &Ended) {
    assert_eq!(ended.code, Some(130), "{}", ended.err);
    assert!(ended.err.contains("stopped by the operator"), "{}", ended.err);
}

#[test]
fn sim_and_pseudo_terminal_execute_the_same_blocks_and_measure_the_same_chips() {
    let scratch = Scratch::new("same");
    let wanted = blocks(&adapted(&scratch));
    let (sim, sim_executed) = through_sim(&scratch);
    let (served, served_executed) = through_pty(&scratch);
    for (report, executed) in [(&sim, sim_executed), (&served, served_executed)] {
        assert_flow_control_worked(report);
        assert_eq!(report["link"]["starved_ms"], 0);
        assert_eq!(executed.escape_ascii().to_string(), wanted.escape_ascii().to_string());
        assert_eq!(report["blocks_executed"], wanted.split_inclusive(|&byte| byte == b'\n').count());
    }
    let measured = |mut report: Value| {
        // Only the adapted program arrives, so figures of the program before the adaptation are missing.
        for movement in report["movements"].as_array_mut().expect("movements") {
            movement.as_object_mut().expect("an object").remove("baseline_chip_load");
        }
        MEASURED.map(|field| format!("{field}: {}", report[field]))
    };
    for (sim, served) in measured(sim).iter().zip(&measured(served)) {
        assert_eq!(sim, served);
    }
}

#[test]
fn the_line_rate_does_not_change_what_is_measured() {
    let at = |baudrate: &str| {
        let output = run(&["stream", JOB, "--port", "sim:", "--baudrate", baudrate, "--json"]);
        let report = report(&String::from_utf8(output.stdout).expect("text"));
        MEASURED.map(|field| format!("{field}: {}", report[field]))
    };
    let simulated = report(&String::from_utf8(run(&["simulate", JOB, "--json"]).stdout).expect("text"));
    let from_memory = MEASURED.map(|field| format!("{field}: {}", simulated[field]));
    for baudrate in ["4800", "9600", "115200"] {
        for (found, wanted) in at(baudrate).iter().zip(&from_memory) {
            assert_eq!(found, wanted, "{baudrate} baud and from memory");
        }
    }
}

#[test]
fn a_sender_that_knows_nothing_of_arcfeed_gets_its_program_executed_as_it_is() {
    let scratch = Scratch::new("raw");
    // At 20 times, a sender that a busy computer holds up for 6 ms at every few characters never fills the buffer; at 5 times it takes 25 ms.
    let (server, port) = serve(&scratch, "5", "115200");
    let program = read(PROGRAM);
    send_raw(&port, &program);
    let served = server.end();
    assert_eq!(served.code, Some(0), "{}", served.err);
    assert_eq!(
        read(&scratch.path("served.nc")).escape_ascii().to_string(),
        blocks(&program).escape_ascii().to_string()
    );
    let report = report(&served.out);
    assert_flow_control_worked(&report);
    assert_eq!(
        (report["link"]["bytes"].as_u64(), &report["alarms"]),
        (Some(program.len() as u64), &Value::Array(vec![]))
    );
    // The program's F25 wants 160 to 300 %: the override goes for it as fast as it may, and not beyond its bound.
    let most = report["override"]["max"].as_u64().expect("the override was at work");
    assert!((150..=200).contains(&most), "{most} %");
    assert!(report["chip_load"]["error_ratio_max"].as_f64() < Some(5e-3), "{}", report["chip_load"]);
}

#[test]
fn ctrl_c_on_a_serial_line_reports_the_progress_and_asks_for_feed_hold() {
    let scratch = Scratch::new("ctrl-c");
    let program = adapted(&scratch);
    let (server, port) = serve(&scratch, "1", "9600");
    let sender = Running::start(&scratch, "stream", &to_port(&scratch.path("journal"), &port, "9600"));
    // The line needs two seconds for all of it, the machine a minute.
    std::thread::sleep(Duration::from_millis(500));
    sender.interrupt();
    let stopped = sender.end();
    assert_stopped(&stopped);
    println!("{}", stopped.err.trim_end());
    assert!(stopped.err.contains("FEED HOLD"), "{}", stopped.err);
    let sent = report(&stopped.out)["link"]["bytes"].as_u64().expect("a number") as usize;
    assert!((1..program.len()).contains(&sent), "{sent} characters sent");
    assert!(stopped.err.contains(&format!("{sent} of {} characters", program.len())), "{}", stopped.err);
    let whole = program[..sent].iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let blocks_sent = blocks(&program[..whole]).split_inclusive(|&byte| byte == b'\n').count();
    assert_eq!(report(&stopped.out)["blocks_sent"], blocks_sent);
    server.interrupt();
    assert_stopped(&server.end());
}

#[test]
fn a_control_that_waits_for_a_sender_ends_at_ctrl_c() {
    let scratch = Scratch::new("idle");
    let (server, _) = serve(&scratch, "1", "9600");
    server.interrupt();
    assert_stopped(&server.end());
}

#[test]
fn a_port_that_is_not_there_is_named_and_the_exit_code_is_3() {
    let output = run(&["stream", JOB, "--port", "/dev/no-such-line"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("/dev/no-such-line"), "{stderr}");
}

#[test]
fn a_url_that_cannot_be_read_is_a_matter_of_usage_and_names_its_part() {
    for (url, hint) in [("socket://host", "host:port"), ("spy://loop://?dev=x", "dev"), ("tcp://h:1", "socket://")] {
        let output = run(&["stream", JOB, "--port", url]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{url}: {stderr}");
        assert!(stderr.contains(hint) && stderr.contains(url), "{url}: {stderr}");
    }
    for (url, hint) in [("hwgrep://no such port", "arcfeed ports"), ("socket://127.0.0.1:1", "socket://127.0.0.1:1")] {
        let output = run(&["stream", JOB, "--port", url]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{url}: {stderr}");
        assert!(stderr.contains(hint), "{url}: {stderr}");
    }
}

#[test]
fn a_spy_around_the_simulator_sees_the_whole_program_and_changes_nothing() {
    let scratch = Scratch::new("spy-sim");
    let (plain, _) = through_sim(&scratch);
    let traffic = scratch.path("traffic");
    let output =
        run(&["stream", JOB, "--port", &format!("spy://fault://seed=1,short=0.3/sim:?raw&file={traffic}"), "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let spied = report(&String::from_utf8(output.stdout).expect("text"));
    for field in MEASURED {
        assert_eq!(spied[field], plain[field], "{field}");
    }
    let sent: Vec<u8> = read(&traffic).into_iter().filter(|byte| !matches!(*byte, DC1 | DC3)).collect();
    assert_eq!(sent.escape_ascii().to_string(), adapted(&scratch).escape_ascii().to_string());
}

#[test]
fn the_same_seed_corrupts_a_run_the_same_way_and_a_dead_line_ends_it() {
    let scratch = Scratch::new("faults");
    let corrupted = |seed: &str| {
        let executed = scratch.path("executed");
        let port = format!("fault://tx.flip=0.002,seed={seed}/sim:");
        let output = run(&["stream", JOB, "--port", &port, "--executed", &executed, "--json"]);
        (
            output.status.code(),
            report(&String::from_utf8(output.stdout).expect("text"))["alarms"].clone(),
            read(&executed),
        )
    };
    assert_eq!(corrupted("5"), corrupted("5"));
    assert_ne!(corrupted("5").2, corrupted("6").2);
    let output = run(&["stream", JOB, "--port", "fault://disconnect=500/sim:"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("disconnected after byte 500"), "{stderr}");
}

/// The example as a job of its own, with these lines about its line.
fn with_line(scratch: &Scratch, lines: &str) -> String {
    scratch.write("ibr-slot.nc", read(PROGRAM));
    let job = String::from_utf8(read(JOB)).expect("text");
    let (before, _) = job.split_once("[serial]").expect("the example names its line");
    scratch.write("job.toml", format!("{before}[serial]\n{lines}\n"))
}

#[test]
fn a_loop_without_flow_control_takes_the_whole_program() {
    let scratch = Scratch::new("loop");
    let (job, traffic) = (with_line(&scratch, "baudrate = 115200\nxonxoff = false"), scratch.path("traffic"));
    let url = format!("fault://tx.delay=30/spy://loop://?file={traffic}");
    let output = run(&["stream", &job, "--port", &url, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let program = adapted(&scratch);
    let report = report(&String::from_utf8(output.stdout).expect("text"));
    assert_eq!(report["link"]["bytes"].as_u64(), Some(program.len() as u64));
    // Also what was still under way when the sender was done.
    let dump = String::from_utf8(read(&traffic)).expect("text");
    let hex = |line: &str| line.get(22..22 + 49).expect("a line of a dump").to_owned();
    let written: Vec<String> = dump.lines().filter(|line| line.contains(" TX ")).map(hex).collect();
    let byte = |word: &str| u8::from_str_radix(word, 16).expect("a byte");
    let written: Vec<u8> = written.iter().flat_map(|hex| hex.split_whitespace()).map(byte).collect();
    assert_eq!(written.escape_ascii().to_string(), program.escape_ascii().to_string());
}

#[test]
fn a_line_that_takes_nothing_ends_in_words_after_write_timeout() {
    let scratch = Scratch::new("stuck");
    let job = with_line(&scratch, "baudrate = 115200\nxonxoff = false\nwrite_timeout = 0.3");
    let output = run(&["stream", &job, "--port", "fault://short=1/loop://"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("0.3 s") && stderr.contains("write_timeout"), "{stderr}");
}

#[test]
fn a_lost_xoff_overruns_the_control_and_is_reported_as_its_alarm() {
    let output = run(&["stream", JOB, "--port", "fault://lost_xoff=1,seed=1/sim:", "--json"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("PS0087"), "{stderr}");
}

#[test]
fn a_job_without_serial_streams_with_software_flow_control() {
    let text = String::from_utf8(read(JOB)).expect("text");
    let (text, _) = text.split_once("[serial]").expect("the table is the last one");
    let program = root().join(PROGRAM);
    let text = text.replace("\"ibr-slot.nc\"", &format!("{:?}", program.display().to_string()));
    let scratch = Scratch::new("no-serial");
    let sent = run(&["stream", &scratch.write("job.toml", text), "--port", "sim:", "--json"]);
    assert_eq!(sent.status.code(), Some(0), "{}", String::from_utf8_lossy(&sent.stderr));
    let [with, without] = [run(&["stream", JOB, "--port", "sim:", "--json"]), sent]
        .map(|sent| report(&String::from_utf8(sent.stdout).expect("text")));
    // The control waits for its first characters as long as ten bits take, not eleven.
    for figure in ["alarms", "blocks_executed", "chip_load"] {
        assert_eq!(with[figure], without[figure], "{figure}");
    }
    assert!(without["link"]["xoff_count"].as_u64() >= Some(1), "{without}");
}

#[test]
fn with_a_board_the_program_begins_when_the_override_has_risen() {
    // The first arc begins with the program: a board's override rises from 0 % at power-on.
    let least = |board: &[&str]| {
        let output = run(&[&["stream", "examples/c/job.toml", "--json"], board].concat());
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
        report["movements"][0]["override"]["min"].as_u64().expect("an override")
    };
    let [direct, linked] = [&[][..], &["--board", "sim:"]].map(least);
    println!("least override on the first arc: direct {direct} %, behind a link {linked} %");
    assert_eq!((direct, linked), (80, 80));
}
