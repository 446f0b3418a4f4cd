//! A line that goes away under a transmission, of every kind: how far it came is said, and what to do at the control.

use arcfeed_tests::{Running, Scratch, run, wait_for};

use crate::dnc::kill::{job, lines};

/// Characters and blocks that a message says the line has taken.
fn taken(said: &str) -> [usize; 2] {
    let number = |before: &str, after: &str| -> usize {
        let text = said.split_once(before).and_then(|(_, rest)| rest.split_once(after)).map(|(number, _)| number);
        text.and_then(|number| number.parse().ok()).unwrap_or_else(|| panic!("no number behind `{before}`: {said}"))
    };
    [number("The line has accepted ", " of "), number(" characters, ", " whole blocks")]
}

/// The place that is said is that of the program as it is sent, and RESET is asked for.
fn assert_placed(scratch: &Scratch, job: &str, said: &str) {
    let adapted = scratch.path("adapted.nc");
    assert!(run(&["adapt", job, "-o", &adapted]).status.success());
    let program = std::fs::read(&adapted).expect("it was written");
    let [characters, blocks] = taken(said);
    println!("{characters} of {} characters, {blocks} blocks", program.len());
    assert!((1..program.len()).contains(&characters), "{said}");
    let whole = program[..characters].iter().filter(|byte| **byte == b'\n').count();
    // The `%` before the program is no block.
    assert_eq!(blocks, whole - 1, "{said}");
    assert!(said.contains(&format!("of {} characters", program.len())), "{said}");
    assert!(said.contains("half a block") && said.contains("press RESET there before anything else"), "{said}");
}

/// A control at a port of this kind is killed under the transmission.
fn killed(name: &str, place: &[&str]) {
    let scratch = Scratch::new(name);
    let job = job(&scratch);
    let mut server = Running::start(&scratch, "serve", &[&["serve", &job], place].concat());
    let port = server.line("port: ");
    let sender = Running::start(&scratch, "stream", &["stream", &job, "--port", &port, "--baudrate", "9600"]);
    wait_for("a part of the program", || {
        let journal = lines(&scratch, "job.journal");
        (journal.iter().filter(|line| line.contains(" out ")).count() >= 3).then_some(())
    });
    server.kill();
    let ended = sender.end();
    assert_eq!(ended.code, Some(3), "{}", ended.err);
    assert_placed(&scratch, &job, &ended.err);
    assert!(ended.err.contains("job.journal knows how far it came: see --resume"), "{}", ended.err);
}

#[test]
fn closed_socket_fails_with_the_progress() {
    killed("lost-tcp", &["--tcp", "127.0.0.1:0"]);
}

#[test]
fn vanished_serial_line_fails_with_the_progress() {
    killed("lost-pty", &["--pty"]);
}

#[test]
fn broken_line_to_the_simulator_fails_with_the_progress() {
    let scratch = Scratch::new("lost-sim");
    let job = job(&scratch);
    let output = run(&["stream", &job, "--port", "fault://disconnect=500/sim:"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert_placed(&scratch, &job, &said);
}

#[test]
fn line_that_stops_accepting_characters_fails_with_the_progress() {
    let scratch = Scratch::new("lost-time");
    let job = job(&scratch);
    let text = std::fs::read_to_string(&job).expect("text");
    scratch.write("job.toml", format!("{text}\n[dnc]\nxoff_timeout = 3\n"));
    // The first DC1 gets through, a later one does not.
    let output = run(&["stream", &job, "--port", "fault://lost_xon=0.5,seed=1/sim:"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains(" whole blocks, were sent: ") && said.contains("press RESET"), "{said}");
}
