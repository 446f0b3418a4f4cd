//! Seeded faults on a line with DC1 and DC3 and without acknowledgements.
//!
//! Invariants that such a line allows:
//!
//! - I1: what was executed is the program, or the beginning of it and the fault was noticed (an alarm, an error of the sender, a
//!   program that does not end). It holds where the line, its parity or the TV check can see the fault.
//! - I3: never more than ten characters after DC3, but where DC3 itself was lost or late: then the control says PS0087.
//! - I4, I5: nothing is sent after the line has failed, and nothing continues automatically.
//! - I6: every run ends.
//!
//! Undetectable faults are counted.

use arcfeed_tests::of_full_set;
use std::collections::BTreeMap;

use arcfeed::dnc::readback::ReadBack;
use arcfeed::dnc::{Sender, State};
use arcfeed_control::ControlSettings;
use arcfeed_control::code::TapeCode;
use arcfeed_control::store::{Store, StoreState};
use arcfeed_units::Micros;
use fastrand::Rng;

use crate::dnc::line::{Line, Outcome, line_use, send};
use crate::dnc::program::{Check, blocks, control, of_code, random, transmission, wire};
use crate::dnc::schedule::{Fault, KINDS, Kind, Schedule, shrink};

const STEP: Micros = Micros::from_ms(1);
const CHECKS: [Check; 3] = [Check::None, Check::Parity, Check::ParityAndTv];

/// Result of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    /// The program was executed.
    Whole,
    /// A beginning of the program was executed, and the fault was noticed.
    Stopped,
    /// Something else was executed, and the fault was noticed too late for that block.
    NoticedLate,
    /// Something else was executed, unnoticed.
    Unnoticed,
}

/// Runs a program under a schedule.
fn run(text: &str, check: Check, schedule: &Schedule) -> (Verdict, Outcome) {
    let sent = transmission(text, check);
    let settings = control(check, 19_200);
    let line = Line::new(settings, STEP, Micros(0), schedule);
    let mut sender = Sender::new(sent.clone(), line_use(&settings, Micros(0)));
    let mut outcome = send(line, &mut sender, |_, _| false);
    outcome.line.run_out();
    let executed = of_code(outcome.line.control.executed().iter().cloned());
    let wanted = blocks(&sent);
    let is_noticed = outcome.error.is_some()
        || outcome.line.control.alarm().is_some()
        || matches!(outcome.state, State::Failed(_))
        || !outcome.line.control.has_ended();
    let verdict = match (executed == wanted, wanted.starts_with(&executed), is_noticed) {
        (true, ..) => Verdict::Whole,
        (false, true, true) => Verdict::Stopped,
        (false, false, true) => Verdict::NoticedLate,
        (false, _, false) => Verdict::Unnoticed,
    };
    (verdict, outcome)
}

/// Whether this kind of fault must be detected with this check; otherwise it is only counted.
fn is_seen(kind: Kind, check: Check) -> bool {
    match check {
        Check::None => kind.is_of_the_line(),
        Check::Parity => kind.is_of_the_line() || matches!(kind, Kind::OneBit | Kind::BitsApart),
        Check::ParityAndTv => {
            kind.is_of_the_line() || matches!(kind, Kind::OneBit | Kind::BitsApart | Kind::Lost | Kind::Twice)
        }
    }
}

fn case(seed: u64, kind: Kind, check: Check) -> (String, Schedule) {
    let mut rng = Rng::with_seed(seed);
    let blocks = rng.usize(8..30);
    let text = random(&mut rng, blocks);
    let len = transmission(&text, check).frames().len();
    let schedule = kind.draw(&mut rng, len);
    (text, schedule)
}

/// Message if a run violates a required property.
fn breaks(text: &str, kind: Kind, check: Check, schedule: &Schedule) -> Option<String> {
    let (verdict, outcome) = run(text, check, schedule);
    if is_seen(kind, check) && matches!(verdict, Verdict::Unnoticed | Verdict::NoticedLate) {
        return Some(format!("{verdict:?}"));
    }
    let after = outcome.line.control.line_counters().max_bytes_after_xoff;
    let xoff_is_in_time = !schedule.0.iter().any(|fault| {
        matches!(
            fault,
            Fault::RxLost(_)
                | Fault::RxFlip(..)
                | Fault::RxLate(..)
                | Fault::Garbage(_)
                | Fault::TxTwice(_)
                | Fault::TxLate(..)
        )
    });
    (xoff_is_in_time && after > 10).then(|| format!("{after} characters after DC3"))
}

#[test]
fn detectable_line_faults_are_never_missed() {
    let cases = of_full_set(200, 10);
    let mut counts: BTreeMap<(Kind, Check), [u32; 4]> = BTreeMap::new();
    for (kind, check) in KINDS.iter().flat_map(|kind| CHECKS.map(|check| (*kind, check))) {
        for seed in 0..cases {
            let (text, schedule) = case(seed, kind, check);
            if let Some(what) = breaks(&text, kind, check, &schedule) {
                let least = shrink(&schedule, |fewer| breaks(&text, kind, check, fewer).is_some());
                panic!("{kind:?}, {check:?}, seed {seed}: {what}; least schedule {least:?} for\n{text}");
            }
            let (verdict, _) = run(&text, check, &schedule);
            counts.entry((kind, check)).or_default()[verdict as usize] += 1;
        }
    }
    println!("{} schedules; whole, stopped, noticed late, unnoticed:", cases * 3 * KINDS.len() as u64);
    for ((kind, check), [whole, stopped, late, unnoticed]) in &counts {
        println!("{kind:?} {check:?}: {whole} {stopped} {late} {unnoticed}");
    }
    let unnoticed = |check| KINDS.iter().map(|kind| counts[&(*kind, check)][3]).sum::<u32>();
    let [none, parity, tv] = CHECKS.map(unnoticed);
    assert!(none > parity && parity > tv, "each check sees more: {none}, {parity}, {tv}");
}

/// Output of a control that stores these characters and punches them; `None` if it refuses them.
fn stored_and_punched(settings: &ControlSettings, frames: &[u8]) -> Option<ReadBack> {
    let mut store = Store::new(settings.line);
    let mut back = ReadBack::new(
        wire(if settings.line.tape.code == Some(TapeCode::Ascii) { Check::None } else { Check::Parity }).encode,
    );
    store.port().on_bytes(frames);
    for ms in 0..20_000 {
        store.step(STEP);
        if let StoreState::Refused(_) = store.state() {
            return None;
        }
        if ms == 5_000 {
            // A program without its last `%` is not stored: the operator ends the reading, and looks at what is there.
            store.punch();
        }
        let said: Vec<u8> = std::iter::from_fn(|| store.port().poll_transmit()).collect();
        if ms >= 5_000 && back.take(&said) {
            break;
        }
    }
    Some(back)
}

#[test]
fn program_read_back_shows_every_change() {
    let without_blanks = |blocks: &[Vec<u8>]| -> Vec<Vec<u8>> {
        let is_kept =
            |block: &Vec<u8>| block.iter().copied().filter(|byte| block.contains(&b'(') || *byte != b' ').collect();
        blocks.iter().map(is_kept).collect()
    };
    let (mut runs, mut altered, mut refused, mut reported) = (0, 0, 0, 0);
    let kinds = KINDS.into_iter().filter(|kind| !kind.is_of_the_line());
    for (kind, check) in kinds.flat_map(|kind| CHECKS.map(|check| (kind, check))) {
        for seed in 0..of_full_set(200, 10) {
            let (text, schedule) = case(seed, kind, check);
            let (verdict, outcome) = run(&text, check, &schedule);
            let sent = transmission(&text, check);
            runs += 1;
            let executed = of_code(outcome.line.control.executed().iter().cloned());
            let is_altered =
                verdict == Verdict::Unnoticed && without_blanks(&executed) != without_blanks(&blocks(&sent));
            altered += u32::from(is_altered);
            let settings = control(check, 19_200);
            let is_noticed = match stored_and_punched(&settings, &outcome.line.arrived) {
                None => {
                    refused += 1;
                    true
                }
                Some(back) => {
                    let differs = back.compare(&sent).is_err();
                    reported += u32::from(differs);
                    differs
                }
            };
            assert!(is_noticed || !is_altered, "{kind:?}, {check:?}, seed {seed}: {schedule:?}\n{text}");
        }
    }
    println!(
        "read-back of {runs} programs: {refused} refused when stored, {reported} differences reported; of {altered} that are executed as \
         something else without a message: 0 not reported"
    );
    assert!(reported > 0 && altered > 0);
}

#[test]
fn nothing_leaves_after_the_line_has_failed() {
    for seed in 0..20 {
        let (text, schedule) = case(seed, Kind::Cut, Check::Parity);
        let (verdict, outcome) = run(&text, Check::Parity, &schedule);
        let Fault::Cut(at) = schedule.0[0] else { panic!("{schedule:?}") };
        assert!(outcome.error.is_some() && outcome.line.arrived.len() == at, "{verdict:?}");
        assert!(matches!(verdict, Verdict::Stopped | Verdict::Whole), "{verdict:?}");
    }
}
