//! The operator's rights: the dial and the buttons.

use arcfeed_firmware::supervisor::signals::{BoardFault, Request};

use crate::supervisor::bench::{Bench, Piece, name};

#[test]
fn a_reset_button_that_is_stuck_resets_nothing() {
    let mut bench = Bench::running(Piece::Wants(150));
    bench.request = Some(Request::Reset);
    bench.tick();
    bench.fault = Some(BoardFault::Hardware);
    bench.tick();
    bench.fault = None;
    assert_eq!(name(&bench.run(100).state), "faulted");
}

#[test]
fn a_dial_below_50_or_down_by_more_than_10_takes_over_at_once_until_armed_again() {
    for dial in [89, 60, 49, 0] {
        let mut bench = Bench::running(Piece::Wants(150));
        bench.dial = dial;
        let output = bench.tick();
        assert_eq!((output.feed_override.percent, name(&output.state)), (dial, "disarmed"));
        bench.dial = 100;
        assert_eq!(bench.run(5_000).feed_override.percent, 100, "the dial's value");
        bench.ask(Request::Arm);
        bench.begin(Piece::Wants(150));
        assert_eq!(bench.run(1_500).feed_override.percent, 150);
    }
}

#[test]
fn a_dial_between_90_and_100_is_a_share_of_the_laws_demand() {
    let mut bench = Bench::running(Piece::Wants(150));
    bench.dial = 94;
    assert_eq!(bench.tick().feed_override.percent, 141, "at once");
    assert_eq!(bench.run(1_000).feed_override.percent, 141);
    bench.dial = 100;
    assert_eq!(bench.run(20).feed_override.percent, 142, "up by the slew");
    assert_eq!(bench.run(1_000).feed_override.percent, 150);
}

#[test]
fn a_dial_above_100_adds_nothing_to_a_law_and_everything_where_none_acts() {
    let mut bench = Bench::running(Piece::Wants(150));
    bench.dial = 130;
    assert_eq!(bench.run(1_000).feed_override.percent, 150);
    bench.ask(Request::Disarm);
    assert_eq!(bench.run(1_000).feed_override.percent, 130);
    bench.dial = 254;
    assert_eq!(bench.run(5_000).feed_override.percent, 200, "no more than max");
}

#[test]
fn a_turn_down_never_raises_the_feed() {
    let mut bench = Bench::running(Piece::Wants(60));
    bench.dial = 85;
    assert_eq!(bench.run(10_000).feed_override.percent, 60, "not up to the dial");
    bench.dial = 86;
    assert_eq!(bench.run(1_000).feed_override.percent, 60, "noise");
    bench.dial = 88;
    assert_eq!(bench.run(1_000).feed_override.percent, 88, "turned up: the dial's value");
}

#[test]
fn a_slow_turn_counts_from_the_highest_reading() {
    let mut bench = Bench::running(Piece::Wants(150));
    for dial in (89..100).rev() {
        bench.dial = dial;
        bench.run(1_000);
    }
    assert_eq!(name(&bench.state()), "disarmed");
}

#[test]
fn a_stuck_arm_button_does_not_arm_again() {
    let mut bench = Bench::running(Piece::Wants(150));
    bench.request = Some(Request::Arm);
    bench.tick();
    bench.dial = 80;
    assert_eq!(name(&bench.run(100).state), "disarmed");
}

#[test]
fn a_reduction_wins_even_at_the_tick_of_a_loss() {
    let mut bench = Bench::running(Piece::Wants(150));
    (bench.dial, bench.position.invalid_in_row) = (80, 5);
    let output = bench.tick();
    assert_eq!((output.feed_override.percent, name(&output.state)), (80, "fallback"));
}
