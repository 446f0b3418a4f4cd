//! A random walk over all inputs at once, and what must hold at every step of it.

use std::collections::BTreeSet;

use arcfeed_firmware::supervisor::Output;
use arcfeed_firmware::supervisor::report::Reason;
use arcfeed_firmware::supervisor::signals::{BoardFault, Request, Signals};
use arcfeed_firmware::supervisor::state::{Disarm, Hold, State};
use arcfeed_model::job::OverrideLimits;
use arcfeed_nc::modal::Pose;
use arcfeed_units::{Nm, RevPerMin, Span};

use crate::supervisor::bench::{Bench, PIECES, Piece, TICK, name, start};
use crate::supervisor::document::table;

const SEEDS: [u64; 6] = [1, 2, 3, 0xdead_beef, 0x1234_5678_9abc_def1, u64::MAX];
const STEPS: u32 = 200_000;
/// The documented slews, %/us, and the longest tick that raises.
const UP_PERCENT_PER_US: f64 = 50.0 / 1e6;
const LONGEST_TICK: Span = Span::from_ms(10);
/// Last value for 300 ms, then from 200 to 100 % at 200 %/s.
const SAFE_AFTER_LOSS: Span = Span::from_ms(300 + 500);

struct Xorshift(u64);

impl Xorshift {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, bound: u64) -> u64 {
        (self.next() >> 11) % bound
    }

    fn one_in(&mut self, chances: u64) -> bool {
        self.below(chances) == 0
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize]
    }
}

/// Changes some settings.
fn change_settings(bench: &mut Bench, random: &mut Xorshift) {
    bench.dt = if random.one_in(50) { random.of(&[0, 1, 500, 9_000, 60_000, u32::MAX].map(Span)) } else { TICK };
    if random.one_in(400) {
        let piece = random.of(&PIECES[..7]);
        let count = bench.work.map_or(random.next() as u32 >> 1, |(count, _)| count) + 1;
        bench.work = (!random.one_in(8)).then_some((count, piece));
    }
    if random.one_in(300) {
        bench.dial = if random.one_in(8) { random.next() as u8 } else { random.of(&[100, 100, 100, 96, 91, 110]) };
    }
    if random.one_in(300) {
        let flags = [
            Signals::FEED_HOLD,
            Signals::TAPPING,
            Signals::THREADING,
            Signals::FEED_FORCED,
            Signals::RAPID,
            Signals::CUTTER_COMPENSATION,
            Signals::OVERRIDE_OFF,
        ];
        bench.conditions = if !random.one_in(3) { Signals::NONE } else { random.of(&flags) };
    }
    let fault = BoardFault::Watchdog;
    bench.fault = random.one_in(4_000).then_some(fault).or(bench.fault.filter(|_| !random.one_in(20)));
    bench.request = match bench.request {
        Some(request) if !random.one_in(3) => Some(request),
        _ if random.one_in(100) => {
            Some(random.of(&[Request::Arm, Request::Arm, Request::Arm, Request::Disarm, Request::Reset]))
        }
        _ => None,
    };
    measure_badly(bench, random);
}

fn measure_badly(bench: &mut Bench, random: &mut Xorshift) {
    let wild = [i64::MIN, i64::MAX, 0, -1, 1, 50_000_000].map(Nm);
    bench.pose = if random.one_in(100) {
        Pose { linear: [random.of(&wild), random.of(&wild), random.of(&wild)], ..Pose::default() }
    } else {
        start()
    };
    let speeds = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, 1e-45, -1.0, f32::MAX, f32::MIN_POSITIVE];
    bench.spindle = RevPerMin(if random.one_in(50) { random.of(&speeds) } else { 1_000.0 });
    for (line, stale_ms) in [(&mut bench.position, 20), (&mut bench.link, 100)] {
        let is_gone = line.age > Span::from_ms(stale_ms);
        if random.one_in(if is_gone { 60 } else { 3 }) {
            line.age = Span(random.below(15_000) as u32);
            line.invalid_in_row = 0;
        } else if is_gone || random.one_in(3_000) {
            line.age = line.age.longer_by(bench.dt).max(Span::from_ms(stale_ms + 1));
        } else if random.one_in(1_000) {
            line.invalid_in_row = line.invalid_in_row.saturating_add(random.below(7) as u8);
        }
    }
}

/// State of the walk that is needed to judge the next step.
struct Judge {
    before: Output,
    /// The level before rounding lies below this, %.
    level_below: f64,
    dial: u8,
    request: Option<Request>,
    work: Option<(u32, Piece)>,
    /// The feed the level last acted on, if a block began that no law has taken up yet.
    begun_after: Option<Option<f64>>,
    in_fallback: Span,
    running_ticks: u32,
    arrows: BTreeSet<(&'static str, &'static str)>,
}

impl Judge {
    fn share(dial: u8) -> f64 {
        f64::from(dial.min(100)) / 100.0
    }

    fn judge(&mut self, bench: &Bench, now: &Output) {
        if self.work != bench.work {
            let feed = self.work.and_then(|(_, piece)| bench.feed_sent(piece));
            self.begun_after = self.begun_after.or(Some(feed));
        }
        let percent = f64::from(now.feed_override.percent);
        self.bounds(bench, now, percent);
        self.faults(bench, now, percent);
        self.operator(bench, now, percent);
        self.rise(bench, now, percent);
        self.loss(bench, now, percent);
        if now.state == State::Running && now.reason != Reason::Stale {
            self.begun_after = None;
            self.running_ticks += 1;
        }
        if name(&self.before.state) != name(&now.state) {
            self.arrows.insert((name(&self.before.state), name(&now.state)));
        }
        (self.before, self.dial, self.request, self.work) = (*now, bench.dial, bench.request, bench.work);
    }

    fn bounds(&self, bench: &Bench, now: &Output, percent: f64) {
        assert!(percent <= 200.0, "above max");
        let refusing = Signals::CUTTER_COMPENSATION.with(Signals::OVERRIDE_OFF);
        let quiet = Signals::TAPPING.with(Signals::THREADING).with(Signals::FEED_FORCED).with(Signals::RAPID);
        if now.state == State::Running {
            assert!(!bench.conditions.has(refusing.with(quiet)), "runs under a condition");
            assert!(bench.conditions == Signals::NONE || self.before.state == State::Running);
            assert!(percent <= 200.0 * Judge::share(bench.dial), "above the operator's share");
            let [gone, silent] = [50, 250].map(Span::from_ms);
            assert!(bench.position.age <= gone && bench.link.age <= silent, "runs without samples");
        }
        if now.state == (State::Holding { cause: Hold::Feed }) && self.before.state == now.state {
            assert!(now.feed_override <= self.before.feed_override, "rises while held");
        }
    }

    fn faults(&self, bench: &Bench, now: &Output, percent: f64) {
        let is_faulted = matches!(now.state, State::Faulted { .. });
        assert!(!is_faulted || percent == 0.0, "faulted above 0 %");
        assert!(is_faulted || bench.fault.is_none(), "a fault ignored");
        if matches!(self.before.state, State::Faulted { .. }) && !is_faulted {
            let is_reset = bench.request == Some(Request::Reset) && self.request != bench.request;
            assert!(is_reset && now.state == State::Idle, "left faulted without a reset");
        }
    }

    fn operator(&self, bench: &Bench, now: &Output, percent: f64) {
        let dial = f64::from(bench.dial);
        let by_operator = matches!(now.state, State::Disarmed { by: Disarm::Operator { .. } });
        let falls_far = u16::from(bench.dial) + 10 < u16::from(self.dial);
        assert!(!(by_operator || falls_far || bench.dial < 50) || percent <= dial, "above the dial");
        if bench.dial < self.dial && self.begun_after.is_none() {
            let fall = Judge::share(bench.dial) / Judge::share(self.dial);
            let rise = UP_PERCENT_PER_US * f64::from(bench.dt.min(LONGEST_TICK).0);
            assert!(
                percent <= (self.level_below * fall + rise).max(dial + rise),
                "a reduction did not take effect at once"
            );
        }
    }

    /// The rise is slewed, but for a block that begins while running: it keeps the feed, or goes to 100 % at most.
    fn rise(&mut self, bench: &Bench, now: &Output, percent: f64) {
        let mut highest = self.level_below + UP_PERCENT_PER_US * f64::from(bench.dt.min(LONGEST_TICK).0) + 1e-2;
        let runs_on = self.before.state == State::Running && now.state == State::Running;
        if let (Some(before), true) = (self.begun_after, runs_on) {
            let feeds = before.zip(bench.work.and_then(|(_, piece)| bench.feed_sent(piece)));
            let kept = feeds.map_or(1.0, |(before, after)| (before / after).max(1.0));
            highest = (highest * kept).max(101.0);
        }
        assert!(percent < highest, "rises faster than the slew: {percent} above {highest}");
        self.level_below = highest.min(percent + 1.0);
    }

    fn loss(&mut self, bench: &Bench, now: &Output, percent: f64) {
        let is_fallback = |state: &State| matches!(state, State::Fallback { .. });
        self.in_fallback = match (is_fallback(&self.before.state), is_fallback(&now.state)) {
            (true, true) => self.in_fallback.longer_by(bench.dt),
            (false | true, false) | (false, true) => Span(0),
        };
        assert!(self.in_fallback <= SAFE_AFTER_LOSS || percent <= 100.0, "too long above 100 % after a loss");
    }
}

/// Walks from one seed; answers the arrows taken.
fn walk(seed: u64, limits: OverrideLimits) -> BTreeSet<(&'static str, &'static str)> {
    let mut bench = Bench::new(limits);
    let mut random = Xorshift(seed);
    let before = bench.tick();
    let mut judge = Judge {
        before,
        level_below: 101.0,
        dial: 100,
        request: None,
        work: None,
        begun_after: None,
        in_fallback: Span(0),
        running_ticks: 0,
        arrows: BTreeSet::new(),
    };
    for step in 0..STEPS {
        change_settings(&mut bench, &mut random);
        let now = bench.tick();
        let judged = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| judge.judge(&bench, &now)));
        assert!(judged.is_ok(), "seed {seed:#x}, step {step}: {:?} after {:?}\n{bench:#?}", now, judge.before);
    }
    let (arrows, running) = (judge.arrows.len(), judge.running_ticks);
    println!("seed {seed:#x}: {STEPS} steps, {running} running, {arrows} arrows, {:?}", bench.memory.counters());
    assert!(running > STEPS / 10, "the walk hardly ever runs");
    judge.arrows
}

#[test]
fn nothing_leaves_its_bounds_and_every_arrow_is_taken() {
    let floors = [10, 0];
    let walks = SEEDS.into_iter().zip(floors.into_iter().cycle());
    let taken: BTreeSet<_> = walks
        .flat_map(|(seed, min_percent)| walk(seed, OverrideLimits { min_percent, ..OverrideLimits::default() }))
        .map(|(from, to)| (from.to_owned(), to.to_owned()))
        .collect();
    let drawn: BTreeSet<_> = table("Arrows").into_iter().map(|row| (row[0].clone(), row[1].clone())).collect();
    assert_eq!(taken, drawn, "arrows taken and arrows in the document");
}
