use super::*;

/// A peer whose clock runs `ppm` fast from an arbitrary start, asked every 50 ms over a way of given lengths.
struct Peer {
    ppm: f64,
    start_us: f64,
}

impl Peer {
    fn says(&self, true_us: f64) -> u32 {
        (self.start_us + true_us * (1.0 + self.ppm * 1e-6)) as u64 as u32
    }
}

/// xorshift64: reproducible without a dependency.
fn random(state: &mut u64) -> u64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    *state
}

/// Round trips for `seconds`, there and back each `least_us` and up to `more_us` longer, one in twenty held up for 30 ms;
/// after each, `check` gets the true offset.
fn run(
    clock: &mut PeerClock,
    peer: &Peer,
    seconds: u64,
    [least_us, more_us]: [u64; 2],
    mut check: impl FnMut(&PeerClock, u64),
) {
    let mut seed = 0x9E37_79B9_7F4A_7C15;
    for round in 0..seconds * 20 {
        let a1 = 1_000_000 + round * 50_000;
        let mut way = || {
            let late = if random(&mut seed).is_multiple_of(20) { 30_000 } else { 0 };
            least_us + random(&mut seed) % (more_us + 1) + late
        };
        let (there, back) = (way(), way());
        let held = 1_700;
        let (b1, a2) = (a1 + there, a1 + there + held + back);
        let echo = Echo { t_us: a1 as u32, held_us: held as u32 };
        assert!(b1 < a2);
        let _ = clock.on_echo(Micros(a2), peer.says((b1 + held) as f64), echo);
        check(clock, a2);
    }
}

#[test]
fn a_drifting_clock_is_followed_and_its_drift_found() {
    for ppm in [-400.0, -30.0, 0.0, 80.0, 400.0] {
        let (mut clock, peer) = (PeerClock::new(500), Peer { ppm, start_us: 4.2e9 });
        let mut worst_us = 0;
        run(&mut clock, &peer, 60, [1_500, 800], |clock, now| {
            let said = peer.says(now as f64);
            let found = clock.to_ours(Micros(now), said).expect("a round trip");
            let off = found.0.abs_diff(now);
            assert!(off <= u64::from(clock.uncertainty(Micros(now)).unwrap().0) + 1);
            worst_us = worst_us.max(off);
        });
        let drift = f64::from(clock.drift_ppb().expect("a minute is enough")) / 1_000.0;
        println!("{ppm} ppm: found {drift:.1} ppm, offset within {worst_us} us of a round trip of 3 to 4.6 ms");
        assert!((drift - ppm).abs() < 25.0, "{ppm}: {drift}");
        assert_eq!(clock.steps(), 0);
    }
}

#[test]
fn nothing_is_taken_for_younger_than_it_is_however_lopsided_the_way() {
    let (mut clock, peer) = (PeerClock::new(100), Peer { ppm: 60.0, start_us: 77.0 });
    run(&mut clock, &peer, 20, [200, 9_000], |clock, now| {
        for age_us in [0, 10, 5_000, 200_000] {
            let sent = now - age_us;
            let earliest = clock.earliest(Micros(now), peer.says(sent as f64)).unwrap();
            assert!(earliest.0 <= sent + 1, "sent at {sent}, but said to be sent after {earliest:?}");
        }
    });
}

#[test]
fn bounds_grow_while_nothing_is_heard() {
    let mut clock = PeerClock::new(200);
    let _ = clock.on_echo(Micros(10_000), 5_000, Echo { t_us: 6_000, held_us: 0 });
    // The way took 4 ms there and back; one microsecond for drift meanwhile, and another two for a moment.
    assert_eq!(clock.uncertainty(Micros(10_000)), Some(Span(2_001)));
    assert_eq!(clock.uncertainty(Micros(10_010_000)), Some(Span(2_001 + 2_000)));
}

#[test]
fn a_step_of_the_clock_is_seen_and_counted() {
    let mut clock = PeerClock::new(200);
    let _ = clock.on_echo(Micros(10_000), 5_000, Echo { t_us: 6_000, held_us: 0 });
    let _ = clock.on_echo(Micros(60_000), 55_100, Echo { t_us: 56_500, held_us: 0 });
    assert_eq!(clock.steps(), 0);
    let _ = clock.on_echo(Micros(110_000), 305_100, Echo { t_us: 106_500, held_us: 0 });
    assert_eq!((clock.steps(), clock.to_ours(Micros(110_000), 305_100 - 1_750)), (1, Some(Micros(110_000 - 3_500))));
}

#[test]
fn an_echo_that_cannot_be_is_no_round_trip() {
    let mut clock = PeerClock::new(200);
    let _ = clock.on_echo(Micros(10_000), 5_000, Echo { t_us: 10_001, held_us: 0 });
    let _ = clock.on_echo(Micros(10_000), 5_000, Echo { t_us: 9_000, held_us: 1_001 });
    assert_eq!(clock.earliest(Micros(10_000), 5_000), None);
}
