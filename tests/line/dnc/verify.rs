//! `arcfeed verify`: the control stores a program, punches it, and every change in between is reported.

use arcfeed_tests::{Running, Scratch, run};
use serde_json::Value;

use crate::dnc::kill::{job, lines};

/// A control that stores and punches; its port.
fn store(scratch: &Scratch, job: &str, place: &[&str]) -> (Running, String) {
    let mut server =
        Running::start(scratch, "store", &[&["serve", job, "--store", "--once", "--speed", "20"], place].concat());
    let port = server.line("port: ");
    (server, port)
}

#[test]
fn a_program_that_the_control_has_stored_is_found_to_be_what_was_sent() {
    for place in [&["--tcp", "127.0.0.1:0"][..], &["--rfc2217", "127.0.0.1:0"], &["--pty"]] {
        let scratch = Scratch::new("verify");
        let job = job(&scratch);
        let (mut server, port) = store(&scratch, &job, place);
        let sent = run(&["stream", &job, "--port", &port]);
        assert!(sent.status.success(), "{place:?}: {}", String::from_utf8_lossy(&sent.stderr));
        let stored = server.line("stored: ");
        let received = scratch.path("received.nc");
        let output = run(&["verify", &job, "--port", &port, "-o", &received]);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{place:?}: {said}{}", String::from_utf8_lossy(&output.stderr));
        assert!(said.contains(&format!("{stored}, in the control as sent")), "{stored}, {said}");
        let received = lines(&scratch, "received.nc");
        assert_eq!((received[0].as_str(), received.last().map(String::as_str)), ("%", Some("%")));
        assert!(received.iter().any(|line| line.starts_with("N146G2X-2.5752Y11.5549I4.0398J-3.0504F40.99")));
        assert_eq!(server.end().code, Some(0));
    }
}

#[test]
fn altered_blocks_are_reported_with_their_place() {
    let scratch = Scratch::new("verify-differs");
    let job = job(&scratch);
    let text = std::fs::read_to_string(&job).expect("text").replace("bytesize = 7", "bytesize = 8");
    scratch.write("job.toml", text.replace("\"E\"", "\"N\""));
    let (mut server, port) = store(&scratch, &job, &["--tcp", "127.0.0.1:0"]);
    // No parity: whatever a turned bit makes of a character is stored.
    let sent = run(&["stream", &job, "--port", &format!("fault://tx.flip=0.001,seed=3/{port}")]);
    assert!(sent.status.success(), "{}", String::from_utf8_lossy(&sent.stderr));
    server.line("stored: ");
    let output = run(&["verify", &job, "--port", &port, "--json"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    let verdict: Value = serde_json::from_slice(&output.stdout).expect("one object");
    let difference = &verdict["difference"];
    let [line, column] = ["line", "column"].map(|field| difference[field].as_u64().expect("a place") as usize);
    assert!(stderr.contains(&format!("ibr-slot.nc:{line}:{column}: error: the control has")), "{stderr}");
    // The place is one where the two texts do differ, and nothing before does.
    let [sent, received] = ["sent", "received"].map(|field| difference[field].as_str().expect("a block").to_owned());
    let [sent, before, received] = [&sent, &sent[..column - 1], &received].map(|text| text.replace(' ', ""));
    assert!(sent != received && received.starts_with(&before), "{difference}");
}

#[test]
fn a_control_that_sends_nothing_or_only_a_beginning_is_no_agreement() {
    let scratch = Scratch::new("verify-nothing");
    let job = job(&scratch);
    let text = std::fs::read_to_string(&job).expect("text");
    scratch.write("job.toml", format!("{text}\n[dnc]\nstart_timeout = 1\n"));
    let output = run(&["verify", &job, "--port", "loop://"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(3) && stderr.contains("press PUNCH"), "{stderr}");
    let output = run(&["verify", &job, "--port", "sim:"]);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
}
