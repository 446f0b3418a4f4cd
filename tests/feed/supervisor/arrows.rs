//! One test per arrow of the diagram in `firmware/src/supervisor/state.rs`, named after it.

use arcfeed_firmware::supervisor::input::Source;
use arcfeed_firmware::supervisor::signals::{BoardFault, Condition, Inhibit, Request, Signals};
use arcfeed_firmware::supervisor::state::{Disarm, Hold, State};
use arcfeed_model::job::OverrideLimits;

use crate::supervisor::bench::{Bench, Piece, name};

const PIECE: Piece = Piece::Wants(120);

fn holding() -> Bench {
    let mut bench = Bench::running(PIECE);
    bench.conditions = Signals::FEED_HOLD;
    bench.tick();
    bench
}

fn inhibited() -> Bench {
    let mut bench = Bench::running(PIECE);
    bench.conditions = Signals::TAPPING;
    bench.tick();
    bench
}

fn fallen_back() -> Bench {
    let mut bench = Bench::running(PIECE);
    bench.silence(51);
    bench
}

fn disarmed() -> Bench {
    let mut bench = Bench::running(PIECE);
    bench.ask(Request::Disarm);
    bench
}

fn faulted() -> Bench {
    let mut bench = Bench::running(PIECE);
    bench.fault = Some(BoardFault::Watchdog);
    bench.tick();
    bench
}

#[track_caller]
fn goes(mut bench: Bench, from: &str, turn: impl Fn(&mut Bench), to: &str) -> Bench {
    assert_eq!(name(&bench.state()), from);
    turn(&mut bench);
    let output = bench.tick();
    assert_eq!((name(&output.state), name(&bench.state())), (to, to));
    bench
}

fn arm(bench: &mut Bench) {
    bench.request = Some(Request::Arm);
}

fn disarm(bench: &mut Bench) {
    bench.request = Some(Request::Disarm);
}

fn fail(bench: &mut Bench) {
    bench.fault = Some(BoardFault::Hardware);
}

fn lose(bench: &mut Bench) {
    bench.position.invalid_in_row = 5;
}

fn reduce(bench: &mut Bench) {
    bench.dial = 80;
}

fn compensate(bench: &mut Bench) {
    bench.conditions = bench.conditions.with(Signals::CUTTER_COMPENSATION);
}

fn tap(bench: &mut Bench) {
    bench.conditions = Signals::TAPPING;
}

fn hold(bench: &mut Bench) {
    bench.conditions = Signals::FEED_HOLD;
}

fn release(bench: &mut Bench) {
    bench.conditions = Signals::NONE;
}

fn end_block(bench: &mut Bench) {
    (bench.work, bench.conditions) = (None, Signals::NONE);
}

/// Disarms an engaged state in three ways: by the operator, on request, by a condition.
fn disarms_three_ways(bench: &Bench, from: &str) {
    let by = |bench: Bench| match bench.state() {
        State::Disarmed { by } => by,
        other => panic!("{other:?}"),
    };
    let operator = Disarm::Operator { lowest_percent: 80, raised: false };
    assert_eq!(by(goes(bench.clone(), from, reduce, "disarmed")), operator);
    assert_eq!(by(goes(bench.clone(), from, disarm, "disarmed")), Disarm::Request);
    let condition = Disarm::Condition(Condition::CutterCompensation);
    assert_eq!(by(goes(bench.clone(), from, compensate, "disarmed")), condition);
    let off = |bench: &mut Bench| bench.conditions = Signals::OVERRIDE_OFF;
    assert_eq!(by(goes(bench.clone(), from, off, "disarmed")), Disarm::Condition(Condition::OverrideOff));
}

#[test]
fn idle_to_armed() {
    goes(Bench::standard(), "idle", arm, "armed");
}

#[test]
fn idle_to_faulted() {
    goes(Bench::standard(), "idle", fail, "faulted");
}

#[test]
fn armed_to_running() {
    let mut bench = goes(Bench::armed(), "armed", |bench| bench.begin(PIECE), "running");
    assert_eq!(bench.run(1_000).feed_override.percent, 120);
}

#[test]
fn armed_to_holding() {
    let begin_held = |bench: &mut Bench| {
        bench.begin(PIECE);
        hold(bench);
    };
    goes(Bench::armed(), "armed", begin_held, "holding");
}

#[test]
fn armed_to_inhibited() {
    let bench = goes(Bench::armed(), "armed", |bench| bench.begin(Piece::Rapid), "inhibited");
    assert_eq!(bench.state(), State::Inhibited { why: Inhibit::NoFeed });
}

#[test]
fn armed_to_fallback() {
    goes(Bench::armed(), "armed", lose, "fallback");
}

#[test]
fn armed_to_disarmed() {
    disarms_three_ways(&Bench::armed(), "armed");
}

#[test]
fn armed_to_faulted() {
    goes(Bench::armed(), "armed", fail, "faulted");
}

#[test]
fn running_to_armed() {
    goes(Bench::running(PIECE), "running", end_block, "armed");
}

#[test]
fn running_to_holding() {
    let bench = goes(Bench::running(PIECE), "running", hold, "holding");
    assert_eq!(bench.state(), State::Holding { cause: Hold::Feed });
    let mut bench = Bench::new(OverrideLimits { min_percent: 0, ..OverrideLimits::default() });
    bench.tick();
    bench.ask(Request::Arm);
    bench.begin(Piece::Wants(0));
    bench.tick();
    assert_eq!(bench.state(), State::Holding { cause: Hold::ZeroOverride });
}

#[test]
fn running_to_inhibited() {
    for (condition, why) in [
        (Signals::TAPPING, Inhibit::Tapping),
        (Signals::THREADING, Inhibit::Threading),
        (Signals::FEED_FORCED, Inhibit::FeedForced),
        (Signals::RAPID, Inhibit::Rapid),
    ] {
        let bench = goes(Bench::running(PIECE), "running", |bench| bench.conditions = condition, "inhibited");
        assert_eq!(bench.state(), State::Inhibited { why });
    }
}

#[test]
fn running_to_fallback() {
    let bench = goes(Bench::running(PIECE), "running", lose, "fallback");
    assert!(matches!(bench.state(), State::Fallback { source: Source::Position, .. }));
    let bench = goes(Bench::running(PIECE), "running", |bench| bench.link.invalid_in_row = 5, "fallback");
    assert!(matches!(bench.state(), State::Fallback { source: Source::Link, .. }));
}

#[test]
fn running_to_disarmed() {
    disarms_three_ways(&Bench::running(PIECE), "running");
}

#[test]
fn running_to_faulted() {
    for fault in [BoardFault::Watchdog, BoardFault::Parameters, BoardFault::Hardware] {
        let bench = goes(Bench::running(PIECE), "running", |bench| bench.fault = Some(fault), "faulted");
        assert_eq!(bench.state(), State::Faulted { fault });
    }
}

#[test]
fn holding_to_running() {
    let mut bench = holding();
    bench.run(2_000);
    let mut bench = goes(bench, "holding", release, "running");
    assert_eq!(bench.run(1_000).feed_override.percent, 120);
}

#[test]
fn holding_to_armed() {
    goes(holding(), "holding", end_block, "armed");
}

#[test]
fn holding_to_inhibited() {
    goes(holding(), "holding", tap, "inhibited");
}

#[test]
fn holding_to_fallback() {
    goes(holding(), "holding", lose, "fallback");
}

#[test]
fn holding_to_disarmed() {
    disarms_three_ways(&holding(), "holding");
}

#[test]
fn holding_to_faulted() {
    goes(holding(), "holding", fail, "faulted");
}

#[test]
fn inhibited_to_running() {
    goes(inhibited(), "inhibited", release, "running");
}

#[test]
fn inhibited_to_armed() {
    goes(inhibited(), "inhibited", end_block, "armed");
}

#[test]
fn inhibited_to_holding() {
    goes(inhibited(), "inhibited", hold, "holding");
}

#[test]
fn inhibited_to_fallback() {
    goes(inhibited(), "inhibited", lose, "fallback");
}

#[test]
fn inhibited_to_disarmed() {
    disarms_three_ways(&inhibited(), "inhibited");
}

#[test]
fn inhibited_to_faulted() {
    goes(inhibited(), "inhibited", fail, "faulted");
}

#[test]
fn fallback_to_armed() {
    let mut bench = fallen_back();
    bench.position.age = Default::default();
    bench.run(500);
    let mut bench = goes(bench, "fallback", arm, "armed");
    bench.request = None;
    bench.run(100);
    assert_eq!(bench.state(), State::Armed, "the block in work was out of sight");
    bench.begin(PIECE);
    bench.tick();
    assert_eq!(bench.state(), State::Running);
}

#[test]
fn fallback_to_disarmed() {
    goes(fallen_back(), "fallback", disarm, "disarmed");
}

#[test]
fn fallback_to_faulted() {
    goes(fallen_back(), "fallback", fail, "faulted");
}

#[test]
fn disarmed_to_armed() {
    goes(disarmed(), "disarmed", arm, "armed");
}

#[test]
fn disarmed_to_faulted() {
    goes(disarmed(), "disarmed", fail, "faulted");
}

#[test]
fn faulted_to_idle() {
    let reset = |bench: &mut Bench| (bench.fault, bench.request) = (None, Some(Request::Reset));
    let bench = goes(faulted(), "faulted", reset, "idle");
    assert_eq!(bench.memory.counters().faults, 1);
}
