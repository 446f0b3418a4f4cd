//! Additional detection by the control's reports (`[dnc] report_every`) and by `verify`, beyond parity and TV check.

use arcfeed_tests::of_full_set;
use std::collections::BTreeMap;

use arcfeed::dnc::reports::{ReportFinding, Reports};
use arcfeed::dnc::transmission::Transmission;
use arcfeed::dnc::{Sender, State};
use arcfeed_control::ControlSettings;
use arcfeed_control::line::LineSettings;
use arcfeed_units::Micros;
use fastrand::Rng;

use crate::dnc::line::{Line, line_use, send};
use crate::dnc::program::{Check, blocks, control, of_code, power_on, random, random_with_offsets, transmission, wire};
use crate::dnc::schedule::{KINDS, Kind, Schedule};

const STEP: Micros = Micros::from_ms(1);
const CHECKS: [Check; 3] = [Check::None, Check::Parity, Check::ParityAndTv];

/// Result of a run.
struct Run {
    is_whole: bool,
    is_reported: bool,
    confirmed: usize,
    asked: usize,
    remarks: Vec<ReportFinding>,
}

fn with_reports(text: &str, check: Check, every: Option<usize>) -> (Transmission, Reports) {
    let sent = transmission(text, check);
    match every {
        Some(every) => Reports::insert_into(&sent, every, &power_on(), &wire(check)).expect("in the code"),
        None => (sent, Reports::default()),
    }
}

/// The program's own blocks.
fn own(blocks: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
    let is_report =
        |block: &Vec<u8>| ["POPEN", "PCLOS", "DPRNT["].iter().any(|begin| block.starts_with(begin.as_bytes()));
    blocks.into_iter().filter(|block| !is_report(block)).collect()
}

/// The buffer of a 0i: one that has said DC3 says DC1 again only when a block as long as a report has become whole.
fn roomy(check: Check) -> ControlSettings {
    let settings = control(check, 19_200);
    let line = LineSettings { buffer: 512, xoff_below: 128, xon_above: 384, ..settings.line };
    ControlSettings { line, ..settings }
}

/// Sends a program under a schedule and hears the reports to the last.
fn run((sent, mut reports): (Transmission, Reports), check: Check, schedule: &Schedule) -> Run {
    let settings = roomy(check);
    let line = Line::new(settings, STEP, Micros(0), schedule);
    let wanted = own(blocks(&sent));
    let mut sender = Sender::new(sent, line_use(&settings, Micros(0)));
    let mut remarks = Vec::new();
    let mut outcome = send(line, &mut sender, |_, sender| {
        remarks.extend(reports.read_printed(&sender.take_printed()));
        false
    });
    outcome.line.run_out();
    for _ in 0..500 {
        outcome.line.tick();
    }
    sender.on_bytes(outcome.line.now, &outcome.line.take_inbox());
    remarks.extend(reports.read_printed(&sender.take_printed()));
    let control = &outcome.line.control;
    let (asked, confirmed) = reports.counts();
    Run {
        is_whole: own(of_code(control.executed().iter().cloned())) == wanted,
        is_reported: outcome.error.is_some()
            || control.alarm().is_some()
            || matches!(outcome.state, State::Failed(_))
            || !control.has_ended()
            || !remarks.is_empty()
            || reports.awaited().is_some(),
        confirmed,
        asked,
        remarks,
    }
}

#[test]
fn every_report_of_a_line_without_faults_confirms_the_program() {
    let mut reports = 0;
    for seed in 0..of_full_set(200, 20) {
        let mut rng = Rng::with_seed(seed);
        let blocks = rng.usize(8..30);
        let text = if rng.bool() { random(&mut rng, blocks) } else { random_with_offsets(&mut rng, blocks) };
        let every = rng.usize(1..12);
        let found = run(with_reports(&text, Check::ParityAndTv, Some(every)), Check::ParityAndTv, &Schedule::default());
        assert_eq!(found.remarks, [], "seed {seed}, every {every}:\n{text}");
        let (asked, confirmed) = (found.asked, found.confirmed);
        let is_clean = found.is_whole && !found.is_reported && asked > 0;
        assert!(is_clean, "seed {seed}, every {every}, {confirmed} of {asked}, whole {}:\n{text}", found.is_whole);
        assert_eq!(confirmed, asked, "seed {seed}");
        reports += asked;
    }
    println!("{reports} reports, all as the program has it");
}

#[test]
fn reports_show_most_of_what_parity_and_tv_let_pass() {
    let cases = of_full_set(200, 10);
    let kinds: Vec<Kind> = KINDS.into_iter().filter(|kind| !kind.is_of_the_line()).collect();
    let manners = [None, Some(10), Some(1)];
    let mut unnoticed: BTreeMap<(Kind, Check), [u32; 3]> = BTreeMap::new();
    for (kind, check) in kinds.iter().flat_map(|kind| CHECKS.map(|check| (*kind, check))) {
        for (context, every) in manners.into_iter().enumerate() {
            for seed in 0..cases {
                let mut rng = Rng::with_seed(seed);
                let blocks = rng.usize(8..30);
                let text = random(&mut rng, blocks);
                let sent = with_reports(&text, check, every);
                let schedule = kind.draw(&mut rng, sent.0.frames().len());
                let found = run(sent, check, &schedule);
                unnoticed.entry((kind, check)).or_default()[context] +=
                    u32::from(!found.is_whole && !found.is_reported);
            }
        }
    }
    println!("unnoticed of {cases}: without reports, with one behind every 10th block, behind each");
    for ((kind, check), [without, some, all]) in &unnoticed {
        println!("{kind:?} {check:?}: {without} {some} {all}");
    }
    let sums = [0, 1, 2].map(|context| unnoticed.values().map(|counts| counts[context]).sum::<u32>());
    println!("of {} altered programs each: {sums:?}", cases as usize * unnoticed.len());
    assert!(sums[2] * 3 < sums[0] && sums[1] < sums[0], "{sums:?}");
}
