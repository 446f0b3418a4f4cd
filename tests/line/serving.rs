//! `arcfeed serve` as the plain control of any sender: without a job, over TCP and on a pseudo-terminal, in each code,
//! with its switches; and what a sender sees of an alarm.
#![cfg(unix)]

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::Duration;

use arcfeed_control::code::TapeCode;
use arcfeed_tests::{Ended, Running, Scratch, run, wait_for};
use serde_json::{Value, json};

const DC1: u8 = 0x11;
const DC3: u8 = 0x13;
const PROGRAM: &str = "%\nO7(PLAIN)\nG21G1X1.F6000\n/X9.\nN30X2.\nM1\nX3.\nM30\n%\n";

/// A control on a TCP port, and a sender's connection to it.
fn serve(scratch: &Scratch, flags: &[&str]) -> (Running, TcpStream) {
    let executed = scratch.path("executed.nc");
    let fixed = ["serve", "--tcp", "127.0.0.1:0", "--once", "--json", "--executed", &executed, "--speed", "50"];
    let mut server = Running::start(scratch, "serve", &[&fixed[..], &["--baudrate", "115200"], flags].concat());
    let address = server.line("port: socket://");
    let line = TcpStream::connect(address).expect("the control listens");
    line.set_nonblocking(true).expect("a socket can be");
    (server, line)
}

/// Waits for DC1, then sends everything.
fn send(line: &mut TcpStream, bytes: &[u8]) {
    wait_for("DC1", || says(line).contains(&DC1).then_some(()));
    line.write_all(bytes).expect("the control takes it");
}

/// Characters that the control has sent since the last call.
fn says(line: &mut TcpStream) -> Vec<u8> {
    let mut bytes = [0; 64];
    match line.read(&mut bytes) {
        Ok(len) => bytes[..len].to_vec(),
        Err(error) if error.kind() == ErrorKind::WouldBlock => Vec::new(),
        Err(error) => panic!("the line broke: {error}"),
    }
}

fn executed(scratch: &Scratch) -> Vec<String> {
    let text = std::fs::read_to_string(scratch.path("executed.nc")).expect("the blocks were written");
    text.lines().map(str::to_owned).collect()
}

fn report(ended: &Ended) -> Value {
    let line = ended.out.lines().find(|line| line.starts_with('{')).unwrap_or_else(|| panic!("no JSON: {ended:?}"));
    serde_json::from_str(line).expect("JSON")
}

fn assert_alarm(ended: &Ended, number: u64) {
    assert_eq!((ended.code, &report(ended)["alarms"][0]["alarm"]), (Some(3), &Value::from(number)), "{ended:?}");
    assert!(ended.err.contains(&format!("PS{number:04}")), "{}", ended.err);
}

#[test]
fn a_plain_control_executes_a_program_as_it_is() {
    let scratch = Scratch::new("plain");
    let (server, mut line) = serve(&scratch, &[]);
    send(&mut line, PROGRAM.as_bytes());
    let ended = server.end();
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    let wanted: Vec<&str> = PROGRAM.lines().filter(|line| *line != "%").collect();
    assert_eq!(executed(&scratch), wanted);
    // The override is at 100 %: nothing drives it.
    assert_eq!((&report(&ended)["override"], &report(&ended)["alarms"]), (&Value::Null, &Value::Array(vec![])));
}

#[test]
fn the_switches_are_flags() {
    let scratch = Scratch::new("switches");
    let (server, mut line) = serve(&scratch, &["--block-delete", "1", "--optional-stop", "--restart-at", "30"]);
    send(&mut line, PROGRAM.as_bytes());
    let ended = server.end();
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    assert_eq!(executed(&scratch), ["N30X2.", "M1", "X3.", "M30"]);
    // The simulated operator waits a second at M01.
    assert!(report(&ended)["cycle_time_s"].as_f64() > Some(1.0), "{}", report(&ended));
    assert_eq!(report(&ended)["restart"]["feed"], 6000.0);
}

#[test]
fn a_contour_is_offset_by_the_radius_of_the_settings_and_stops_where_the_tool_does_not_fit() {
    let run = |radius: &str, moves: &str| {
        let scratch = Scratch::new(&format!("contour-{radius}-{}", moves.len()));
        let settings = scratch.write("machine.toml", format!("unit = 'mm'\n[radius]\n1 = {radius}\n"));
        let (server, mut line) = serve(&scratch, &["--settings", &settings]);
        send(&mut line, format!("%\nG0X-10.Y0\n{moves}M30\n%\n").as_bytes());
        (server.end(), executed(&scratch).len())
    };
    let contour = "G41D1G1X0F6000\nX20.\nG3X25.Y5.J5.\nG1Y20.\nG40X0\n";
    let by_hand = "G1X0Y4.F6000\nX20.\nG3X21.Y5.J1.\nG1Y20.\nX0\n";
    let times = [contour, by_hand].map(|moves| {
        let (ended, blocks) = run("4.0", moves);
        assert_eq!((ended.code, blocks), (Some(0), 7), "{}", ended.err);
        report(&ended)["cycle_time_s"].clone()
    });
    assert_eq!(times[0], times[1]);
    let (ended, blocks) = run("6.0", contour);
    assert_alarm(&ended, 41);
    assert_eq!((blocks, &report(&ended)["alarms"][0]["line"]), (3, &5.into()), "{}", report(&ended));
}

#[test]
fn restart_in_a_cycle_lists_omitted_functions_and_drills_at_the_offset_holes() {
    let scratch = Scratch::new("restart");
    let settings = scratch.write("machine.toml", "unit = 'mm'\n[work]\nG54 = { X = 100.0 }\n[length]\n1 = 50.0\n");
    let (server, mut line) = serve(&scratch, &["--settings", &settings, "--restart-at", "50"]);
    let program = "%\nT3M6\nS900M3\nG54G0X0Y0\nG43H1Z20.M8\nG99G81X10.Z-5.R2.F300\nN50X20.\nG80G28Z20.\nM30\n%\n";
    send(&mut line, program.as_bytes());
    let ended = server.end();
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    assert_eq!(executed(&scratch), ["N50X20.", "G80G28Z20.", "M30"]);
    let restart = &report(&ended)["restart"];
    assert_eq!((&restart["t"], &restart["s"], &restart["feed"]), (&3.into(), &900.into(), &300.0.into()));
    assert_eq!(restart["m"], Value::from(vec![6, 3, 8]));
    let codes = ["G81", "G17", "G90", "G94", "G21", "G40", "G99", "G43 H1", "G54"];
    assert_eq!(restart["g"], Value::from(codes.to_vec()));
    // X to 110, Z to 52 at the dry run feed; 10 mm over, 7 down and up; 18 up and 70 on by way of Z20.
    let time_s = |mm: f64, speed: f64| {
        if mm * 500.0 < speed * speed { 2.0 * libm::sqrt(mm / 500.0) } else { mm / speed + speed / 500.0 }
    };
    let dry = 2_000.0 / 60.0;
    let kept = 2.0 * 5.0 / 500.0 - 25.0 / (500.0 * dry);
    let rapids: f64 = [10.0, 7.0, 18.0, 70.0].map(|mm| time_s(mm, 200.0)).iter().sum();
    let wanted_s = time_s(110.0, dry) + time_s(52.0, dry) - kept + time_s(7.0, 5.0) + rapids;
    let took_s = report(&ended)["cycle_time_s"].as_f64().expect("a time");
    assert!((took_s - wanted_s).abs() < 0.01, "{took_s} s, by hand {wanted_s} s");
}

#[test]
fn each_control_takes_iso_and_eia_from_a_sender_that_makes_its_own_parity() {
    for (control, word, code) in [
        ("fanuc-16i", "iso", TapeCode::Iso),
        ("fanuc-0i", "eia", TapeCode::Eia),
        ("fanuc-31i", "ascii", TapeCode::Ascii),
    ] {
        let scratch = Scratch::new(word);
        let (server, mut line) = serve(&scratch, &["--code", word, "--control", control]);
        let frames: Vec<u8> = PROGRAM.bytes().map(|byte| code.encode(byte).expect("in every code")).collect();
        send(&mut line, &frames);
        let ended = server.end();
        assert_eq!(ended.code, Some(0), "{control}: {}", ended.err);
        assert_eq!(executed(&scratch).len(), 7);
    }
}

#[test]
fn a_sender_without_parity_gets_an_alarm_and_may_finish_sending() {
    let scratch = Scratch::new("parity");
    let (server, mut line) = serve(&scratch, &["--code", "iso"]);
    send(&mut line, PROGRAM.as_bytes());
    // DC3 comes as 0x93 to a receiver that takes eight bits.
    wait_for("DC3", || says(&mut line).iter().any(|byte| byte & 0x7F == DC3).then_some(()));
    for _ in 0..20 {
        line.write_all(b"G1X1.\n").expect("the port stays open until the sender stops");
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_alarm(&server.end(), 1);
}

#[test]
fn checks_of_the_tape_are_flags() {
    for (flag, block, number) in [("--tv-check", "G1X1.", 2), ("--strict", "(lower case)", 1)] {
        let scratch = Scratch::new(flag);
        let (server, mut line) = serve(&scratch, &[flag]);
        // G90 and its end: 4. G1X1. and its end: 6, made odd by a blank.
        let odd = if number == 2 { " " } else { "" };
        send(&mut line, format!("%\nG90\n{block}{odd}\nM30\n%\n").as_bytes());
        assert_alarm(&server.end(), number);
    }
}

#[test]
fn a_sender_that_hangs_up_is_alarm_86() {
    let scratch = Scratch::new("hang-up");
    let (server, mut line) = serve(&scratch, &[]);
    send(&mut line, b"%\nG90\n");
    drop(line);
    assert_alarm(&server.end(), 86);
}

#[test]
fn macros_call_programs_of_the_library_and_print_to_the_sender() {
    let scratch = Scratch::new("macros");
    scratch.write("O9010.nc", "O9010\n#100=#24*2\nDPRNT[X#100[33]]\n#3006=1(LOOK)\nM99\n");
    let (server, mut line) = serve(&scratch, &["--library", &scratch.path("")]);
    send(&mut line, b"%\nG21\nPOPEN\nG65P9010X1.5\nPCLOS\nG0X#100\nM30\n%\n");
    let mut heard = Vec::new();
    wait_for("DC4", || {
        heard.extend(says(&mut line));
        heard.contains(&0x14).then_some(())
    });
    let ended = server.end();
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    heard.retain(|byte| !matches!(*byte, DC1 | DC3));
    assert_eq!(heard, b"\x12X   3.000\n\x14");
    let report = report(&ended);
    assert_eq!((&report["print_output"], &report["messages"]), (&json!(["X   3.000"]), &json!(["LOOK"])));
    assert_eq!(executed(&scratch), ["G21", "POPEN", "G65P9010X1.5", "O9010", "(LOOK)", "PCLOS", "G0X3.", "M30"]);
}

#[test]
fn text_printed_by_the_control_is_in_the_senders_report() {
    let scratch = Scratch::new("printed");
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    let control = std::thread::spawn(move || {
        let (mut line, _) = listener.accept().expect("a sender");
        line.write_all(&[DC1]).expect("the line is up");
        line.read_exact(&mut [0]).expect("the sender has begun");
        line.write_all(b"\x12X  1.500\nY  2.000\n\x14").expect("the line is up");
        let _until_it_hangs_up = line.read_to_end(&mut Vec::new());
    });
    let job = "examples/ibr-slot/job.toml";
    let (port, journal) = (format!("socket://{address}"), scratch.path("journal"));
    let stream = ["stream", job, "--port", &port, "--json", "--baudrate", "115200", "--journal", &journal];
    let ended = Running::start(&scratch, "stream", &stream).end();
    control.join().expect("the control");
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    assert_eq!(report(&ended)["print_output"], json!(["X  1.500", "Y  2.000"]));
}

#[test]
fn a_command_line_without_sense_is_explained() {
    for (arguments, word) in [
        (&["serve"][..], "--pty"),
        (&["serve", "--pty", "--tcp", "127.0.0.1:0"], "--tcp"),
        (&["serve", "--pty", "--control", "fanuc-6"], "fanuc-31i"),
        (&["serve", "--pty", "--block-delete", "10"], "1..=9"),
    ] {
        let output = run(arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains(word), "{stderr}");
    }
    let output = run(&["serve", "--pty", "--library", "no/such/folder"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("no/such/folder") && stderr.contains("--library"), "{stderr}");
    let output = run(&["serve", "--tcp", "203.0.113.1:1", "--allow-remote"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("203.0.113.1:1") && stderr.contains("free port"), "{stderr}");
}
