use super::*;
use crate::random::Random;
use arcfeed_firmware::supervisor::input::Source;
use arcfeed_firmware::supervisor::signals::BoardFault;
use arcfeed_firmware::supervisor::state::Disarm;

/// A control and its user interface: the dial takes effect, and can be read, some time after it was requested.
struct Control {
    dial: f64,
    read: Vec<f64>,
    requested: i32,
    requests: Vec<(u64, f64)>,
}

impl Control {
    fn new() -> Self {
        Control { dial: 1.0, read: vec![1.0; 200], requested: 100, requests: Vec::new() }
    }

    /// A millisecond: requests due take effect; the reading is up to 200 ms old.
    fn step(&mut self, now: u64, requested: i32, delay: u64) {
        if requested != self.requested {
            self.requested = requested;
            self.requests.push((now + delay, f64::from(requested) / 100.0));
        }
        // A user interface sends its requests in their order.
        while self.requests.first().is_some_and(|(due, _)| *due <= now) {
            self.dial = self.requests.remove(0).1;
        }
        self.read.push(self.dial);
    }

    fn reading(&self, age: u64) -> f64 {
        self.read[self.read.len() - 1 - age as usize]
    }
}

fn input(dial_ratio: f64) -> ArcfeedAdaptiveInput {
    ArcfeedAdaptiveInput { dial_ratio, dt_us: 1_000, motion_type: 2, ..ArcfeedAdaptiveInput::default() }
}

const DISARMED: State = State::Disarmed { by: Disarm::Request };

/// (2) of the module for any delay of the dial, any state and any turn of the dial by a person up to 2.
#[test]
fn the_feed_is_never_above_the_override_whatever_the_delay_of_the_dial() {
    let (mut ticks, mut raised) = (0_u64, 0_u64);
    let lost = State::Fallback { source: Source::Position, keep: Span(0), fresh_for: Span(0) };
    for seed in 0..200 {
        let random = &mut Random(seed);
        let (mut control, mut adaptive) = (Control::new(), AdaptiveFeed::default());
        let (mut state, mut level, mut output) = (State::Idle, 1.0_f32, ArcfeedAdaptiveOutput::default());
        output.dial_percent = 100;
        let (delay, age) = (random.below(200), random.below(150));
        for now in 0..8_000 {
            if random.below(400) == 0 {
                state = [State::Idle, State::Armed, State::Running, DISARMED, lost][random.below(5) as usize];
            }
            // Where no law acts the override is 100 % at most.
            let most = if state == State::Running { 200 } else { 100 };
            level = (level + [-0.002, 0.002][random.below(2) as usize]).clamp(0.1, most as f32 / 100.0);
            control.step(now, output.dial_percent, delay);
            if state.is_engaged() && random.below(600) == 0 {
                control.dial = random.below(201) as f64 / 100.0;
            }
            (output, _) = adaptive.update(&state, level, &input(control.reading(age)));
            // A person who turns the own dial up while no law is engaged has what they asked for.
            let feed = output.adaptive_feed_ratio * control.dial;
            assert!(
                feed <= f64::from(level).max(0.0) * (1.0 + 1e-12),
                "seed {seed}, {now} ms, {state:?}: {feed} {level}"
            );
            (ticks, raised) = (ticks + 1, raised + u64::from(control.dial > 1.0));
        }
    }
    println!("{ticks} ticks, {raised} with the dial above 1, 0 above the override");
    assert!(raised > ticks / 10);
}

#[test]
fn a_reduction_of_the_dial_keeps_its_share() {
    let mut adaptive = AdaptiveFeed::default();
    assert_eq!(adaptive.update(&State::Idle, 1.0, &input(0.8)).0.dial_percent, 100);
    assert_eq!(adaptive.update(&State::Armed, 1.0, &input(0.8)).0.dial_percent, 160);
    assert_eq!(adaptive.update(&State::Armed, 1.0, &input(1.0)).0.dial_percent, 160);
    // 1.0 of 2: half. It stays half of the programmed feed, and never less reduced.
    assert_eq!(adaptive.update(&DISARMED, 1.0, &input(1.0)).0.dial_percent, 50);
}

#[test]
fn the_dial_counts_as_lowered_only_after_it_has_read_so_for_a_second() {
    let mut adaptive = AdaptiveFeed::default();
    assert_eq!(adaptive.update(&State::Idle, 1.0, &input(1.0)).0.adaptive_feed_ratio, 1.0);
    assert_eq!(adaptive.update(&State::Armed, 1.0, &input(1.0)).0.adaptive_feed_ratio, 0.5);
    let lowered =
        |adaptive: &mut AdaptiveFeed, dial| adaptive.update(&DISARMED, 1.0, &input(dial)).0.adaptive_feed_ratio;
    for dial in [1.0; 999] {
        assert_eq!(lowered(&mut adaptive, dial), 0.5);
    }
    assert_eq!(lowered(&mut adaptive, 1.5), 0.5);
    assert_eq!((0..1_000).map(|_| lowered(&mut adaptive, 1.0)).filter(|feed| *feed == 0.5).count(), 999);
}

#[test]
fn a_dial_above_two_and_one_that_is_no_number_never_raise_the_feed() {
    for (dial, expected) in [(2.0, 0.75), (4.0, 0.375), (f64::NAN, 0.0), (-1.0, 0.0), (f64::INFINITY, 0.0)] {
        let mut adaptive = AdaptiveFeed::default();
        assert_eq!(adaptive.update(&State::Running, 1.5, &input(dial)).0.adaptive_feed_ratio, expected, "{dial}");
    }
}

#[test]
fn an_output_that_is_not_in_force_stops_the_feed() {
    let at = |commanded_units_per_s, current_units_per_s| ArcfeedAdaptiveInput {
        commanded_units_per_s,
        current_units_per_s,
        requested_units_per_s: 10.0,
        ..input(2.0)
    };
    for (commanded, current, fails) in [
        (20.0, 20.0, true),
        (20.0, 12.3, true),
        // Within the tolerance.
        (12.1, 12.1, false),
        // The axes brake from a faster move; an axis limits the feed.
        (12.0, 30.0, false),
        (20.0, 12.0, false),
    ] {
        let mut adaptive = AdaptiveFeed::default();
        let failed: Vec<bool> =
            (0..8).map(|_| adaptive.update(&State::Running, 1.2, &at(commanded, current)).1).collect();
        assert_eq!(failed, [[false; 5].as_slice(), &[fails; 3]].concat(), "{commanded} {current}");
    }
    let mut adaptive = AdaptiveFeed::default();
    let outputs: Vec<_> = (0..6).map(|_| adaptive.update(&State::Running, 1.0, &at(20.0, 20.0)).0).collect();
    assert_eq!((outputs[5].adaptive_feed_ratio, outputs[5].feed_inhibit), (0.0, 1));
    let (faulted, _) = adaptive.update(&State::Faulted { fault: BoardFault::Hardware }, 0.0, &at(0.0, 0.0));
    assert_eq!((faulted.adaptive_feed_ratio, faulted.feed_inhibit), (0.0, 1));
    // Without a raised dial the operator may do as ever.
    let mut idle = AdaptiveFeed::default();
    assert!((0..50).all(|_| !idle.update(&State::Idle, 1.0, &at(20.0, 20.0)).1));
}

/// As LinuxCNC shows it: at the end of a rapid the distance of the next move appears a period before its type.
#[test]
fn a_rapid_is_fast_until_half_a_second_before_its_end_and_the_next_move_never_begins_fast() {
    let mut adaptive = AdaptiveFeed::default();
    let mut feed = |motion_type, remaining_units, current_units_per_s| {
        let input = ArcfeedAdaptiveInput { motion_type, remaining_units, current_units_per_s, ..input(2.0) };
        adaptive.update(&State::Armed, 1.0, &input).0.adaptive_feed_ratio
    };
    let fed = [(0, 0.0, 0.0), (1, 20.0, 0.0), (1, 19.9, 1.0), (1, 10.0, 19.0), (1, 9.0, 18.1), (1, 8.9, 1.0)];
    assert_eq!(fed.map(|(motion, left, velocity)| feed(motion, left, velocity)), [0.5, 0.5, 1.0, 1.0, 0.5, 0.5]);
    assert_eq!([(1, 62.8, 0.0), (3, 62.7, 0.1)].map(|(motion, left, velocity)| feed(motion, left, velocity)), [0.5; 2]);
    // Two rapids in a row, and a control that does not know the distance.
    let fed = [(1, 30.0, 0.0), (1, 29.0, 5.0), (1, 40.0, 5.0), (1, 39.0, 5.0), (1, 0.0, 0.0)];
    assert_eq!(fed.map(|(motion, left, velocity)| feed(motion, left, velocity)), [0.5, 1.0, 0.5, 1.0, 0.5]);
}
