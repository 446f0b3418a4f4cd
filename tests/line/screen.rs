//! `arcfeed stream --tui` before a person: the real program in a pseudo-terminal, its screen read as a terminal shows it.
#![cfg(unix)]

use std::io::{Read, Write};
use std::num::NonZeroU16;
use std::sync::{Arc, Barrier, Mutex};
use std::thread::JoinHandle;

use arcfeed_tests::{Running, Scratch, arcfeed, root, run, wait_for};
use portable_pty::{Child, CommandBuilder, MasterPty, PtySize, native_pty_system};
use vt100::Parser;

const JOB: &str = "examples/ibr-slot/job.toml";
const SIZE: PtySize = PtySize { rows: 30, cols: 100, pixel_width: 0, pixel_height: 0 };
const CTRL_C: &[u8] = b"\x03";

/// A person with a terminal.
struct Person {
    master: Box<dyn MasterPty + Send>,
    child: Box<dyn Child + Send + Sync>,
    keys: Box<dyn Write + Send>,
    terminal: Arc<Mutex<Parser>>,
    /// Reads what is drawn, to its end.
    reading: JoinHandle<()>,
    /// Settings of the terminal before the start.
    found: String,
}

impl Person {
    /// Starts `arcfeed` on a terminal.
    fn starts(arguments: &[&str]) -> Self {
        Person::starts_and_looks(arguments, SIZE, Arc::new(Barrier::new(1)))
    }

    /// The same on a terminal that takes nothing until somebody is at the gate.
    fn starts_and_looks(arguments: &[&str], size: PtySize, gate: Arc<Barrier>) -> Self {
        let pair = native_pty_system().openpty(size).expect("a pseudo-terminal");
        let found = format!("{:?}", pair.master.get_termios().expect("a terminal"));
        let child = pair.slave.spawn_command(command(arguments)).expect("arcfeed starts");
        let [rows, cols] = [size.rows, size.cols].map(|cells| NonZeroU16::new(cells).expect("a terminal has a size"));
        let terminal = Arc::new(Mutex::new(Parser::new(rows, cols, 0)));
        let mut reader = pair.master.try_clone_reader().expect("a reader");
        let seen = Arc::clone(&terminal);
        let reading = std::thread::spawn(move || {
            gate.wait();
            let mut buffer = [0; 4_096];
            while let Ok(len @ 1..) = reader.read(&mut buffer) {
                seen.lock().expect("the parser").process(&buffer[..len]);
            }
        });
        let keys = pair.master.take_writer().expect("a writer");
        // The last end of the program's side goes here: its end is seen.
        Person { master: pair.master, child, keys, terminal, reading, found }
    }

    fn screen(&self) -> String {
        self.terminal.lock().expect("the parser").screen().contents()
    }

    fn sees(&self, words: &str) {
        wait_for(words, || self.screen().contains(words).then_some(()));
    }

    /// The number of the executed block's line.
    fn executed(&self) -> Option<usize> {
        let screen = self.screen();
        let line = screen.lines().find_map(|line| line.split_once("│>"))?.1;
        line.split_whitespace().next()?.parse().ok()
    }

    fn presses(&mut self, keys: &[u8]) {
        self.keys.write_all(keys).and_then(|()| self.keys.flush()).expect("the terminal takes a key");
    }

    /// Waits for the end; answers its exit code and what is left on the screen. The terminal is as it was.
    fn goes(mut self) -> (u32, String) {
        let status = wait_for("the end of arcfeed", || self.child.try_wait().expect("a child can be waited for"));
        wait_for("all that it has drawn", || self.reading.is_finished().then_some(()));
        let terminal = self.terminal.lock().expect("the parser");
        assert!(!terminal.screen().alternate_screen() && !terminal.screen().hide_cursor());
        drop(terminal);
        assert_eq!(format!("{:?}", self.master.get_termios().expect("a terminal")), self.found);
        (status.exit_code(), self.screen())
    }
}

fn command(arguments: &[&str]) -> CommandBuilder {
    let mut command = CommandBuilder::new(arcfeed());
    command.args(arguments);
    command.cwd(root());
    command.env("TERM", "xterm-256color");
    command
}

impl Drop for Person {
    fn drop(&mut self) {
        let _already_over = self.child.kill();
    }
}

#[test]
fn a_program_is_watched_held_resumed_and_seen_to_its_end() {
    let scratch = Scratch::new("screen");
    let log = scratch.path("log");
    let slowly = ["stream", JOB, "--tui", "--baudrate", "600", "--speed", "10", "--log", &log];
    let mut person = Person::starts(&slowly);
    person.sees("> executed block");
    let first = wait_for("an executed block", || person.executed().filter(|line| *line > 1));
    person.presses(b" ");
    person.sees("HELD: sending stopped, the axes NOT: FEED HOLD");
    person.presses(b"r");
    person.sees("RESUME sending?");
    person.presses(b"n");
    person.sees("r: resume");
    person.presses(b"ry");
    wait_for("sending again", || (!person.screen().contains("HELD")).then_some(()));
    let later = wait_for("a later block", || person.executed().filter(|line| *line > first + 5));
    assert!(later > first);
    person.sees("chip, % of the target");
    // Feeds are adapted for the whole program: the machine measures the chip that was asked for.
    wait_for("a chip near its target", || {
        let screen = person.screen();
        let chip = screen
            .lines()
            .find_map(|line| line.split_once("│ chip ")?.1.split('%').next()?.trim().parse::<f64>().ok())?;
        (98.0..102.0).contains(&chip).then_some(())
    });
    println!("{}", person.screen());
    let (code, left) = person.goes();
    assert_eq!(code, 0, "{left}");
    assert!(left.contains("52 sent, 52 executed, no alarm"), "{left}");
    let log = std::fs::read_to_string(&log).expect("a log");
    assert!(log.starts_with("# ibr-slot.nc to sim:; simulated time; seconds since the line was opened\n"), "{log}");
    let order =
        ["DC1\n", "sent line 2: O1546", "executes line 2\n", "held\n", "resumed\n", "all sent\n", "executes line 53\n"];
    let mut rest = log.as_str();
    for event in order {
        rest = rest.split_once(event).unwrap_or_else(|| panic!("{event:?} is not where it belongs:\n{log}")).1;
    }
    let times: Vec<f64> = log.lines().skip(1).map(|line| line[..10].trim().parse().expect("a time")).collect();
    assert!(times.is_sorted() && times.len() > 100, "{log}");
}

#[test]
fn an_abort_needs_confirmation_and_unknown_states_are_not_shown() {
    let scratch = Scratch::new("screen-abort");
    let mut server =
        Running::start(&scratch, "serve", &["serve", JOB, "--tcp", "127.0.0.1:0", "--once", "--baudrate", "600"]);
    let port = server.line("port: ");
    let journal = scratch.path("journal");
    let arguments = ["stream", JOB, "--tui", "--port", &port, "--baudrate", "600", "--journal", &journal];
    let mut person = Person::starts(&arguments);
    person.sees("executed: unknown");
    person.sees("DC1: it takes characters");
    assert_eq!(person.executed(), None);
    person.presses(CTRL_C);
    person.sees("ABORT after the block under way?");
    person.presses(b"n");
    person.sees("q Ctrl-C: abort");
    person.presses(b"qy");
    let (code, left) = person.goes();
    assert_eq!(code, 130, "{left}");
    assert!(left.contains("stopped by the operator") && left.contains("FEED HOLD"), "{left}");
}

#[test]
fn a_terminal_that_accepts_nothing_delays_nothing() {
    let scratch = Scratch::new("screen-stuck");
    let (log, gate) = (scratch.path("log"), Arc::new(Barrier::new(2)));
    // The first picture alone is more than a pseudo-terminal keeps.
    let huge = PtySize { rows: 200, cols: 900, ..SIZE };
    let arguments = ["stream", JOB, "--tui", "--speed", "20", "--log", &log];
    let person = Person::starts_and_looks(&arguments, huge, Arc::clone(&gate));
    wait_for("the last block", || {
        std::fs::read_to_string(&log).unwrap_or_default().contains("executes line 53\n").then_some(())
    });
    assert_eq!(person.screen().trim(), "");
    gate.wait();
    let (code, left) = person.goes();
    assert_eq!(code, 0, "{left}");
    assert!(left.contains("52 sent, 52 executed, no alarm"), "{left}");
}

#[test]
fn a_terminal_that_is_closed_ends_the_sending_as_ctrl_c_does() {
    let scratch = Scratch::new("screen-gone");
    let journal = scratch.path("journal");
    let arguments = ["stream", JOB, "--tui", "--baudrate", "600", "--journal", &journal];
    let pair = native_pty_system().openpty(SIZE).expect("a pseudo-terminal");
    let mut child = pair.slave.spawn_command(command(&arguments)).expect("arcfeed starts");
    drop(pair.slave);
    let records = || std::fs::read_to_string(&journal).unwrap_or_default();
    wait_for("a part of the program", || (records().matches(" out ").count() >= 3).then_some(()));
    drop(pair.master);
    let status = wait_for("the end of arcfeed", || child.try_wait().expect("a child can be waited for"));
    assert_eq!(status.exit_code(), 130, "{status:?}");
    assert!(records().ends_with("reason=aborted\n"), "{}", records());
}

#[test]
fn a_request_to_terminate_gives_the_terminal_back() {
    let person = Person::starts(&["stream", JOB, "--tui", "--baudrate", "300"]);
    // Messages from before the start are shown again after the screen.
    person.sees("note: the line is slower than the program");
    person.sees("> executed block");
    let pid = person.child.process_id().expect("it runs").to_string();
    assert!(std::process::Command::new("kill").args(["-TERM", &pid]).status().expect("kill runs").success());
    let (code, left) = person.goes();
    assert_eq!(code, 130, "{left}");
    assert!(left.contains("feed hold, axes at rest"), "{left}");
}

#[test]
fn without_a_terminal_it_is_a_matter_of_usage() {
    for (more, hint) in [(&[][..], "stdin and stdout must both be one"), (&["--json"][..], "'--json'")] {
        let output = run(&[&["stream", JOB, "--tui"][..], more].concat());
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{stderr}");
        assert!(stderr.contains("--tui") && stderr.contains(hint), "{stderr}");
    }
    let output = run(&["stream", JOB, "--port", "loop://", "--speed", "2"]);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
}
