//! `arcfeed serve` over TCP among clients that flood it, read nothing, say nothing or are no senders: its memory stays bounded
//! and an honest sender's program runs whole.
#![cfg(target_os = "linux")]

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use arcfeed_tests::{Ended, Running, Scratch, run, wait_for};
use serde_json::Value;

const DC1: u8 = 0x11;
const PROGRAM: &str = "%\nO7(HONEST)\nG21G1X1.F6000\nN30X2.\nX3.\nG4X1.\nX4.\nM30\n%\n";
const MEMORY_MAX_KB: u64 = 100 * 1_024;
/// Seconds of flood, set by `cargo xtask soak`.
const SOAK: &str = "ARCFEED_SOAK_SECONDS";

/// RFC 2217: WILL COM-PORT.
const WILL_COM_PORT: [u8; 3] = [255, 251, 44];
/// RFC 2217: a request for the signature, and a break.
const SIGNATURE: [u8; 6] = [255, 250, 44, 0, 255, 240];
const BREAK: [u8; 7] = [255, 250, 44, 5, 5, 255, 240];

fn flood_time() -> Duration {
    let seconds = std::env::var(SOAK).ok().map(|text| text.parse().expect("a number of seconds"));
    Duration::from_secs(seconds.unwrap_or(4))
}

fn serve(scratch: &Scratch, place: &str, flags: &[&str]) -> (Running, String) {
    let executed = scratch.path("executed.nc");
    let fixed = ["serve", place, "127.0.0.1:0", "--json", "--executed", &executed, "--speed", "20"];
    let mut server = Running::start(scratch, "serve", &[&fixed[..], flags].concat());
    let address = server.line(&format!("port: {}://", if place == "--tcp" { "socket" } else { "rfc2217" }));
    (server, address)
}

/// Connects as an honest sender: waits for DC1, sends its program, and stays until the control has executed it.
fn send_honestly(scratch: &Scratch, address: &str, greeting: &[u8]) {
    let _not_there = std::fs::remove_file(scratch.path("executed.nc"));
    let mut line = TcpStream::connect(address).expect("the server listens");
    line.write_all(greeting).expect("the server takes it");
    line.set_read_timeout(Some(Duration::from_secs(120))).expect("a socket can wait");
    let mut byte = [0];
    while byte[0] != DC1 {
        line.read_exact(&mut byte).expect("the control says DC1");
    }
    line.write_all(PROGRAM.as_bytes()).expect("the control takes it");
    let wanted: Vec<&str> = PROGRAM.lines().filter(|line| *line != "%").collect();
    wait_for("the honest program", || {
        let executed = std::fs::read_to_string(scratch.path("executed.nc")).unwrap_or_default();
        (executed.lines().collect::<Vec<_>>() == wanted).then_some(())
    });
}

/// Connects again and again and writes the same until it is no longer accepted; `then` is done with each connection at its end.
fn flood(address: &str, bytes: &[u8], is_over: &AtomicBool, then: impl Fn(&mut TcpStream)) {
    while !is_over.load(Ordering::Relaxed) {
        let Ok(mut line) = TcpStream::connect(address) else { continue };
        let _as_it_likes = line.set_nonblocking(true);
        while !is_over.load(Ordering::Relaxed) {
            match line.write(bytes) {
                Ok(_) => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(Duration::from_millis(1)),
                Err(_) => break,
            }
        }
        then(&mut line);
    }
}

/// Connects and does nothing more, while the server lets it.
fn stay(address: &str, first: &[u8], is_over: &AtomicBool) {
    while !is_over.load(Ordering::Relaxed) {
        let Ok(mut line) = TcpStream::connect(address) else { continue };
        let _as_it_likes = line.set_read_timeout(Some(Duration::from_millis(50)));
        let _gone = line.write_all(first);
        let mut bytes = [0; 64];
        while !is_over.load(Ordering::Relaxed) {
            match line.read(&mut bytes) {
                Ok(0) => break,
                Err(error) if !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => break,
                _ => {}
            }
        }
    }
}

fn scan(address: &str, is_over: &AtomicBool) {
    while !is_over.load(Ordering::Relaxed) {
        if let Ok(line) = TcpStream::connect(address) {
            let _gone = line.shutdown(Shutdown::Write);
            drop(line);
        }
        if let Ok(mut line) = TcpStream::connect(address) {
            let _gone = line.write_all(b"GET / HTTP/1.1\r\nHost: control\r\n\r\n");
            let _as_it_likes = line.set_read_timeout(Some(Duration::from_millis(200)));
            let _answer = line.read(&mut [0; 64]);
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Floods a server of either kind, and lets an honest sender work during the flood and after it.
fn attack(place: &str, greeting: &[u8], floods: &[Vec<u8>]) {
    let scratch = Scratch::new(&format!("attack{place}"));
    let (server, address) = serve(&scratch, place, &["--idle-timeout", "1", "--baudrate", "115200"]);
    let is_over = AtomicBool::new(false);
    let (started, mut honest) = (Instant::now(), 0);
    let half = [greeting, b"%\nG21G1F100\nX1.\nX"].concat();
    let slow = [greeting, b"%\nG21G1X1.F6000\nX2.\nX3.\n"].concat();
    std::thread::scope(|scope| {
        floods.iter().for_each(|bytes| drop(scope.spawn(|| flood(&address, bytes, &is_over, |_| {}))));
        scope.spawn(|| stay(&address, greeting, &is_over));
        scope.spawn(|| stay(&address, &half, &is_over));
        scope.spawn(|| flood(&address, &slow, &is_over, |line| drop(line.shutdown(Shutdown::Write))));
        scope.spawn(|| scan(&address, &is_over));
        while started.elapsed() < flood_time() {
            send_honestly(&scratch, &address, greeting);
            honest += 1;
            let now = server.memory_kb("VmRSS");
            assert!(now <= MEMORY_MAX_KB, "{now} kB in use");
        }
        is_over.store(true, Ordering::Relaxed);
    });
    send_honestly(&scratch, &address, greeting);
    let most = server.memory_kb("VmHWM");
    println!("{place}: {honest} honest programs in {:?} of flood; at most {most} kB", started.elapsed());
    assert!(most <= MEMORY_MAX_KB, "{most} kB");
    server.interrupt();
    assert_eq!(server.end().code, Some(130));
}

#[test]
fn floods_idlers_and_scans_of_a_bare_port_neither_end_it_nor_fill_its_memory() {
    attack("--tcp", &[], &[vec![b'X'; 65_536], vec![0; 65_536], b"%\n(NO END".repeat(4_096)]);
}

#[test]
fn floods_idlers_and_scans_of_an_rfc2217_port_neither_end_it_nor_fill_its_memory() {
    let asking = [&WILL_COM_PORT[..], &SIGNATURE.repeat(4_096)].concat();
    let breaking = [&WILL_COM_PORT[..], &BREAK.repeat(4_096)].concat();
    attack("--rfc2217", &WILL_COM_PORT, &[vec![b'X'; 65_536], asking, breaking]);
}

#[test]
fn a_client_that_never_begins_a_program_is_no_alarm() {
    let scratch = Scratch::new("no-program");
    let (server, address) = serve(&scratch, "--tcp", &["--once", "--baudrate", "115200"]);
    for first in [&b""[..], b"\0\0%\n", b"GET / HTTP/1.0\r\n\r\n"] {
        let mut line = TcpStream::connect(&address).expect("the server listens");
        line.write_all(first).expect("the server takes it");
        std::thread::sleep(Duration::from_millis(100));
    }
    send_honestly(&scratch, &address, &[]);
    let Ended { code, out, err } = server.end();
    assert_eq!(code, Some(0), "{err}");
    assert!(err.contains("does not begin with `%`"), "{err}");
    assert_eq!(out.lines().filter(|line| line.starts_with('{')).count(), 1, "{out}");
}

#[test]
fn an_alarm_of_one_sender_is_reported_and_the_next_finds_a_fresh_control() {
    let scratch = Scratch::new("next-sender");
    let (server, address) = serve(&scratch, "--tcp", &["--baudrate", "115200"]);
    let mut line = TcpStream::connect(&address).expect("the server listens");
    line.write_all(b"%\nG90\nG1X").expect("the server takes it");
    std::thread::sleep(Duration::from_millis(200));
    drop(line);
    send_honestly(&scratch, &address, &[]);
    server.interrupt();
    let Ended { out, err, .. } = server.end();
    let reports: Vec<Value> = out.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    assert_eq!(reports[0]["alarms"][0]["alarm"], 86, "{out}");
    assert_eq!(reports[1]["alarms"], Value::Array(vec![]), "{out}");
    assert!(err.contains("PS0086"), "{err}");
}

#[test]
fn no_more_clients_than_allowed_are_held() {
    let scratch = Scratch::new("max-clients");
    let (server, address) = serve(&scratch, "--tcp", &["--max-clients", "3"]);
    let held: Vec<TcpStream> = (0..10).map(|_| TcpStream::connect(&address).expect("it listens")).collect();
    std::thread::sleep(Duration::from_millis(300));
    let sockets = || {
        let folder = std::fs::read_dir(format!("/proc/{}/fd", server.id())).expect("it runs");
        let links = folder.filter_map(|entry| std::fs::read_link(entry.expect("an entry").path()).ok());
        links.filter(|link| link.to_string_lossy().starts_with("socket:")).count()
    };
    // Three clients and the listener.
    assert_eq!(sockets(), 4);
    drop(held);
    wait_for("the clients to be gone", || (sockets() == 1).then_some(()));
}

#[test]
fn addresses_that_other_machines_reach_need_a_flag() {
    for place in ["--tcp", "--rfc2217"] {
        for address in ["0.0.0.0:0", "[::]:0", "203.0.113.1:1"] {
            let output = run(&["serve", place, address]);
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{stderr}");
            assert!(stderr.contains("--allow-remote") && stderr.contains("127.0.0.1"), "{stderr}");
        }
    }
    let scratch = Scratch::new("allow-remote");
    let mut server = Running::start(&scratch, "serve", &["serve", "--tcp", "0.0.0.0:0", "--allow-remote"]);
    assert!(server.line("port: ").starts_with("socket://0.0.0.0:"));
}

#[test]
fn a_program_that_memory_refuses_is_reported_and_the_next_one_stored() {
    let scratch = Scratch::new("store-refused");
    let serve = ["serve", "--tcp", "127.0.0.1:0", "--store", "--speed", "20", "--baudrate", "115200", "--code", "iso"];
    let mut server = Running::start(&scratch, "store", &serve);
    let address = server.line("port: socket://");
    let send = |frames: &[u8]| {
        let mut line = TcpStream::connect(&address).expect("the server listens");
        line.write_all(frames).expect("the server takes it");
        line
    };
    // Without parity bits, which `--code iso` leaves to the sender.
    let refused = send(PROGRAM.as_bytes());
    wait_for("the refusal", || server.said().contains("refused").then_some(()));
    drop(refused);
    let even = |byte: &u8| byte | (byte.count_ones() as u8 & 1) << 7;
    let _stored = send(&PROGRAM.as_bytes().iter().map(even).collect::<Vec<u8>>());
    assert_eq!(server.line("stored: "), "7 blocks");
}
