//! One test per row of the policy, and per rule of precedence.

use arcfeed_firmware::supervisor::report::{Alarm, Limit, Reason, Refusal};
use arcfeed_firmware::supervisor::signals::{BoardFault, Condition, Request, Signals};
use arcfeed_firmware::supervisor::state::{Disarm, State};
use arcfeed_law::NoDemand;
use arcfeed_model::job::OverrideLimits;
use arcfeed_units::{RevPerMin, Span};

use crate::supervisor::bench::{Bench, Piece, name};

#[test]
fn a_law_without_a_demand_runs_at_100_and_is_counted() {
    let mut bench = Bench::running(Piece::Misses);
    let before = bench.memory.counters().no_contact_ticks;
    let output = bench.run(10);
    assert_eq!((output.feed_override.percent, name(&output.state)), (100, "running"));
    assert!(matches!(output.reason, Reason::NoDemand(NoDemand::NoContact)), "{output:?}");
    assert_eq!(bench.memory.counters().no_contact_ticks, before + 10);
}

#[test]
fn a_spindle_speed_that_is_no_positive_number_runs_at_100_and_is_counted() {
    for rev_per_min in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -1.0] {
        let mut bench = Bench::running(Piece::Wants(150));
        bench.spindle = RevPerMin(rev_per_min);
        let output = bench.run(1_000);
        assert_eq!((output.feed_override.percent, output.reason), (100, Reason::NoSpindle), "{rev_per_min}");
        assert!(bench.memory.counters().no_spindle_ticks > 500);
    }
}

#[test]
fn a_demand_below_min_gets_min_and_says_by_how_much_the_chip_exceeds_its_target() {
    let output = Bench::running(Piece::Wants(8)).tick();
    assert_eq!((output.feed_override.percent, name(&output.state)), (10, "running"));
    let Reason::Floor { chip_excess_percent } = output.reason else { panic!("{output:?}") };
    assert!((25..=26).contains(&chip_excess_percent), "10 over 8: {chip_excess_percent} %");
}

#[test]
fn a_min_of_zero_holds_and_goes_on_from_zero() {
    let mut bench = Bench::new(OverrideLimits { min_percent: 0, ..OverrideLimits::default() });
    bench.tick();
    bench.ask(Request::Arm);
    bench.begin(Piece::Wants(150));
    bench.run(3_000);
    bench.spindle = RevPerMin(1.0);
    let held = bench.run(2_000);
    assert_eq!((held.feed_override.percent, name(&held.state)), (0, "holding"));
    bench.run(60_000);
    bench.spindle = RevPerMin(1_000.0);
    let released: Vec<u8> = (0..100).map(|_| bench.tick().feed_override.percent).collect();
    assert_eq!((released[0], released[19], released[99]), (0, 1, 5), "up by the slew, nothing was stored up");
}

#[test]
fn a_demand_above_max_gets_max_and_its_reason() {
    let output = Bench::running(Piece::Wants(500)).tick();
    assert_eq!((output.feed_override.percent, output.reason), (200, Reason::Limited(Limit::Max)));
    assert_eq!(name(&output.state), "running");
}

#[test]
fn a_loss_keeps_the_last_value_for_its_time_to_live_and_then_slews_to_100_with_a_latched_alarm() {
    for (wants, rises) in [(Piece::Wants(150), false), (Piece::Wants(60), true)] {
        let mut bench = Bench::running(wants);
        let last = bench.tick().feed_override;
        let lost = bench.silence(51);
        assert_eq!((name(&lost.state), lost.alarm), ("fallback", Alarm::Latched));
        assert_eq!(bench.silence(248).feed_override, last, "the last tick of the time to live");
        let next = bench.silence(100).feed_override.percent;
        assert_eq!(next, if rises { last.percent + 5 } else { last.percent - 20 });
        let output = bench.silence(1_000);
        assert_eq!((output.feed_override.percent, output.alarm), (100, Alarm::Latched));
    }
}

#[test]
fn a_loss_ends_at_the_dial_where_that_is_lower() {
    let mut bench = Bench::running(Piece::Wants(150));
    bench.dial = 94;
    bench.run(100);
    assert_eq!(bench.silence(2_000).feed_override.percent, 94);
    bench.dial = 70;
    assert_eq!(bench.silence(1).feed_override.percent, 70, "at once");
}

#[test]
fn a_loss_ends_only_by_arming_after_half_a_second_without_a_gap() {
    let mut bench = Bench::running(Piece::Wants(150));
    bench.silence(100);
    bench.position.age = Span(0);
    bench.run(400);
    assert_eq!(bench.ask(Request::Arm).refusal, Some(Refusal::NotResynchronised));
    bench.position.invalid_in_row = 1;
    bench.tick();
    bench.position.invalid_in_row = 0;
    bench.run(400);
    assert_eq!(bench.ask(Request::Arm).refusal, Some(Refusal::NotResynchronised), "the gap starts it anew");
    bench.run(10_000);
    assert_eq!(name(&bench.state()), "fallback", "never by itself");
    assert_eq!(bench.ask(Request::Arm).refusal, None);
    assert_eq!(name(&bench.state()), "armed");
}

#[test]
fn a_new_block_during_the_time_to_live_falls_to_100_at_once() {
    let mut bench = Bench::running(Piece::Wants(150));
    bench.silence(60);
    bench.begin(Piece::Line);
    assert_eq!(bench.silence(1).feed_override.percent, 100);
}

#[test]
fn a_board_fault_puts_out_0_at_once_and_stays_until_a_person_resets() {
    for fault in [BoardFault::Watchdog, BoardFault::Parameters, BoardFault::Hardware] {
        let mut bench = Bench::running(Piece::Wants(150));
        bench.fault = Some(fault);
        let output = bench.tick();
        assert_eq!((output.feed_override.percent, output.state), (0, State::Faulted { fault }));
        assert_eq!((output.reason, output.alarm), (Reason::Fault(fault), Alarm::Latched));
        assert_eq!(bench.ask(Request::Reset).feed_override.percent, 0, "the fault is still there");
        bench.fault = None;
        assert_eq!(bench.ask(Request::Arm).refusal, Some(Refusal::Faulted));
        bench.ask(Request::Disarm);
        assert_eq!(bench.run(10_000).feed_override.percent, 0);
        bench.ask(Request::Reset);
        assert_eq!(name(&bench.state()), "idle");
        assert_eq!(bench.run(999).feed_override.percent, 50, "up to the dial by the slew");
    }
}

#[test]
fn invalid_or_stale_frames_change_nothing_and_are_counted_until_five_in_a_row() {
    let mut bench = Bench::running(Piece::Wants(150));
    bench.spindle = RevPerMin(1_200.0);
    for invalid_in_row in 1..=4 {
        bench.position.invalid_in_row = invalid_in_row;
        let output = bench.tick();
        assert_eq!((output.feed_override.percent, output.reason), (150, Reason::Stale));
    }
    assert_eq!(bench.memory.counters().invalid_frames, 4);
    assert_eq!(bench.memory.counters().stale_ticks, 4);
    bench.position.invalid_in_row = 5;
    assert_eq!(name(&bench.tick().state), "fallback");
    let mut bench = Bench::running(Piece::Wants(150));
    assert_eq!(bench.silence(20).reason, Reason::Law);
    assert_eq!(bench.silence(30).reason, Reason::Stale);
    bench.position.age = Span(0);
    assert_eq!(bench.tick().reason, Reason::Law, "a short gap needs no person");
}

#[test]
fn tapping_threading_g63_and_rapid_run_at_100_inhibited() {
    let conditions = [Signals::TAPPING, Signals::THREADING, Signals::FEED_FORCED, Signals::RAPID];
    for condition in conditions {
        let mut bench = Bench::running(Piece::Wants(150));
        bench.conditions = condition;
        let output = bench.run(251);
        assert_eq!((output.feed_override.percent, name(&output.state)), (100, "inhibited"));
        bench.conditions = Signals::NONE;
        assert_eq!(bench.run(1_001).feed_override.percent, 150, "goes on by itself");
    }
    let mut bench = Bench::running(Piece::Wants(150));
    bench.begin(Piece::Rapid);
    let output = bench.tick();
    assert_eq!((output.feed_override.percent, name(&output.state)), (100, "inhibited"), "at once with its block");
}

#[test]
fn cutter_compensation_and_3004_disarm_to_100_and_refuse_to_arm() {
    for (conditions, condition) in
        [(Signals::CUTTER_COMPENSATION, Condition::CutterCompensation), (Signals::OVERRIDE_OFF, Condition::OverrideOff)]
    {
        let mut bench = Bench::running(Piece::Wants(150));
        bench.conditions = conditions;
        let output = bench.run(251);
        assert_eq!(output.reason, Reason::Disarmed(Disarm::Condition(condition)));
        assert_eq!((output.feed_override.percent, output.alarm), (100, Alarm::Passing));
        assert_eq!(bench.ask(Request::Arm).refusal, Some(Refusal::Condition(condition)));
        bench.conditions = Signals::NONE;
        assert_eq!(bench.run(100).alarm, Alarm::None);
        assert_eq!(name(&bench.state()), "disarmed", "until armed again");
        bench.ask(Request::Arm);
        bench.begin(Piece::Wants(150));
        assert_eq!(bench.run(1_100).feed_override.percent, 150);
    }
}

#[test]
fn feed_hold_freezes_and_restarts_from_what_is_put_out() {
    let mut bench = Bench::running(Piece::Wants(150));
    bench.conditions = Signals::FEED_HOLD;
    let held: Vec<u8> = (0..10_000).map(|_| bench.tick().feed_override.percent).collect();
    assert_eq!((held[0], held[9_999]), (149, 100), "down to 100 % by the slew");
    assert!(held.is_sorted_by(|before, after| before >= after));
    bench.conditions = Signals::NONE;
    let released: Vec<u8> = (0..100).map(|_| bench.tick().feed_override.percent).collect();
    assert_eq!((released[0], released[99]), (100, 105), "up by the slew");
    let mut bench = Bench::running(Piece::Wants(60));
    bench.conditions = Signals::FEED_HOLD;
    assert_eq!(bench.run(5_000).feed_override.percent, 60, "never up");
}

#[test]
fn a_law_that_comes_back_goes_on_from_what_is_put_out() {
    let mut bench = Bench::running(Piece::Wants(60));
    bench.conditions = Signals::TAPPING;
    assert_eq!(bench.run(2_000).feed_override.percent, 100);
    bench.conditions = Signals::NONE;
    assert_eq!(bench.tick().feed_override.percent, 99, "down by the slew, not at once");
    assert_eq!(bench.run(200).feed_override.percent, 60);
}

#[test]
fn a_block_that_begins_without_a_sample_runs_at_100_at_most_and_up_by_the_slew() {
    let mut bench = Bench::running(Piece::Wants(150));
    bench.silence(25);
    bench.begin(Piece::Wants(200));
    assert_eq!(bench.silence(1).feed_override.percent, 100, "at once");
    bench.position.age = Span(0);
    assert_eq!(bench.run(100).feed_override.percent, 105);
}

#[test]
fn a_block_boundary_while_running_keeps_the_feed() {
    let mut bench = Bench::running(Piece::Wants(120));
    bench.begin(Piece::Wants(200));
    assert_eq!(bench.tick().feed_override.percent, 200, "less feed sent, the same feed");
    bench.begin(Piece::Wants(120));
    assert_eq!(bench.tick().feed_override.percent, 120, "the same feed, at once");
}

#[test]
fn a_block_already_in_work_at_power_on_is_left_alone() {
    let mut bench = Bench::standard();
    bench.begin(Piece::Wants(150));
    bench.tick();
    bench.ask(Request::Arm);
    let output = bench.run(1_000);
    assert_eq!((output.feed_override.percent, output.reason), (100, Reason::Waiting));
    bench.begin(Piece::Wants(150));
    assert_eq!(name(&bench.tick().state), "running");
}

#[test]
fn of_several_causes_the_more_important_one_decides() {
    type Knob = fn(&mut Bench);
    let order: [(&str, Knob); 8] = [
        ("faulted", |bench| bench.fault = Some(BoardFault::Hardware)),
        ("disarmed", |bench| bench.request = Some(Request::Disarm)),
        ("fallback", |bench| bench.position.invalid_in_row = 9),
        ("disarmed", |bench| bench.dial = 40),
        ("disarmed", |bench| bench.conditions = bench.conditions.with(Signals::CUTTER_COMPENSATION)),
        ("inhibited", |bench| bench.conditions = bench.conditions.with(Signals::TAPPING)),
        ("holding", |bench| bench.conditions = bench.conditions.with(Signals::FEED_HOLD)),
        ("running", |_| {}),
    ];
    for (first, (expected, _)) in order.iter().enumerate() {
        let mut bench = Bench::running(Piece::Wants(150));
        order.iter().skip(first).for_each(|(_, knob)| knob(&mut bench));
        assert_eq!(name(&bench.tick().state), *expected, "from {first}");
    }
    // Precedence of disarming causes: request, dial, condition.
    let mut bench = Bench::running(Piece::Wants(150));
    (bench.dial, bench.conditions) = (40, Signals::OVERRIDE_OFF);
    let output = bench.tick();
    assert!(matches!(output.state, State::Disarmed { by: Disarm::Operator { .. } }), "{output:?}");
    assert_eq!(output.feed_override.percent, 40);
}
