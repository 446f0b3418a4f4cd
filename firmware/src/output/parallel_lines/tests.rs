use super::super::bench::{Bench, Coupler, PlainPin, Refused};
use super::super::lines::OutputLine;
use super::*;
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::delay::{CheckedDelay, Transaction as Wait};
use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
use std::io::ErrorKind;

const HIGHEST: u8 = 254;

/// An optical coupler on the slow side: it lets go later than it takes hold.
const COUPLER: Coupler = Coupler { take_ns: 3_000, let_go_ns: 30_000 };

fn to(percent: u8) -> FeedOverride {
    FeedOverride { percent }
}

/// Pins that expect one level each per string, line 7 first as a byte is written.
fn expecting(steps: &[&str]) -> [Mock; 8] {
    core::array::from_fn(|line| {
        let state = |step: &&str| if step.as_bytes()[7 - line] == b'H' { State::High } else { State::Low };
        Mock::new(&steps.iter().map(state).map(Transaction::set).collect::<Vec<_>>())
    })
}

fn finish(mut pins: [Mock; 8]) {
    pins.iter_mut().for_each(Mock::done);
}

#[test]
fn every_line_is_written_once_an_update_with_the_inverted_weight() {
    let pins = expecting(&["HHHHHHHH", "HLLHHLHH", "HLLLHLHL", "LHHHHHHH", "LLLLLLLH", "HHHHHHHH"]);
    let mut output = ParallelLines::new(pins.clone()).unwrap();
    for percent in [100, 117, 128, 254, 0] {
        output.put(to(percent)).unwrap();
    }
    finish(pins);
}

#[test]
fn more_than_the_lines_can_say_is_their_highest() {
    let pins = expecting(&["HHHHHHHH", "LLLLLLLH"]);
    ParallelLines::new(pins.clone()).unwrap().put(to(255)).unwrap();
    finish(pins);
}

#[test]
fn lines_are_released_before_others_are_pulled_down() {
    let bench = Bench::default();
    let mut output = ParallelLines::new(bench.pins()).unwrap();
    output.put(to(0b0110_0100)).unwrap();
    bench.clear();
    output.put(to(0b0100_1011)).unwrap();
    let released = [2, 4, 5, 7].map(|line| (line, true));
    let pulled = [0, 1, 3, 6].map(|line| (line, false));
    assert_eq!(bench.written(), [released, pulled].concat());
}

/// Lowest and highest reading during an update, with couplers between and a settling time.
fn extremes(bench: &Bench, old: u8, new: u8, coupler: Coupler, settle_ns: u32) -> (u8, u8) {
    let mut output = ParallelLines::with_settling(bench.pins(), Settling { delay: bench, settle_ns }).unwrap();
    output.put(to(old)).unwrap();
    bench.clear();
    output.put(to(new)).unwrap();
    let readings = bench.readings(old, coupler);
    bench.clear();
    assert_eq!(readings.last(), Some(&new));
    (*readings.iter().min().unwrap(), *readings.iter().max().unwrap())
}

#[test]
fn no_intermediate_reading_is_higher_than_old_or_new_in_any_of_65_025_updates() {
    let bench = Bench::default();
    let (mut updates, mut feed_holds) = (0, 0);
    for old in 0..=HIGHEST {
        for new in 0..=HIGHEST {
            let (lowest, highest) = extremes(&bench, old, new, Coupler::NONE, 0);
            assert!(highest <= old.max(new), "{old} -> {new} reads {highest}");
            assert!(lowest >= old & new, "{old} -> {new} reads {lowest}");
            assert!(lowest == old & new || old == new, "{old} -> {new}: lowest {lowest}");
            updates += 1;
            feed_holds += u32::from(lowest == 0 && old > 0 && new > 0);
        }
    }
    println!("{updates} updates, {feed_holds} of them past 0 %");
    // Disjoint pairs of codes: 3^8, less those with 0 on a side: 2 * 256 - 1.
    assert_eq!((updates, feed_holds), (65_025, 6_561 - 511));
}

#[test]
fn in_steps_of_one_only_seven_pairs_pass_0_and_one_of_them_lies_above_63() {
    let bench = Bench::default();
    let passes_0 = |old: &u8| {
        [(*old, old + 1), (old + 1, *old)].iter().all(|(a, b)| extremes(&bench, *a, *b, Coupler::NONE, 0).0 == 0)
    };
    let found: Vec<u8> = (1..HIGHEST).filter(passes_0).collect();
    assert_eq!(found, [1, 3, 7, 15, 31, 63, 127]);
    let lowest = (100..200).filter(|old| *old != 127).map(|old| extremes(&bench, old, old + 1, Coupler::NONE, 0).0);
    assert_eq!(lowest.min(), Some(96));
}

#[test]
fn behind_slow_couplers_settling_keeps_the_order_and_nothing_else_does() {
    let bench = Bench::default();
    let (mut without, mut updates) = (0, 0);
    for old in 0..=HIGHEST {
        for new in 0..=HIGHEST {
            let (_, highest) = extremes(&bench, old, new, COUPLER, 30_000);
            assert!(highest <= old.max(new), "{old} -> {new} reads {highest}");
            without += u32::from(extremes(&bench, old, new, COUPLER, 0).1 > old.max(new));
            updates += 1;
        }
    }
    println!("behind couplers, too high without settling: {without} of {updates}, with it: none");
    assert!(without > updates / 2);
}

#[test]
fn it_waits_only_where_lines_change_in_both_senses() {
    let delay = CheckedDelay::new(&[Wait::delay_ns(30_000), Wait::delay_ns(30_000)]);
    let settling = Settling { delay: delay.clone(), settle_ns: 30_000 };
    let mut output = ParallelLines::with_settling([const { PlainPin(false) }; 8], settling).unwrap();
    // Up from 0, the same, fewer weights, and: other weights, other weights.
    for percent in [101, 101, 100, 104, 103] {
        output.put(to(percent)).unwrap();
    }
    let mut delay = delay;
    delay.done();
}

#[test]
fn a_pin_that_refuses_is_named_and_all_others_are_released() {
    let broken = MockError::Io(ErrorKind::NotConnected);
    // Levels written to each line: at the start, at 100 %, at 118 %, at the release. Line 4 refuses to be pulled down for
    // 118 %, lines 5 and 6 are not reached; all are released.
    let written = ["HHHH", "HHLH", "HLLH", "HHHH", "HHEH", "HLH", "HLH", "HHHH"];
    let pins = written.map(|levels| {
        let each = levels.bytes().map(|level| match level {
            b'H' => Transaction::set(State::High),
            b'L' => Transaction::set(State::Low),
            _ => Transaction::set(State::Low).with_error(broken.clone()),
        });
        Mock::new(&each.collect::<Vec<_>>())
    });
    let mut output = ParallelLines::new(pins.clone()).unwrap();
    output.put(to(100)).unwrap();
    assert_eq!(output.put(to(118)), Err(LineError { line: OutputLine::Fv(4), source: broken }));
    finish(pins);
}

#[test]
fn a_failing_pin_never_shows_more_than_old_or_new() {
    let bench = Bench::default();
    let mut failures = 0;
    for (line, obeys) in (0..8).flat_map(|line| [(line, false), (line, true)]) {
        for (old, new) in (0..=HIGHEST).flat_map(|old| (0..=HIGHEST).map(move |new| (old, new))) {
            let mut output = ParallelLines::new(bench.pins()).unwrap();
            output.put(to(old)).unwrap();
            bench.clear();
            bench.refuses.set(Some((line, obeys)));
            assert_eq!(output.put(to(new)), Err(LineError { line: OutputLine::Fv(line), source: Refused }));
            let readings = bench.readings(old, Coupler::NONE);
            bench.refuses.set(None);
            bench.clear();
            assert!(readings.iter().all(|reading| *reading <= old.max(new)), "{old} -> {new}, line {line}");
            let end = readings.last().copied().unwrap_or(old);
            assert!(end == 0 || (!obeys && end == 1 << line), "{old} -> {new}, line {line}: ends at {end}");
            failures += 1;
        }
    }
    println!("{failures} failed updates");
    assert_eq!(failures, 16 * 65_025);
}

#[test]
fn release_tries_every_line_and_names_the_first_that_refused() {
    let bench = Bench::default();
    let mut output = ParallelLines::new(bench.pins()).unwrap();
    output.put(to(HIGHEST)).unwrap();
    bench.clear();
    bench.refuses.set(Some((3, false)));
    assert_eq!(output.release(), Err(LineError { line: OutputLine::Fv(3), source: Refused }));
    assert_eq!(bench.readings(HIGHEST, Coupler::NONE).last(), Some(&8));
    assert!(ParallelLines::new(bench.pins()).is_err());
}

#[test]
fn after_a_failure_the_next_update_is_whole_again() {
    let bench = Bench::default();
    let mut output = ParallelLines::new(bench.pins()).unwrap();
    bench.refuses.set(Some((6, false)));
    assert!(output.put(to(200)).is_err());
    bench.refuses.set(None);
    bench.clear();
    output.put(to(150)).unwrap();
    assert_eq!(bench.readings(255, Coupler::NONE).last(), Some(&150));
}

#[test]
fn pins_of_different_types_go_together() {
    struct OtherPin(PlainPin);
    impl embedded_hal::digital::ErrorType for OtherPin {
        type Error = core::convert::Infallible;
    }
    impl OutputPin for OtherPin {
        fn set_low(&mut self) -> Result<(), Self::Error> {
            self.0.set_low()
        }
        fn set_high(&mut self) -> Result<(), Self::Error> {
            self.0.set_high()
        }
    }
    let [mut a, mut b, mut c, mut d, mut e, mut f, mut g] = [const { PlainPin(false) }; 7];
    let mut h = OtherPin(PlainPin(false));
    let pins: [&mut dyn OutputPin<Error = core::convert::Infallible>; 8] =
        [&mut a, &mut b, &mut c, &mut d, &mut e, &mut f, &mut g, &mut h];
    ParallelLines::new(pins).unwrap().put(to(128)).unwrap();
    assert!(a.0 && g.0 && !h.0.0);
}
