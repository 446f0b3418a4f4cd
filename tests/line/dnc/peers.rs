//! Known bugs of other senders, read in their code or measured on it, as cases that this one passes. Their credits are
//! characters in flight; here the credit is what may still come after DC3.

use arcfeed::dnc::journal::{History, Start};
use arcfeed::dnc::resume::{RestartPlan, RestartRequest};
use arcfeed::dnc::sender::CHUNK;
use arcfeed::dnc::transmission::Transmission;
use arcfeed::dnc::{Sender, State};
use arcfeed_units::{Micros, Nm};
use fastrand::Rng;

use crate::dnc::line::{Line, line_use, send};
use crate::dnc::program::{Check, blocks, control, of_code, power_on, random, transmission, wire};
use crate::dnc::schedule::{Fault, Schedule};

const DC1: u8 = 0x11;
const DC3: u8 = 0x13;
const RATE: u32 = 9_600;

fn sender(text: &str) -> Sender {
    Sender::new(transmission(text, Check::None), line_use(&control(Check::None, RATE), Micros(0)))
}

fn long_program() -> String {
    format!("%\nO1\nG21\n{}M30\n%\n", "G1X1.F100.(TWENTY)\n".repeat(200))
}

/// Polls for a time; answers what went out.
fn run(sender: &mut Sender, from: &mut Micros, time: Micros) -> Vec<u8> {
    let (mut sent, mut out, end) = (Vec::new(), [0; CHUNK], from.after(time));
    while *from < end {
        let len = sender.poll_transmit(*from, &mut out);
        sent.extend_from_slice(&out[..len]);
        *from = from.after(Micros(100));
    }
    sent
}

/// The restart of a program at a line, as a person would ask for it.
fn plan(program: &str, line: usize) -> Result<RestartPlan, String> {
    let text = format!("%\n{program}\nM30\n%\n");
    let sent = transmission(&text, Check::None);
    let end = sent.frames().len();
    let history =
        History { start: Start::default(), sent: [end; 2], executed: None, stopped: false, ended: None, torn: 0 };
    RestartPlan::new(
        &sent,
        &history,
        &RestartRequest { line: Some(line), clearance: Some(Nm::from_mm(50.0)) },
        &power_on(),
    )
}

fn place(plan: &RestartPlan, words: &str) -> usize {
    let found = plan.blocks.iter().position(|block| block.contains(words));
    found.unwrap_or_else(|| panic!("no {words} in {:?}", plan.blocks))
}

#[test]
fn grbl_stream_py_bytes_that_wait_to_be_read_raise_no_limit() {
    // `sum(c_line) >= RX_BUFFER_SIZE-1 | s.inWaiting()`: with 128 bytes waiting the limit doubled.
    let (mut sender, mut now) = (sender(&long_program()), Micros::from_ms(100));
    sender.on_bytes(now, &[DC1]);
    sender.on_bytes(now, &[b'?'; 500]);
    let sent = run(&mut sender, &mut now, Micros::from_ms(100));
    // A character takes 1.146 ms at 9600 baud, and at most ten are ahead of the line.
    assert!((80..=97).contains(&sent.len()), "{} characters in 100 ms", sent.len());
}

#[test]
fn cncjs_pause_and_resume_give_no_credit_away() {
    // Each pause and resume cost it one line of credit: 114 bytes in flight became 230 after six.
    let (mut sender, mut now) = (sender(&long_program()), Micros::from_ms(100));
    sender.on_bytes(now, &[DC1]);
    for _ in 0..6 {
        run(&mut sender, &mut now, Micros::from_ms(40));
        sender.hold();
        assert_eq!(run(&mut sender, &mut now, Micros::from_ms(40)), b"");
        sender.resume();
    }
    let before = sender.progress().0;
    let sent = run(&mut sender, &mut now, Micros::from_ms(100));
    assert!((80..=97).contains(&sent.len()), "{} characters in 100 ms after {before}", sent.len());
}

#[test]
fn gsender_errors_from_the_control_do_not_stall_it() {
    // Six `error:` replies leaked all credit: nothing in flight, nothing sent, for ever.
    let (mut sender, mut now) = (sender(&long_program()), Micros::from_ms(100));
    sender.on_bytes(now, &[DC1]);
    for _ in 0..100 {
        sender.on_bytes(now, b"error:20\r\n");
        run(&mut sender, &mut now, Micros::from_ms(5));
    }
    run(&mut sender, &mut now, Micros::from_ms(20_000));
    assert_eq!(sender.state(), State::Sent);
}

#[test]
fn grblhal_an_answer_too_many_is_no_credit() {
    // `Run>Idle>Run` counted as an acknowledgement overran the buffer "seemingly at random".
    let (mut sender, mut now) = (sender(&long_program()), Micros::from_ms(100));
    sender.on_bytes(now, &[DC1; 50]);
    let sent = run(&mut sender, &mut now, Micros::from_ms(100));
    assert!((80..=97).contains(&sent.len()), "{} characters in 100 ms", sent.len());
    sender.on_bytes(now, &[DC1, DC1, DC3]);
    assert_eq!(run(&mut sender, &mut now, Micros::from_ms(100)), b"");
}

#[test]
fn ugs_counts_do_not_drift_whatever_happens() {
    // Trimmed on sending, untrimmed on acknowledging: the count drifted until characters were dropped.
    for seed in 0..50 {
        let mut rng = Rng::with_seed(seed);
        let program = random(&mut rng, 20).replace("\nG1", " \nG1  ").replace('\n', "\r\n");
        let sent = transmission(&program, Check::None);
        let (mut sender, mut now, mut out) = (sender(&program), Micros::from_ms(100), Vec::new());
        for _ in 0..20_000 {
            match rng.u8(..6) {
                0 => sender.on_bytes(now, &[DC3]),
                1 => sender.hold(),
                2 => sender.resume(),
                _ => sender.on_bytes(now, &[DC1]),
            }
            out.extend(run(&mut sender, &mut now, Micros(500)));
            assert_eq!(sender.progress().0, out.len());
        }
        assert_eq!(out, sent.frames(), "seed {seed}: every character once and in order");
    }
}

#[test]
fn openbuilds_a_new_connection_does_not_go_on_by_itself() {
    // "Once switched on and press connect, Control software resumed sending GCODE."
    let (mut sender, mut now) = (sender(&long_program()), Micros(0));
    assert_eq!(run(&mut sender, &mut now, Micros::from_ms(1_000)), b"");
    let text = random(&mut Rng::with_seed(1), 20);
    let settings = control(Check::Parity, 19_200);
    let line = Line::new(settings, Micros::from_ms(1), Micros(0), &Schedule(vec![Fault::Cut(150)]));
    let mut cut = Sender::new(transmission(&text, Check::Parity), line_use(&settings, Micros(0)));
    let outcome = send(line, &mut cut, |_, _| false);
    assert!(outcome.error.is_some() && cut.progress().0 <= 160, "nothing leaves after the line has failed");
}

#[test]
fn a_block_longer_than_the_buffer_and_characters_that_command_the_line_never_leave() {
    // Comments longer than the receiver's buffer held senders up for ever; bytes from 0x80 on were taken as commands.
    let long = format!("%\n({})\nM30\n%\n", "A".repeat(1_000));
    for text in [long.as_str(), "%\n(\u{e9})\nM30\n%\n", "%\n(\u{13})\nM30\n%\n", "%\n(why?)\nM30\n%\n"] {
        assert!(Transmission::new(text.as_bytes(), |_| 1, &wire(Check::None)).is_err(), "{text}");
    }
}

#[test]
fn ugs_run_from_lacks_tool_length_cycles_and_shifted_coordinates() {
    // It rebuilt units, distance, planes, feed; not T, G43 H, G41 D, cycles, G68, G52, G92; clearance began at Z0.
    let plan_of = |program: &str| plan(program, program.lines().count() + 1).expect("a restart");
    let rich = "G21G54G0X0Y0Z-20.\nT5M6\nS900M4\nG43H7Z-10.\nG52X10.\nG68X0Y0R90.\nX5.Y5.\nG1Z-30.F50.\nX6.";
    let found = plan_of(rich);
    for words in ["G43H7", "G52X10.", "G68X0.Y0.R90.", "S900M4"] {
        place(&found, words);
    }
    assert_eq!(found.tool, Some(5));
    let drilling = plan_of("G21G0X0Y0Z5.\nG99G81Z-3.R1.F80.\nX10.\nX20.");
    assert!(drilling.blocks[place(&drilling, "G81")].ends_with("K0"), "{drilling:?}");
    for (program, word) in [("G41G1X5.D1F9.\nX6.", "G41"), ("G1X5.F9.\nG92X0\nX6.", "G92")] {
        let refusal = plan(program, program.lines().count() + 1).expect_err("no blocks lead there");
        assert!(refusal.contains(word), "{refusal}");
    }
    let text = "%\nG21G0X0Y0Z-20.\nG1Z-30.F50.\nX6.\nM30\n%\n";
    let sent = transmission(text, Check::None);
    let history =
        History { start: Start::default(), sent: [9; 2], executed: None, stopped: false, ended: None, torn: 0 };
    let low = RestartPlan::new(&sent, &history, &RestartRequest { line: Some(4), clearance: None }, &power_on())
        .expect("a restart");
    assert!(low.blocks[place(&low, "G0Z")].contains("Z-20."), "{low:?}");
}

#[test]
fn gsender_start_from_line_plunges_at_rapid_with_feed_0_before_its_coordinates() {
    // An F in a comment became feed 0; X, Y and Z went by G0 to the depth; the work offset and the spindle came after.
    let program = "G21G55G0X0Y0Z5.\nS1000M3\nG1Z-2.F300.\n(FINISH F)\nX10.\nX20.";
    let found = plan(program, 6).expect("a restart");
    let first_move = found.blocks.iter().position(|block| block.contains(['X', 'Y', 'Z'])).expect("it moves");
    assert!(place(&found, "G55") < first_move && place(&found, "S1000M3") < first_move, "{found:?}");
    let down = place(&found, "Z-2.");
    assert_eq!(found.blocks[down], "G1Z-2.F300.");
    assert!(place(&found, "M0") < down && found.blocks[down..].iter().all(|block| !block.contains(['X', 'Y'])));
    assert!(found.blocks.iter().all(|block| !block.contains("F0")), "{found:?}");
}

#[test]
fn candle_forces_m3_and_the_highest_speed_and_knows_only_g0_and_g1() {
    let program = "G21G0X0Y0Z5.\nS5000M4\nS800\nG1Z-2.F300.\nG2X10.I5.\nX20.I5.";
    let found = plan(program, 7).expect("a restart");
    place(&found, "S800M4");
    assert!(found.blocks.iter().all(|block| !block.contains("M3") && !block.contains("S5000")), "{found:?}");
    assert_eq!(found.blocks.last().map(String::as_str), Some("G2"));
}

#[test]
fn resumed_at_a_line_it_is_that_line() {
    // Off by one after a disconnect: the restart is tied to the program's lines, not to a count of answers.
    let text = random(&mut Rng::with_seed(3), 20);
    let sent = transmission(&text, Check::Parity);
    for line in 10..20 {
        let history =
            History { start: Start::default(), sent: [0; 2], executed: None, stopped: false, ended: None, torn: 0 };
        let wanted = RestartRequest { line: Some(line), clearance: Some(Nm::from_mm(50.0)) };
        let plan = RestartPlan::new(&sent, &history, &wanted, &power_on()).expect("a restart");
        let rest = sent.resumed(&plan.preamble(), plan.index, &wire(Check::Parity)).expect("in the code");
        let own = blocks(&rest)[plan.blocks.len() - 1..].to_vec();
        let lines = text.lines().skip(line - 1).filter(|line| *line != "%").map(|line| line.as_bytes().to_vec());
        assert_eq!(own, of_code(lines), "line {line}");
    }
}
