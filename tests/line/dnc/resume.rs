//! The sender ends at any point, by a kill or a cut line, and the program is taken up from its journal: no cutting block is
//! left out or cut again without a message, and the control's modal state is the one it would have had.

use arcfeed::dnc::functions::Functions;
use arcfeed::dnc::journal::{EndReason, Record, Start, first_line, line as record_line, read};
use arcfeed::dnc::resume::{RestartPlan, RestartRequest};
use arcfeed::dnc::sender::Gate;
use arcfeed::dnc::transmission::Transmission;
use arcfeed::dnc::{Sender, State};
use arcfeed_control::{Control, ControlSettings};
use arcfeed_nc::block::{Reading, parse_line};
use arcfeed_nc::modal::Modal;
use arcfeed_tests::of_full_set;
use arcfeed_units::{Micros, Nm};
use fastrand::Rng;

use crate::dnc::line::{Line, line_use, send};
use crate::dnc::program::{Check, control, power_on, random_with_offsets, transmission, wire};
use crate::dnc::schedule::{Fault, Schedule};

const STEP: Micros = Micros::from_ms(1);
/// Characters that one record permits.
const AHEAD: usize = 60;

/// State that a stopped sender left.
struct Broken {
    journal: Vec<u8>,
    line: Line,
}

/// Sends with a journal, as the command does, until the sender is killed after `turns` of its loop or the line is cut.
fn broken(sent: &Transmission, settings: &ControlSettings, turns: usize, schedule: &Schedule, knows: bool) -> Broken {
    let start = Start { bytes: sent.frames().len(), ..Start::default() };
    let mut journal = first_line(&start).into_bytes();
    let (mut number, mut until, mut executed, mut turn) = (0, 0, 0, 0);
    let mut write = |record: &Record, journal: &mut Vec<u8>| {
        number += 1;
        journal.extend(record_line(number, record).bytes());
    };
    let mut sender = Sender::new(sent.clone(), line_use(settings, Micros(0)));
    sender.permit(Gate::Journal, 0);
    let line = Line::new(*settings, STEP, Micros(0), schedule);
    let outcome = send(line, &mut sender, |line, sender| {
        let now = line.control.executed().len();
        if knows && now > executed {
            executed = now;
            write(&Record::Executed { blocks: now, stopped: false }, &mut journal);
        }
        let (out, total) = sender.progress();
        if until < total && until < out + AHEAD / 2 {
            until = sent.start_of(sent.line_at((out + AHEAD).min(total - 1)) + 1);
            write(&Record::Out { sent: out.saturating_sub(10), until }, &mut journal);
            sender.permit(Gate::Journal, until);
        }
        turn += 1;
        turn > turns
    });
    if outcome.error.is_some() {
        write(&Record::End { sent: sender.progress().0, reason: EndReason::Failed }, &mut journal);
    }
    Broken { journal, line: outcome.line }
}

/// The state of a control that has read exactly these lines, and its M, S and T functions.
fn state_after(settings: ControlSettings, text: &[u8]) -> (Modal, Functions) {
    let mut control = Control::from_memory(settings, text);
    let mut now = Micros(0);
    while !control.is_over() && now < Micros::from_ms(600_000) {
        now = now.after(STEP);
        control.step(now, STEP, 100);
    }
    let mut functions = Functions::default();
    for block in control.executed() {
        if let Ok(parsed) = parse_line(block, Reading::Lenient) {
            functions.take(&parsed.block);
        }
    }
    (*control.modal(), functions)
}

/// Cutting lines, found without the interpreter: those with an axis word, and not under G0; in a cycle all lines. The words of
/// G52 cause no motion.
fn cutting_lines(text: &str) -> Vec<bool> {
    let (mut rapid, mut drills) = (true, false);
    let lines = text.lines().map(|line| {
        let code = if line.starts_with('(') { "" } else { line };
        rapid = if code.contains("G0") {
            true
        } else {
            rapid && !["G1", "G3"].iter().any(|word| code.contains(word) && !code.contains("G17"))
        };
        drills = code.contains("G81") || (drills && !code.contains("G80"));
        let names_axis = !code.contains("G52") && (code.contains('X') || code.contains('Y') || code.contains('Z'));
        names_axis && (drills || !rapid)
    });
    lines.collect()
}

/// Takes a broken transmission up and checks everything that is promised of it.
fn check(text: &str, sent: &Transmission, broken: Broken, aside: usize, what: &str) -> bool {
    let settings = &control(Check::Parity, 19_200);
    let history = read(&broken.journal).unwrap_or_else(|damage| panic!("{what}: {damage}"));
    let arrived = broken.line.arrived.len();
    assert!(
        (history.sent[0]..=history.sent[1]).contains(&arrived),
        "{what}: {arrived} arrived, reported {:?}",
        history.sent
    );
    let known = history.executed.map(|_| broken.line.control.executed().len());
    assert!(history.executed <= known, "{what}: {:?} executed, reported {:?}", known, history.executed);
    // The operator sees at the control the block that was started last.
    let seen = sent.line_of_block(broken.line.control.executed().len().max(1)).unwrap_or(1);
    // Mostly there, sometimes elsewhere.
    let from = (seen + sent.lines().len() + aside - 5).clamp(sent.lines().len() + 1, 2 * sent.lines().len() - 3)
        - sent.lines().len();
    let wanted = RestartRequest { line: Some(sent.lines()[from].source), clearance: Some(Nm::from_mm(20.0)) };
    let plan = match RestartPlan::new(sent, &history, &wanted, &power_on()) {
        Ok(plan) => plan,
        Err(why) => {
            assert!(why.contains("ends the program"), "{what}: {why}");
            return false;
        }
    };
    assert_reported(text, &plan, seen, what);
    // The rest goes to a control fresh from power-on.
    let rest = sent.resumed(&plan.preamble(), plan.index, &wire(Check::Parity)).expect("our blocks are in the code");
    let line = Line::new(*settings, STEP, Micros(0), &Schedule::default());
    let mut sender = Sender::new(rest, line_use(settings, Micros(0)));
    let outcome = send(line, &mut sender, |_, _| false);
    let resumed = outcome.line.control;
    assert!(
        outcome.state == State::Sent && resumed.alarm().is_none() && resumed.has_ended(),
        "{what}: {:?}",
        resumed.alarm()
    );
    let ours = plan.blocks.iter().skip(1).count();
    let wanted: Vec<&[u8]> = (plan.index..sent.lines().len())
        .filter(|line| sent.is_block(*line))
        .filter_map(|line| sent.line_text(line))
        .collect();
    let found: Vec<Vec<u8>> = resumed.executed()[ours..].iter().map(|block| [block, &b"\n"[..]].concat()).collect();
    assert_eq!(found, wanted, "{what}: the blocks behind line {}", plan.line);
    // And it begins in the state that it would have met.
    let before = [&sent.text()[..sent.start_of(plan.index)], b"M30\n"].concat();
    let preamble = [plan.preamble().as_bytes(), b"M30\n"].concat();
    let (own, restored) = (state_after(*settings, &before), state_after(*settings, &preamble));
    let ((mut modal, on), (found, found_on)) = (own, restored);
    // No restart changes the tool: it stays in the spindle, unstated.
    modal.machining_state = found.machining_state;
    assert_eq!(format!("{modal:#?}"), format!("{found:#?}"), "{what}: modal state at line {}", plan.line);
    // M5 and M9 are power-on; the tool stays in the spindle.
    assert_eq!((on.spindle, on.coolant), (found_on.spindle, found_on.coolant), "{what}: at line {}", plan.line);
    assert_eq!(plan.tool, on.tool, "{what}");
    true
}

/// Cutting blocks that come again or do not come are in the plan, counted by another reading of the program.
fn assert_reported(text: &str, plan: &RestartPlan, seen: usize, what: &str) {
    let cuts = cutting_lines(text);
    let count = |from: usize, to: usize| {
        let among = cuts.get(from..to.min(cuts.len())).unwrap_or_default();
        among.iter().filter(|cuts| **cuts).count()
    };
    // Taken up, the last of them perhaps not done: index of the line behind it.
    let done = seen + 1;
    let (again, left_out) = (count(plan.index, done), count(done, plan.index));
    assert!(
        plan.repeated.count <= again && again <= plan.repeated.count + plan.possibly_repeated.count,
        "{what}: {again}, {plan:?}"
    );
    assert!(plan.skipped.count <= left_out, "{what}: {left_out}, {plan:?}");
    assert!(left_out <= plan.skipped.count + plan.possibly_skipped.count, "{what}: {left_out}, {plan:?}");
}

/// By how many lines the operator goes elsewhere, five being none.
fn aside(rng: &mut Rng) -> usize {
    if rng.bool() { 5 } else { rng.usize(..10) }
}

/// A case: its program, and how many characters it has.
fn case(seed: u64) -> (Rng, String, Transmission, ControlSettings) {
    let mut rng = Rng::with_seed(seed);
    let blocks = rng.usize(8..40);
    let text = random_with_offsets(&mut rng, blocks);
    let sent = transmission(&text, Check::Parity);
    (rng, text, sent, control(Check::Parity, 19_200))
}

#[test]
fn a_sender_killed_anywhere_is_taken_up_without_a_secret() {
    let (cases, mut resumed) = (of_full_set(200, 25), 0);
    for seed in 0..cases {
        let (mut rng, text, sent, settings) = case(seed);
        let turns = rng.usize(1..3 * sent.frames().len());
        let knows = rng.bool();
        let mut broken = broken(&sent, &settings, turns, &Schedule::default(), knows);
        // A record that was being written.
        if rng.bool() {
            broken.journal.extend(record_line(999, &Record::Out { sent: 1, until: 2 }).bytes().take(rng.usize(..30)));
        }
        broken.line.run_out();
        resumed += u64::from(check(
            &text,
            &sent,
            broken,
            aside(&mut rng),
            &format!("seed {seed}, killed after {turns} turns"),
        ));
    }
    println!("{resumed} of {cases} taken up");
    assert!(5 * resumed > 4 * cases, "{resumed} of {cases}");
}

#[test]
fn a_line_cut_anywhere_is_taken_up_without_a_secret() {
    let (cases, mut resumed) = (of_full_set(200, 25), 0);
    for seed in 1_000..1_000 + cases {
        let (mut rng, text, sent, settings) = case(seed);
        let at = rng.usize(1..sent.frames().len());
        let knows = rng.bool();
        let mut broken = broken(&sent, &settings, usize::MAX, &Schedule(vec![Fault::Cut(at)]), knows);
        broken.line.run_out();
        resumed += u64::from(check(&text, &sent, broken, aside(&mut rng), &format!("seed {seed}, cut at {at}")));
    }
    println!("{resumed} of {cases} taken up");
    assert!(5 * resumed > 4 * cases, "{resumed} of {cases}");
}

#[test]
fn half_a_block_in_a_control_without_a_reset_never_moves() {
    let mut refused = 0;
    for seed in 0..20 {
        let (mut rng, text, sent, settings) = case(seed);
        let first = rng.usize(8..sent.lines().len() - 4);
        let line = (first..).find(|line| sent.is_block(*line)).expect("M30 at last");
        let at = sent.start_of(line) + rng.usize(1..sent.line_text(line).map_or(2, <[u8]>::len));
        let mut broken = broken(&sent, &settings, usize::MAX, &Schedule(vec![Fault::Cut(at)]), false);
        broken.line.run_out();
        let taken = broken.line.control.executed().len();
        // The next transmission, to a control that goes on asking.
        let late = Micros::from_ms(9_000);
        let mut next = Sender::new(transmission(&text, Check::Parity), line_use(&settings, Micros(0)));
        let mut out = [0; 10];
        assert_eq!(next.poll_transmit(late, &mut out), 0, "nothing leaves without a DC1");
        next.on_bytes(late, &[0x11]);
        let len = next.poll_transmit(late, &mut out);
        assert!(len > 0);
        broken.line.control.port().on_bytes(&out[..len]);
        broken.line.control.port().on_bytes(&sent.frames()[len..100]);
        for _ in 0..2_000 {
            broken.line.tick();
        }
        let control = &broken.line.control;
        let more = &control.executed()[taken..];
        // An alarm, or the rest of a comment; then the program comes from its beginning.
        let is_refused = control.alarm().is_some() && more.is_empty();
        assert!(is_refused || more.first().is_some_and(|block| block.starts_with(b"(")), "seed {seed}: {more:?}");
        refused += usize::from(is_refused);
    }
    assert!(refused > 10, "{refused}");
}
