use super::super::bench::{Bench, Coupler, PORT, Refused};
use super::*;
use embedded_hal_mock::eh1::delay::{CheckedDelay, Transaction as Wait};

const HIGHEST: u8 = 254;

/// An optical coupler on the slow side: it lets go later than it takes hold.
const COUPLER: Coupler = Coupler { take_ns: 3_000, let_go_ns: 30_000 };

/// Remembers what was written.
#[derive(Default)]
struct Recorder(Vec<u8>);

impl LinePort for &mut Recorder {
    type Error = core::convert::Infallible;

    fn write(&mut self, levels: u8) -> Result<(), Self::Error> {
        self.0.push(levels);
        Ok(())
    }
}

fn to(percent: u8) -> FeedOverride {
    FeedOverride { percent }
}

fn all_updates() -> impl Iterator<Item = (u8, u8)> {
    (0..=HIGHEST).flat_map(|old| (0..=HIGHEST).map(move |new| (old, new)))
}

/// All that a control reads during an update.
fn readings(bench: &Bench, (old, new): (u8, u8), coupler: Coupler, settle_ns: u32) -> Vec<u8> {
    let mut output = PortLines::with_settling(bench.port(), Settling { delay: bench, settle_ns }).unwrap();
    output.put(to(old)).unwrap();
    bench.clear();
    output.put(to(new)).unwrap();
    let readings = bench.readings(old, coupler);
    bench.clear();
    assert_eq!(readings.last(), Some(&new));
    readings
}

#[test]
fn every_update_is_one_write_of_the_inverted_weights() {
    let mut port = Recorder::default();
    let mut output = PortLines::new(&mut port).unwrap();
    for percent in [100, 117, 128, 254, 255, 0] {
        output.put(to(percent)).unwrap();
    }
    let levels = [0b1111_1111, 0b1001_1011, 0b1000_1010, 0b0111_1111, 0b0000_0001, 0b0000_0001, 0b1111_1111];
    assert_eq!(port.0, levels);
}

#[test]
fn the_control_reads_old_and_new_and_nothing_between_in_any_of_65_025_updates() {
    let bench = Bench::default();
    let mut updates = 0;
    for (old, new) in all_updates() {
        assert_eq!(readings(&bench, (old, new), Coupler::NONE, 0), [new], "{old} -> {new}");
        updates += 1;
    }
    assert_eq!(updates, 65_025);
}

#[test]
fn behind_slow_couplers_settling_keeps_the_bound_and_nothing_else_does() {
    let bench = Bench::default();
    let (mut without, mut updates) = (0, 0);
    for (old, new) in all_updates() {
        let settled = readings(&bench, (old, new), COUPLER, 30_000);
        assert!(settled.iter().all(|reading| *reading <= old.max(new)), "{old} -> {new}: {settled:?}");
        assert!(settled.iter().all(|reading| *reading >= old & new), "{old} -> {new}: {settled:?}");
        without += u32::from(readings(&bench, (old, new), COUPLER, 0).iter().any(|reading| *reading > old.max(new)));
        updates += 1;
    }
    println!("behind couplers, too high without settling: {without} of {updates}, with it: none");
    // c OR c' is read meanwhile: too high unless one includes the other (2 (3^8 - 2^8) - 255 pairs of codes up to 254), or
    // all lines are low, which reads 0 % (3^8 - 511 pairs).
    assert_eq!(without, 65_025 - (2 * (6_561 - 256) - 255) - (6_561 - 511));
}

#[test]
fn it_waits_only_where_lines_change_in_both_senses() {
    let delay = CheckedDelay::new(&[Wait::delay_ns(30_000), Wait::delay_ns(30_000)]);
    let settling = Settling { delay: delay.clone(), settle_ns: 30_000 };
    let mut port = Recorder::default();
    let mut output = PortLines::with_settling(&mut port, settling).unwrap();
    // Up from 0, the same, fewer weights, and: other weights, other weights.
    for percent in [101, 101, 100, 104, 103] {
        output.put(to(percent)).unwrap();
    }
    assert_eq!(port.0, [0, 101, 101, 100, 100 & 104, 104, 104 & 103, 103].map(|code: u8| !code));
    let mut delay = delay;
    delay.done();
}

#[test]
fn a_failing_port_never_shows_more_than_old_or_new() {
    let bench = Bench::default();
    let mut failures = 0;
    for (obeys, settle_ns) in [(false, 0), (true, 0), (false, 30_000), (true, 30_000)] {
        for (old, new) in all_updates() {
            let mut output = PortLines::with_settling(bench.port(), Settling { delay: &bench, settle_ns }).unwrap();
            output.put(to(old)).unwrap();
            bench.clear();
            bench.refuses.set(Some((PORT, obeys)));
            assert_eq!(output.put(to(new)), Err(Refused));
            let readings = bench.readings(old, Coupler::NONE);
            bench.refuses.set(None);
            bench.clear();
            assert!(readings.iter().all(|reading| *reading <= old.max(new)), "{old} -> {new}: {readings:?}");
            let end = readings.last().copied().unwrap_or(old);
            assert_eq!(end, if obeys { 0 } else { old }, "{old} -> {new}");
            failures += 1;
        }
    }
    println!("{failures} failed updates");
    assert_eq!(failures, 4 * 65_025);
}

#[test]
fn after_a_failure_the_next_update_starts_from_released_lines() {
    let bench = Bench::default();
    let mut output = PortLines::with_settling(bench.port(), Settling { delay: &bench, settle_ns: 30_000 }).unwrap();
    output.put(to(200)).unwrap();
    bench.refuses.set(Some((PORT, false)));
    assert_eq!(output.put(to(150)), Err(Refused));
    assert_eq!(output.release(), Err(Refused));
    bench.refuses.set(None);
    bench.clear();
    output.put(to(150)).unwrap();
    // The port never let go of 200: the weights of both must not meet.
    assert!(bench.readings(200, COUPLER).iter().all(|reading| *reading <= 200));
    assert_eq!(bench.readings(200, COUPLER).last(), Some(&150));
}

#[test]
fn a_port_that_refuses_is_not_taken() {
    let bench = Bench::default();
    bench.refuses.set(Some((PORT, true)));
    assert!(PortLines::new(bench.port()).is_err());
}
