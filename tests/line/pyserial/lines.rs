//! Bytes through pyserial: its RFC 2217 server, its `socket://`.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

use arcfeed::job::{Parity, SerialSettings};
use arcfeed::port::open::open;
use arcfeed::port::{Port, PortError};
use arcfeed_tests::{Ended, Running, Scratch, run, wait_for};
use arcfeed_units::Micros;

use arcfeed_tests::python::{Script, python_or_skip};

const JOB: &str = "examples/ibr-slot/job.toml";
/// 9600 7E2.
const SETTINGS: SerialSettings = SerialSettings {
    baudrate: 9_600,
    bytesize: 7,
    parity: Parity::Even,
    stopbits: 2,
    xonxoff: true,
    rtscts: false,
    write_timeout: None,
    exclusive: true,
};

fn opened(url: &str) -> Result<Box<dyn Port>, PortError> {
    open(&url.parse().expect("a URL"), &SETTINGS)
}

/// Writes all and reads as much back.
fn back(port: &mut dyn Port, sent: &[u8]) -> Vec<u8> {
    let (mut left, mut back, mut buffer) = (sent, Vec::new(), [0; 512]);
    let started = Instant::now();
    while back.len() < sent.len() {
        assert!(started.elapsed() < Duration::from_secs(30), "{} of {} bytes came back", back.len(), sent.len());
        let taken = port.write(&left[..left.len().min(100)]).expect("the line stays");
        left = &left[taken..];
        let len = port.read(&mut buffer).expect("the line stays");
        back.extend(&buffer[..len]);
        port.wait(port.now().after(Micros::from_ms(1)));
    }
    back
}

/// Every byte, many times.
fn every_byte() -> Vec<u8> {
    (0..20_000_u32).map(|at| (at * 7 / 3) as u8).chain([0xff; 300]).collect()
}

#[test]
fn pyserials_rfc2217_server_takes_our_settings_and_gives_every_byte_back() {
    let Some(python) = python_or_skip("rfc2217 bytes") else { return };
    let scratch = Scratch::new("rfc2217");
    let server = Script::start(python, "rfc2217_server.py", &["loop://"], &scratch.path("out"));
    let started = Instant::now();
    let url = format!("rfc2217://127.0.0.1:{}?logging=info&poll_modem", server.line("port: "));
    let mut port = opened(&url).expect("the server agrees");
    println!("open after {:?}", started.elapsed());
    let sent = every_byte();
    assert_eq!(back(&mut *port, &sent), sent);
    let settings = server.printed();
    assert_eq!(settings.lines().last(), Some("settings: 9600 7E2 xonxoff=0 rtscts=0"), "{settings}");
    drop(port);
    let server = Script::start(python, "rfc2217_server.py", &["loop://"], &scratch.path("out"));
    let hardware = SerialSettings { xonxoff: false, rtscts: true, ..SETTINGS };
    let url = format!("rfc2217://127.0.0.1:{}", server.line("port: "));
    let port = open(&url.parse().expect("a URL"), &hardware).expect("the server agrees");
    assert_eq!(server.line("settings: 9600 7E2 xonxoff=0 rtscts=1"), "");
    drop(port);
}

#[test]
fn a_rate_that_pyserials_server_refuses_is_named() {
    let Some(python) = python_or_skip("rfc2217 refusal") else { return };
    let scratch = Scratch::new("refuse");
    let server = Script::start(python, "rfc2217_server.py", &["loop://", "refuse-baudrate"], &scratch.path("out"));
    let url = format!("rfc2217://127.0.0.1:{}", server.line("port: "));
    let error = opened(&url).err().expect("1200 baud only").to_string();
    assert!(error.contains(&url) && error.contains("refused baudrate") && error.contains("[0, 0, 4, 176]"), "{error}");
}

#[test]
fn a_server_that_suspends_gets_nothing_until_it_resumes() {
    let Some(python) = python_or_skip("rfc2217 suspend") else { return };
    let scratch = Scratch::new("suspend");
    let server = Script::start(python, "rfc2217_server.py", &["loop://", "suspend"], &scratch.path("out"));
    let mut port = opened(&format!("rfc2217://127.0.0.1:{}", server.line("port: "))).expect("the server agrees");
    assert_eq!(port.write(b"S").expect("the line stays"), 1);
    // Until its word arrives some bytes may go; then none for the half second that it waits.
    let mut suspended: Option<Instant> = None;
    let held = wait_for("the server to suspend and to resume", || {
        match (port.write(b"x").expect("the line stays"), suspended) {
            (0, None) => {
                suspended = Some(Instant::now());
                None
            }
            (0, Some(_)) | (_, None) => None,
            (_, Some(since)) => Some(since.elapsed()),
        }
    });
    println!("held for {held:?}");
    assert!(held >= Duration::from_millis(400), "{held:?}");
}

#[test]
fn a_port_that_speaks_no_telnet_is_refused_in_time() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let place = listener.local_addr().expect("an address");
    let started = Instant::now();
    let error = opened(&format!("rfc2217://{place}?timeout=0.4")).err().expect("no answer").to_string();
    assert!(error.contains("socket://"), "{error}");
    assert!((350..2_900).contains(&started.elapsed().as_millis()), "{:?}", started.elapsed());
}

#[test]
fn our_socket_and_pyserials_understand_each_other() {
    let Some(python) = python_or_skip("socket") else { return };
    let scratch = Scratch::new("socket");
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let place = listener.local_addr().expect("an address").to_string();
    let theirs = Script::start(python, "socket_client.py", &[&place], &scratch.path("out"));
    let (one, _) = listener.accept().expect("pyserial connects");
    theirs.line("open");
    let mut port = opened(&format!("socket://{place}?logging=info")).expect("somebody listens");
    let (other, _) = listener.accept().expect("we connect");
    for (mut from, mut to) in [(clone(&one), clone(&other)), (other, one)] {
        std::thread::spawn(move || {
            let mut bytes = [0; 1_024];
            while let Ok(len @ 1..) = from.read(&mut bytes) {
                if to.write_all(&bytes[..len]).is_err() {
                    break;
                }
            }
        });
    }
    let sent = every_byte();
    let inverted: Vec<u8> = sent.iter().map(|byte| !byte).collect();
    assert_eq!(back(&mut *port, &sent), inverted);
}

fn clone(stream: &TcpStream) -> TcpStream {
    stream.try_clone().expect("a second handle")
}

/// Our sender on the way to a control: both end well.
fn streamed(scratch: &Scratch, url: &str, control: Running) -> Ended {
    let journal = scratch.path("journal");
    let stream = ["stream", JOB, "--port", url, "--journal", &journal, "--json"];
    let sender = Running::start(scratch, "stream", &stream).end();
    assert_eq!(sender.code, Some(0), "{}", sender.err);
    let control = control.end();
    assert_eq!(control.code, Some(0), "{}", control.err);
    sender
}

/// A whole job: our sender, pyserial's RFC 2217 server, a pseudo-terminal, our control.
#[test]
fn a_job_streamed_through_pyserials_server_is_executed_as_it_is() {
    let Some(python) = python_or_skip("a job through rfc2217") else { return };
    let scratch = Scratch::new("job2217");
    let adapted = scratch.path("adapted.nc");
    assert!(run(&["adapt", JOB, "-o", &adapted]).status.success());
    let executed = scratch.path("served.nc");
    // The control is twenty times as fast as its line: it accepts all characters, and the sender does not wait a minute.
    let serve = ["serve", JOB, "--pty", "--once", "--json", "--executed", &executed, "--speed", "20"];
    let mut control = Running::start(&scratch, "serve", &serve);
    let pty = control.line("port: ");
    let server = Script::start(python, "rfc2217_server.py", &[&pty], &scratch.path("out"));
    let url = format!("rfc2217://127.0.0.1:{}", server.line("port: "));
    let sender = streamed(&scratch, &url, control);
    let adapted = read(&adapted);
    assert_eq!(blocks_of(&read(&executed)), blocks_of(&adapted));
    let sent: serde_json::Value = serde_json::from_str(sender.out.trim()).expect("JSON");
    assert_eq!(sent["link"]["bytes"].as_u64(), Some(adapted.len() as u64));
}

/// Our control behind our RFC 2217 server, at 9600 7E2.
fn control_at_rfc2217(scratch: &Scratch, executed: &str) -> (Running, String) {
    let serve = ["serve", JOB, "--rfc2217", "127.0.0.1:0", "--once", "--json", "--executed", executed, "--speed", "20"];
    let mut control = Running::start(scratch, "serve", &serve);
    let url = format!("rfc2217://{}", control.line("port: rfc2217://"));
    (control, url)
}

fn blocks_of(program: &[u8]) -> String {
    let is_block = |line: &&[u8]| !matches!(line.trim_ascii(), b"" | b"%");
    let blocks = program.split_inclusive(|&byte| byte == b'\n').filter(is_block);
    blocks.map(|block| block.escape_ascii().to_string() + "\n").collect()
}

fn read(path: &str) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[test]
fn pyserials_client_sends_a_job_through_our_server_whoever_does_xonxoff() {
    let Some(python) = python_or_skip("a job from pyserial through our rfc2217 server") else { return };
    for who in ["server", "own"] {
        let scratch = Scratch::new(&format!("serve2217-{who}"));
        let (adapted, executed) = (scratch.path("adapted.nc"), scratch.path("executed.nc"));
        assert!(run(&["adapt", JOB, "-o", &adapted]).status.success());
        let (control, url) = control_at_rfc2217(&scratch, &executed);
        let out = scratch.path("out");
        let sender = Script::start(python, "rfc2217_client.py", &[&url, "9600", "7E2", &adapted, who], &out);
        assert_eq!(sender.line("open: "), "cts=1 dsr=1 cd=1 ri=0");
        let control = control.end();
        assert_eq!(control.code, Some(0), "{who}: {}", control.err);
        assert_eq!(blocks_of(&read(&executed)), blocks_of(&read(&adapted)), "{who}");
        let report: serde_json::Value =
            serde_json::from_str(control.out.lines().last().expect("a report")).expect("JSON");
        assert_eq!(report["alarms"], serde_json::json!([]), "{who}");
        if who == "server" {
            let after_xoff = report["link"]["max_bytes_after_xoff"].as_u64().expect("a number");
            assert!(after_xoff <= 10 && report["link"]["xoff_count"].as_u64() > Some(0), "{report}");
        }
    }
}

#[test]
fn our_sender_sends_a_job_through_our_server() {
    let scratch = Scratch::new("ours2217");
    let (adapted, executed) = (scratch.path("adapted.nc"), scratch.path("executed.nc"));
    assert!(run(&["adapt", JOB, "-o", &adapted]).status.success());
    let (control, url) = control_at_rfc2217(&scratch, &executed);
    streamed(&scratch, &url, control);
    assert_eq!(blocks_of(&read(&executed)), blocks_of(&read(&adapted)));
}

#[test]
fn a_port_at_another_rate_is_not_understood() {
    let Some(python) = python_or_skip("another rate through our rfc2217 server") else { return };
    let scratch = Scratch::new("rate2217");
    let (program, executed) = (scratch.path("program.nc"), scratch.path("executed.nc"));
    std::fs::write(&program, "%\nG1X1.F100\nM30\n%\n").expect("a scratch file");
    for (rate, frame) in [("4800", "7E2"), ("9600", "8N1")] {
        let (control, url) = control_at_rfc2217(&scratch, &executed);
        let sender =
            Script::start(python, "rfc2217_client.py", &[&url, rate, frame, &program, "server"], &scratch.path("out"));
        let control = control.end();
        assert_eq!(control.code, Some(3), "{}", control.err);
        assert!(control.err.contains("PS0085"), "{}", control.err);
        drop(sender);
    }
}
