//! The envelope against the motion that it is for: an override that follows it late and falls by its slew, tick by tick.

use super::*;
use arcfeed_law::table::Table;
use arcfeed_nc::modal::{Feed, Pose};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{Mm, MmPerTooth, Nm};

const TEETH: f32 = 4.0;
const SPINDLE: RevPerMin = RevPerMin(2_500.0);
const TICK_S: f64 = 1e-3;

/// A line under a table of ratios to the feed as sent.
struct Case {
    law: SegmentLaw,
    track: Track,
    sent: Sent,
    limits: OverrideLimits,
}

fn case(length_mm: f64, feed_mm_per_min: f32, ratios: &[(f32, f32)]) -> Case {
    let per_ratio = feed_mm_per_min / (SPINDLE.0 * TEETH);
    let knots: Vec<_> = ratios.iter().map(|(mm, ratio)| (Mm(*mm), MmPerTooth(ratio * per_ratio))).collect();
    let end = Pose { linear: [Nm::from_mm(length_mm), Nm(0), Nm(0)], ..Pose::default() };
    let segment = Segment { sequence: None, start: Pose::default(), end, feed: Feed::Missing, path: Path::Line };
    Case {
        law: SegmentLaw::Table(Table::new(&knots).unwrap()),
        track: Track::new(&segment).unwrap(),
        sent: Sent {
            feed: MmPerMin(feed_mm_per_min),
            teeth_min_per_mm: TEETH / feed_mm_per_min,
            spindle: SPINDLE,
            max_ratio: 2.0,
            end_percent: 100,
        },
        limits: OverrideLimits::default(),
    }
}

impl Case {
    fn envelope(&self) -> Envelope {
        Envelope::new(&self.law, &self.track, &self.sent, &self.limits)
    }

    fn demand(&self, at_mm: f64) -> f64 {
        f64::from(self.sent.demand(&self.law, &self.track.place_after(at_mm as f32)).unwrap())
    }

    /// Runs the line, each decision taking effect as late as it may: the largest excess over the demand, and the ratio at the end.
    fn run(&self, response_s: f64) -> (f64, f64) {
        let (envelope, length_mm) = (self.envelope(), f64::from(self.track.length_mm()));
        let (feed, fall) = (f64::from(self.sent.feed.0) / 60.0, f64::from(self.limits.slew_down_percent_per_s) / 1e2);
        let (mut at_mm, mut level, mut excess, mut in_effect) = (0.0, 1.0_f64, f64::NEG_INFINITY, 1.0);
        let mut decided = std::collections::VecDeque::from(vec![1.0; (response_s / TICK_S) as usize]);
        while at_mm < length_mm {
            let target = f64::from(envelope.at(at_mm as f32).0);
            level = target.max(level - fall * TICK_S).min(level + 0.5 * TICK_S);
            decided.push_back(libm::floor(level * 1e2 + 1e-3) / 1e2);
            in_effect = decided.pop_front().unwrap();
            excess = excess.max(in_effect / self.demand(at_mm) - 1.0);
            at_mm += in_effect * feed * TICK_S;
        }
        (excess, in_effect)
    }
}

#[test]
fn the_override_is_down_before_every_fall_of_the_demand_and_at_the_end() {
    let jump = [(0.0, 2.0), (60.0, 2.0), (60.001, 1.0), (80.0, 1.0), (80.001, 1.8)];
    let slope = [(0.0, 1.9), (30.0, 1.1), (50.0, 1.9), (99.0, 1.2)];
    let spike = [(0.0, 2.0), (70.0, 2.0), (70.5, 1.05), (71.0, 2.0)];
    for (name, ratios) in
        [("jump", &jump[..]), ("slope", &slope), ("spike", &spike), ("rise", &[(0.0, 1.0), (50.0, 2.0)])]
    {
        for feed in [300.0, 1_000.0, 3_000.0, 8_000.0] {
            for response_s in [0.0, f64::from(RESPONSE_S)] {
                let (excess, end) = case(100.0, feed, ratios).run(response_s);
                println!("{name} at {feed} mm/min, {response_s} s late: {excess:+.4}, {end} at the end");
                assert!(excess <= 5e-3 && end <= 1.0, "{name} {feed} {response_s}: {excess} {end}");
            }
        }
    }
}

#[test]
fn what_need_not_fall_is_not_held_back_before_the_end() {
    let envelope = case(100.0, 600.0, &[(0.0, 1.5)]).envelope();
    // From 1.5 to 1 at 0.9 of 2 a second: (1.5^2 - 1) 10 / (2 0.9 2) = 3.47 mm, and 0.03 s at 15 mm/s.
    for (at_mm, ratio) in [(0.0, 1.5), (96.0, 1.5), (96.08, 1.5), (99.56, 1.0), (100.0, 1.0)] {
        let allowed = envelope.at(at_mm).0;
        assert!((allowed - ratio).abs() < 1e-3, "{at_mm}: {allowed}");
    }
    let half = fmath::sqrt(1.0 + (1.5 * 1.5 - 1.0) / 2.0);
    assert!((envelope.at(99.55 - 3.472 / 2.0).0 - half).abs() < 1e-3);
}

#[test]
fn a_smooth_demand_is_allowed_as_it_is() {
    let knots: Vec<(f32, f32)> =
        (0_u16..=12).map(|at| f32::from(8 * at)).map(|at| (at, 1.3 - 0.2 * libm::sinf(at / 60.0))).collect();
    let case = case(100.0, 600.0, &knots);
    let envelope = Envelope::new(&case.law, &case.track, &Sent { end_percent: 200, ..case.sent }, &case.limits);
    for at_mm in 0..99_u16 {
        // It falls by at most a third of a per cent a millimetre; the response and two cells reach two millimetres ahead.
        let (allowed, demand) = (envelope.at(f32::from(at_mm)).0, case.demand(f64::from(at_mm)) as f32);
        assert!((-0.007..1e-6).contains(&(allowed / demand - 1.0)), "{at_mm}: {allowed} of {demand}");
    }
}

#[test]
fn what_comes_behind_the_end_bounds_it() {
    let case = case(100.0, 600.0, &[(0.0, 1.5)]);
    for (end_percent, ratio) in [(80, 0.8), (120, 1.2), (180, 1.5)] {
        let envelope = Envelope::new(&case.law, &case.track, &Sent { end_percent, ..case.sent }, &case.limits);
        assert!((envelope.at(100.0).0 - ratio).abs() < 1e-3, "{end_percent}");
        assert_eq!(envelope.begin_percent(), 150);
    }
}

#[test]
fn a_slower_spindle_lowers_it_and_a_faster_one_does_not_raise_it() {
    let envelope = case(100.0, 600.0, &[(0.0, 1.5)]).envelope();
    for (speed, share) in [(0.5, 0.5), (1.0, 1.0), (2.0, 1.0), (0.0, 1.0), (f32::NAN, 1.0)] {
        assert_eq!(envelope.spindle_share(RevPerMin(speed * SPINDLE.0)), share);
    }
}

#[test]
fn the_ratio_is_never_above_the_demand_and_little_below() {
    let bent: Vec<(f32, f32)> =
        (0_u16..=31).map(|at| (3.2 * f32::from(at), 1.5 + 0.3 * f32::from(at % 3) / 2.0)).collect();
    let convex: Vec<(f32, f32)> =
        (0_u16..=31).map(|at| 3.2 * f32::from(at)).map(|at| (at, 1.1 + (at - 50.0).powi(2) * 3e-4)).collect();
    for ratios in [bent, convex] {
        let case = case(100.0, 600.0, &ratios);
        let envelope = Envelope::new(&case.law, &case.track, &Sent { end_percent: 200, ..case.sent }, &case.limits);
        for at in 0..10_000 {
            let at_mm = f64::from(at) * 0.01;
            let (ratio, demand) = (f64::from(envelope.at(at_mm as f32).0), case.demand(at_mm));
            assert!(ratio <= demand * (1.0 + 1e-6), "{at_mm}: {ratio} of {demand}");
            // Two cells behind; the response, two cells, and the way to a knot in the next one ahead.
            let least = (0..=430).map(|ahead| case.demand((at_mm + 0.01 * f64::from(ahead) - 1.6).clamp(0.0, 100.0)));
            let least = least.fold(f64::INFINITY, f64::min);
            assert!(ratio > least * (1.0 - 1e-3), "{at_mm}: {ratio} for {least}");
        }
    }
}

#[test]
fn a_segment_shorter_than_the_response_stays_at_the_bound_of_its_end() {
    for length_mm in [0.0, 0.4] {
        let envelope = case(length_mm, 1_000.0, &[(0.0, 2.0)]).envelope();
        assert!([0.0, 0.2, 0.4].iter().all(|at| envelope.at(*at).0 == 1.0));
        assert_eq!(envelope.begin_percent(), 100);
    }
}

#[test]
fn without_a_law_only_a_lower_start_of_the_next_move_bounds_it() {
    let Case { track, sent, limits, .. } = case(10.0, 1_000.0, &[(0.0, 2.0)]);
    let envelope = |end_percent| Envelope::new(&SegmentLaw::Programmed, &track, &Sent { end_percent, ..sent }, &limits);
    assert_eq!(envelope(100).at(5.0), (1.0, Err(NoDemand::NoLaw)));
    assert_eq!(envelope(100).begin_percent(), 100);
    assert_eq!((envelope(80).at(0.0).0, envelope(80).at(10.0).0), (1.0, 0.8));
    assert_eq!(Envelope::constant(80).at(0.0).0, 0.8);
}

#[test]
fn each_ratio_becomes_the_least_of_those_that_begin_with_it() {
    let ratios: Vec<f32> = (0..40_u16).map(|k| f32::from(k * 37 % 41)).collect();
    for count in 1..=50 {
        let mut lowered = ratios.clone();
        lower_to_least(&mut lowered, count);
        for (at, least) in lowered.iter().enumerate() {
            let truth = ratios[at..].iter().take(count).copied().fold(f32::INFINITY, f32::min);
            assert_eq!(*least, truth, "{count} from {at}");
        }
    }
}
