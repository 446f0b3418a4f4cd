//! `arcfeed board` and `arcfeed stream --board`, against a board in software: messages to the board, sent blocks and their time, and
//! what ends a run.

use std::fs::File;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use arcfeed_tests::emulation::served::{AHEAD, ServedBoard};
use arcfeed_tests::{Running, Scratch, arcfeed, root, run, wait_for};
use serde_json::Value;

mod chip;

const JOB: &str = "examples/ibr-slot/job.toml";
const DC1: u8 = 0x11;
/// A link is lost after a quarter of a second: tests that keep one up do not share the machine.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
/// Others may still keep it busy for so long, and cost a test its link; not every time.
const ATTEMPTS: u32 = 10;
const LOST: &str = "board: the board is silent";
const RESTARTED: &str = "board: the board has restarted";

/// The machine was too busy to keep the link up.
struct LinkLost;

/// Whether the sender may have ended because one end of the link got no processor time: a board that hears nothing
/// sends hello again.
fn is_busy(said: &str) -> bool {
    said.contains(LOST) || said.contains(RESTARTED)
}

/// One attempt after the other, until the link holds throughout.
fn while_the_link_holds(mut attempt: impl FnMut() -> Result<(), LinkLost>) {
    let held = (0..ATTEMPTS).any(|_| attempt().is_ok());
    assert!(held, "the link was lost {ATTEMPTS} times");
}

/// A control that asks for a program and takes all it gets.
struct Taker {
    url: String,
    taken: Arc<Mutex<Vec<u8>>>,
}

impl Taker {
    fn start() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let url = format!("socket://{}", listener.local_addr().expect("it has an address"));
        let taken = Arc::new(Mutex::new(Vec::new()));
        let into = Arc::clone(&taken);
        std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().expect("a sender");
            stream.write_all(&[DC1]).expect("the sender is there");
            let _gone = take(&mut stream, &into);
        });
        Taker { url, taken }
    }

    fn taken(&self) -> Vec<u8> {
        self.taken.lock().expect("no thread panicked").clone()
    }
}

fn take(stream: &mut TcpStream, into: &Mutex<Vec<u8>>) -> std::io::Result<()> {
    let mut bytes = [0; 64];
    loop {
        let len = stream.read(&mut bytes)?;
        if len == 0 {
            return Ok(());
        }
        into.lock().expect("no thread panicked").extend(&bytes[..len]);
    }
}

/// A sender with a person who may type.
fn stream(scratch: &Scratch, control: &Taker, board: &str) -> Child {
    let journal = scratch.path("journal");
    Command::new(arcfeed())
        .args(["stream", JOB, "--port", &control.url, "--board", board, "--journal", &journal])
        .current_dir(root())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("arcfeed starts")
}

/// Types `arm` until the board is armed: characters begin to leave.
fn arm(sender: &mut Child, control: &Taker) -> Result<(), LinkLost> {
    let mut stdin = sender.stdin.take().expect("it is piped");
    wait_for("the first character", || {
        if stdin.write_all(b"arm\n").is_err() {
            let mut said = String::new();
            let _text = sender.stderr.take().map(|mut stderr| stderr.read_to_string(&mut said));
            assert!(is_busy(&said), "the sender has ended: {said}");
            return Some(Err(LinkLost));
        }
        std::thread::sleep(Duration::from_millis(100));
        (!control.taken().is_empty()).then_some(Ok(()))
    })?;
    // Kept open: at its end typing would no longer be possible.
    std::mem::forget(stdin);
    Ok(())
}

/// Waits until no more characters come.
fn settled(control: &Taker) -> Vec<u8> {
    wait_for("the characters to stop", || {
        let before = control.taken();
        std::thread::sleep(Duration::from_millis(700));
        (control.taken() == before).then_some(before)
    })
}

fn ended(sender: Child) -> (Option<i32>, String) {
    let output = sender.wait_with_output().expect("it ends");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Lines of the text with a move: a word of an axis or a centre.
fn moves(text: &[u8]) -> usize {
    text.split(|byte| *byte == b'\n').filter(|line| line.iter().any(|byte| b"XYZB".contains(byte))).count()
}

fn figures(arguments: &[&str]) -> Value {
    let output = run(arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(!said.contains("the board has stood"), "{said}");
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn behind_a_link_the_example_is_cut_as_by_a_notified_controller() {
    let _alone = ONE_AT_A_TIME.lock();
    let direct = figures(&["stream", JOB, "--json"]);
    let linked = figures(&["stream", JOB, "--board", "sim:", "--json"]);
    assert_eq!(linked["blocks_executed"], direct["blocks_executed"]);
    let chip = |report: &Value, field: &str| report["chip_load"][field].as_f64().expect("measured");
    for field in ["min", "max", "error_ratio_min", "error_ratio_max"] {
        let (a, b) = (chip(&direct, field), chip(&linked, field));
        println!("{field}: direct {a:.6}, behind a link {b:.6}");
        assert!((a - b).abs() < 1e-3, "{field}: {a} {b}");
    }
    assert!(chip(&linked, "error_ratio_max") <= 0.0, "no chip above its target");
    let cycle = |report: &Value| report["cycle_time_s"].as_f64().expect("a time");
    println!("cycle time: direct {} s, behind a link {} s", cycle(&direct), cycle(&linked));
    assert!((cycle(&direct) - cycle(&linked)).abs() < 0.1);
}

#[test]
fn position_reports_and_a_board_link_together_keep_the_chip_at_its_target() {
    let _alone = ONE_AT_A_TIME.lock();
    let scratch = Scratch::new("board-reports");
    let read = |file: &str| std::fs::read_to_string(root().join("examples/ibr-slot").join(file)).expect("the example");
    scratch.write("ibr-slot.nc", read("ibr-slot.nc"));
    let job = scratch.write("job.toml", read("job.toml") + "\n[dnc]\nreport_every = 5\n");
    let report = figures(&["stream", &job, "--board", "sim:", "--json"]);
    assert!(report["blocks_executed"].as_u64() > Some(80), "{report}");
    let chip = report["chip_load"]["error_ratio_max"].as_f64().expect("measured");
    println!("thickest chip {:+.2} %", chip * 100.0);
    assert!(chip <= 0.0, "a move left out puts the laws of all others on the wrong ones: {chip}");
}

#[test]
fn nothing_leaves_before_a_person_has_armed_and_no_block_before_its_move() {
    let _alone = ONE_AT_A_TIME.lock();
    while_the_link_holds(|| {
        let (scratch, board, control) = (Scratch::new("board-gate"), ServedBoard::start(), Taker::start());
        let mut sender = stream(&scratch, &control, &board.url);
        std::thread::sleep(Duration::from_millis(1_500));
        assert_eq!(control.taken(), b"", "not armed");
        let armed = arm(&mut sender, &control);
        let taken = settled(&control);
        // The axes of this board stand still, so it takes what it has room for and no more.
        let (sent, held) = (moves(&taken), AHEAD);
        println!("{sent} moves sent to the control, the board holds at most {held}");
        assert!(sent <= held, "{sent} {held}");
        let _may_have_ended = sender.kill();
        let (_, said) = ended(sender);
        armed?;
        if is_busy(&said) {
            return Err(LinkLost);
        }
        assert!(sent >= 2, "{sent}");
        Ok(())
    });
}

#[test]
fn a_board_that_restarts_or_falls_silent_ends_the_sending_with_the_reason() {
    let _alone = ONE_AT_A_TIME.lock();
    while_the_link_holds(|| {
        let board = ServedBoard::start();
        ends_the_sending("restart", &board.url, || board.restart(), RESTARTED)
    });
    while_the_link_holds(|| {
        let board = ServedBoard::start();
        ends_the_sending("silence", &board.url, || board.fall_silent(), LOST)
    });
}

fn ends_the_sending(name: &str, board: &str, interruption: impl FnOnce(), reason: &str) -> Result<(), LinkLost> {
    let (scratch, control) = (Scratch::new(&format!("board-{name}")), Taker::start());
    let mut sender = stream(&scratch, &control, board);
    arm(&mut sender, &control)?;
    let before = settled(&control);
    if let Ok(Some(_)) = sender.try_wait() {
        let (_, said) = ended(sender);
        assert!(is_busy(&said), "before the {name}: {said}");
        return Err(LinkLost);
    }
    interruption();
    let (code, said) = ended(sender);
    assert_eq!(code, Some(3), "{said}");
    if reason != LOST && said.contains(LOST) {
        return Err(LinkLost);
    }
    assert!(said.contains(reason) && said.contains("--resume"), "{said}");
    let taken = control.taken();
    let more = &taken[before.len()..];
    assert!(moves(more) <= 1, "after the {name} {:?} left", String::from_utf8_lossy(more));
    let journal = std::fs::read_to_string(scratch.path("journal")).expect("a journal");
    assert!(journal.contains("end"), "{journal}");
    Ok(())
}

#[test]
fn a_board_reports_its_identity_and_accepts_valid_settings() {
    let _alone = ONE_AT_A_TIME.lock();
    let board = ServedBoard::start();
    let info = figures(&["board", &board.url, "info", "--json"]);
    assert_eq!((&info["name"], &info["capacity"], &info["starts"]), (&"served".into(), &(AHEAD - 1).into(), &1.into()));
    let said = |arguments: &[&str]| {
        let output = run(&[&["board", &board.url], arguments].concat());
        let text = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
        (output.status.code(), text)
    };
    let (code, listed) = said(&["set"]);
    assert!(code == Some(0) && listed.lines().count() == 12 && listed.contains("link-lost"), "{listed}");
    assert_eq!(said(&["set", "resync", "600000"]), (Some(0), "resync is 600000 us\n".into()));
    assert!(said(&["set"]).1.contains("600000 us"));
    let (code, refused) = said(&["set", "position-stale", "0"]);
    assert!(code == Some(3) && refused.contains("out of range"), "{refused}");
    let (code, unknown) = said(&["set", "resinc", "1"]);
    assert!(code == Some(2) && unknown.contains("resync"), "{unknown}");
    let (code, half) = said(&["set", "resync"]);
    assert!(code == Some(2), "{half}");
    let (code, seen) = said(&["monitor", "--seconds", "3"]);
    assert!(code == Some(0) && seen.contains("idle") && seen.contains("NotArmed"), "{seen}");
}

#[test]
fn where_no_board_answers_it_says_what_to_check() {
    let output = run(&["board", "loop://", "info"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3));
    assert!(said.contains("our own echo"), "{said}");
    let silent = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let url = format!("socket://{}", silent.local_addr().expect("it has an address"));
    let output = run(&["stream", JOB, "--port", "loop://", "--board", &url, "--journal", "/nonexistent/x"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("no answer") && said.contains("115 200"), "{said}");
    let output = run(&["stream", JOB, "--board", &url]);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A sender with a person who may type, and whose words can be read while it runs.
fn stream_noted(scratch: &Scratch, job: &str, control: &str, board: &str) -> Child {
    let err = File::create(scratch.path("stream.err")).expect("a scratch file can be made");
    Command::new(arcfeed())
        .args(["stream", job, "--port", control, "--board", board, "--journal", &scratch.path("journal")])
        .current_dir(root())
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(err)
        .spawn()
        .expect("arcfeed starts")
}

#[test]
fn a_board_with_a_fault_is_said_to_hold_the_feed_until_it_is_reset() {
    let _alone = ONE_AT_A_TIME.lock();
    while_the_link_holds(|| {
        let (scratch, board, control) = (Scratch::new("board-fault"), ServedBoard::start(), Taker::start());
        let mut sender = stream_noted(&scratch, JOB, &control.url, &board.url);
        let mut person = sender.stdin.take().expect("it is piped");
        let said = || std::fs::read_to_string(scratch.path("stream.err")).expect("text");
        let mut until = |what: &str, holds: &dyn Fn() -> bool| {
            wait_for(what, || {
                let _gone = person.write_all(if what == "the arming" { b"arm\n" } else { b"\n" });
                std::thread::sleep(Duration::from_millis(100));
                let held = holds().then_some(Ok(()));
                held.or_else(|| is_busy(&said()).then_some(Err(LinkLost)))
            })
        };
        let seen = until("the arming", &|| !control.taken().is_empty())
            .inspect(|()| board.fail())
            .and_then(|()| until("the fault", &|| said().contains("the board has a fault: its hardware")))
            .inspect(|()| assert!(!said().contains("note: "), "{}", said()))
            .inspect(|()| board.reset())
            .and_then(|()| until("the reset", &|| said().contains("note: the board is idle")));
        let _may_have_ended = sender.kill();
        let _reaped = sender.wait();
        println!("{}", said());
        seen?;
        for part in ["It puts out 0 %", "feed hold", "RESET at the board", "the board is faulted. Look at the machine"]
        {
            assert!(said().contains(part), "{part}: {}", said());
        }
        Ok(())
    });
}

#[test]
fn a_board_that_sees_no_move_while_the_control_reports_others_is_reported() {
    let _alone = ONE_AT_A_TIME.lock();
    while_the_link_holds(|| {
        let (scratch, board) = (Scratch::new("board-stands"), ServedBoard::start());
        let read =
            |file: &str| std::fs::read_to_string(root().join("examples/ibr-slot").join(file)).expect("the example");
        scratch.write("ibr-slot.nc", read("ibr-slot.nc"));
        let job = scratch.write("job.toml", read("job.toml") + "\n[dnc]\nreport_every = 1\nread_ahead = 1\n");
        let mut control = Running::start(&scratch, "serve", &["serve", &job, "--tcp", "127.0.0.1:0", "--speed", "10"]);
        let url = control.line("port: ");
        let mut sender = stream_noted(&scratch, &job, &url, &board.url);
        let said = || std::fs::read_to_string(scratch.path("stream.err")).expect("text");
        let mut person = sender.stdin.take().expect("it is piped");
        let warned = wait_for("the warning", || {
            let _gone = person.write_all(b"arm\n");
            std::thread::sleep(Duration::from_millis(100));
            let warned = said().contains("at the move of line").then_some(Ok(()));
            warned.or_else(|| said().contains(LOST).then_some(Err(LinkLost)))
        });
        let _may_have_ended = sender.kill();
        let _reaped = sender.wait();
        println!("{}", said());
        warned
    });
}
