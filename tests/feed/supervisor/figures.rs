//! Times from a fault to its safe output, measured and compared with `docs/safety.md`.

use arcfeed_firmware::supervisor::report::Alarm;
use arcfeed_firmware::supervisor::signals::{BoardFault, Signals};

use crate::supervisor::bench::{Bench, Piece};
use crate::supervisor::document::table;

/// Ticks until `is_safe` holds, counting the tick that sees the fault first as 1. From the worst level, 200 %.
fn ticks(turn: impl Fn(&mut Bench), is_safe: impl Fn(u8, Alarm) -> bool) -> u32 {
    let mut bench = Bench::running(Piece::Wants(200));
    assert_eq!(bench.tick().feed_override.percent, 200);
    for tick in 1..5_000 {
        turn(&mut bench);
        let output = bench.tick();
        if is_safe(output.feed_override.percent, output.alarm) {
            return tick;
        }
    }
    panic!("never safe")
}

fn silence(bench: &mut Bench) {
    bench.position.age = bench.position.age.longer_by(bench.dt);
}

fn link_silence(bench: &mut Bench) {
    bench.link.age = bench.link.age.longer_by(bench.dt);
}

fn garbage(bench: &mut Bench) {
    silence(bench);
    bench.position.invalid_in_row = bench.position.invalid_in_row.saturating_add(1);
}

fn measured() -> Vec<(&'static str, u32)> {
    let at_most_100 = |percent: u8, _| percent <= 100;
    let latched = |_, alarm| alarm == Alarm::Latched;
    let fault = |fault| move |bench: &mut Bench| bench.fault = Some(fault);
    let condition = |condition| move |bench: &mut Bench| bench.conditions = condition;
    let dial = |percent| move |bench: &mut Bench| bench.dial = percent;
    let begin_once = |piece| {
        move |bench: &mut Bench| {
            if bench.work.is_none_or(|(_, now)| now != piece) {
                bench.begin(piece);
            }
        }
    };
    vec![
        ("watchdog", ticks(fault(BoardFault::Watchdog), |percent, _| percent == 0)),
        ("corrupt parameters", ticks(fault(BoardFault::Parameters), |percent, _| percent == 0)),
        ("board fault", ticks(fault(BoardFault::Hardware), |percent, _| percent == 0)),
        ("dial down to 80", ticks(dial(80), |percent, _| percent <= 80)),
        ("dial down to 0", ticks(dial(0), |percent, _| percent == 0)),
        ("position silent: alarm", ticks(silence, latched)),
        ("position silent: 100 %", ticks(silence, at_most_100)),
        ("link silent: alarm", ticks(link_silence, latched)),
        ("link silent: 100 %", ticks(link_silence, at_most_100)),
        ("invalid frames only: alarm", ticks(garbage, latched)),
        ("invalid frames only: 100 %", ticks(garbage, at_most_100)),
        ("G41/G42 or #3004: 100 %", ticks(condition(Signals::CUTTER_COMPENSATION), at_most_100)),
        ("tapping, threading, G63, rapid by a signal: 100 %", ticks(condition(Signals::TAPPING), at_most_100)),
        ("a block without feed per minute: 100 %", ticks(begin_once(Piece::Rapid), at_most_100)),
        ("a block without a law: 100 %", ticks(begin_once(Piece::Line), at_most_100)),
        ("spindle speed not a number: 100 %", ticks(|bench| bench.spindle.0 = f32::NAN, at_most_100)),
    ]
}

#[test]
fn the_document_quotes_the_times_that_are_measured() {
    let rows: Vec<String> = measured()
        .into_iter()
        .map(|(what, ticks)| format!("{what} | {ticks} | {ticks}"))
        .inspect(|row| println!("| {row} |"))
        .collect();
    let quoted: Vec<String> = table("Times").into_iter().map(|row| row[..3].join(" | ")).collect();
    assert_eq!(quoted, rows);
}
