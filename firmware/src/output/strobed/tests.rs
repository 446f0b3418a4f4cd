use super::super::bench::{Bench, Refused, STROBE};
use super::*;
use embedded_hal_mock::eh1::delay::{CheckedDelay, Transaction as Wait};
use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};

fn to(percent: u8) -> FeedOverride {
    FeedOverride { percent }
}

#[test]
fn the_strobe_rises_once_an_update_and_ends_low() {
    let level = |high: bool| Transaction::set(if high { State::High } else { State::Low });
    let data: [Mock; 8] = core::array::from_fn(|line| Mock::new(&[level(true), level(100 & (1 << line) == 0)]));
    let mut strobe = Mock::new(&[false, true, false, true, false].map(level));
    let mut output = Strobed::new(data.clone(), strobe.clone()).unwrap();
    output.put(to(100)).unwrap();
    data.into_iter().for_each(|mut pin| pin.done());
    strobe.done();
}

#[test]
fn the_strobe_comes_after_the_data() {
    let bench = Bench::default();
    let mut output = Strobed::new(bench.pins(), bench.pin(STROBE)).unwrap();
    bench.clear();
    output.put(to(1)).unwrap();
    let written = bench.written();
    assert_eq!(written[8..], [(STROBE, true), (STROBE, false)]);
    assert!(written[..8].iter().all(|(wire, _)| *wire < 8));
}

#[test]
fn the_register_shows_old_and_new_and_nothing_between_in_any_of_65_025_updates() {
    let bench = Bench::default();
    let mut updates = 0;
    for (old, new) in (0..=254).flat_map(|old| (0..=254).map(move |new| (old, new))) {
        let mut output = Strobed::new(bench.pins(), bench.pin(STROBE)).unwrap();
        output.put(to(old)).unwrap();
        output.put(to(new)).unwrap();
        assert_eq!(bench.register_readings(), [0, old, new]);
        bench.clear();
        updates += 1;
    }
    assert_eq!(updates, 65_025);
}

#[test]
fn wiring_that_needs_time_gets_it_before_and_after_the_strobe_rises() {
    let mut delay = CheckedDelay::new(&[50_000; 4].map(Wait::delay_ns));
    let bench = Bench::default();
    let settling = Settling { delay: delay.clone(), settle_ns: 50_000 };
    let mut output = Strobed::with_settling(bench.pins(), bench.pin(STROBE), settling).unwrap();
    output.put(to(120)).unwrap();
    delay.done();
}

#[test]
fn a_data_line_that_refuses_has_the_register_release_the_others() {
    let bench = Bench::default();
    for (line, obeys) in (0..8).flat_map(|line| [(line, false), (line, true)]) {
        for (old, new) in (0..=254).flat_map(|old| (0..=254).map(move |new| (old, new))) {
            let mut output = Strobed::new(bench.pins(), bench.pin(STROBE)).unwrap();
            output.put(to(old)).unwrap();
            bench.refuses.set(Some((line, obeys)));
            assert_eq!(output.put(to(new)), Err(LineError { line: OutputLine::Fv(line), source: Refused }));
            bench.refuses.set(None);
            let end = bench.register_readings().last().copied().unwrap();
            assert!(end == 0 || (!obeys && end == 1 << line && end <= old), "{old} -> {new}, line {line}: {end}");
            bench.clear();
        }
    }
}

#[test]
fn a_strobe_that_refuses_is_named_and_the_data_lines_are_released() {
    let bench = Bench::default();
    let mut output = Strobed::new(bench.pins(), bench.pin(STROBE)).unwrap();
    output.put(to(110)).unwrap();
    bench.refuses.set(Some((STROBE, false)));
    assert_eq!(output.put(to(120)), Err(LineError { line: OutputLine::Strobe, source: Refused }));
    assert_eq!(bench.register_readings(), [0, 110]);
    assert!(bench.written().ends_with(&core::array::from_fn::<_, 8, _>(|line| (line as u8, true))));
    assert!(Strobed::new(bench.pins(), bench.pin(STROBE)).is_err());
}
