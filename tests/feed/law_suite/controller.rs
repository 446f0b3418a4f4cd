//! The supervisor with a law in it: what leaves it is bounded, slewed and on the thin side, whatever goes in.

use super::scenes::CircumferenceScene;
use super::{PLAIN, Scene};
use crate::geometry::log_between;
use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller::Measurement;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::{self, Output, Supervisor};
use arcfeed_model::cut::{CutRule, Moves, RotationCircle, Work};
use arcfeed_model::job::{FeedPolicy, Job, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::stock::Stock;
use arcfeed_model::tool::{CupMill, Edge, Tool};
use arcfeed_nc::modal::{Feed, Pose};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{LengthUnit, MmPerTooth, Nm, RevPerMin, Span};
use fastrand::Rng;

/// Time on the arc.
const DURATION_US: u64 = 2_000_000;
const TEETH: u16 = 10;
const REV_PER_MIN: f32 = 1000.0;
/// Largest increase of the wanted feed by rounding, relative.
const THICK: f64 = 1e-5;

/// A job and its one arc.
#[derive(Clone, Debug)]
struct Setup {
    scene: CircumferenceScene,
    job: Job,
    segment: Segment,
    rule: CutRule,
    feed_sent: f64,
}

impl Setup {
    /// The law's demand in the middle of the arc is between a twentieth and three times the feed sent.
    fn sample(random: &mut Rng, law: LawKind) -> Self {
        loop {
            let scene = CircumferenceScene::sample(random);
            let Ok(demand) = scene.demand(&PLAIN, 0.5) else { continue };
            let feed = Nm::from_mm(demand * f64::from(TEETH) * f64::from(REV_PER_MIN) / log_between(random, 0.05, 3.0));
            let limits = OverrideLimits {
                min_percent: random.u8(0..=100),
                max_percent: random.u8(100..=254),
                step_percent: [1, 1, 2, 5, 10][random.usize(..5)],
                ..OverrideLimits::default()
            };
            return Setup::new(scene, feed, limits, law);
        }
    }

    fn new(scene: CircumferenceScene, feed: Nm, limits: OverrideLimits, law: LawKind) -> Self {
        let arc = scene.arc();
        let other = if scene.edge == Edge::Outer { 0.5 } else { 2.0 } * scene.edge_radius;
        let [outer_radius, inner_radius] =
            [scene.edge_radius.max(other), scene.edge_radius.min(other)].map(Nm::from_mm);
        let rule = CutRule {
            tool: 0,
            moves: Moves::Rotations(RotationCircle::Interior, arc.turn),
            work: Work::Ring(scene.edge, Stock::half_plane(scene.stock())),
            feed_per_tooth: None,
            table: None,
            sequence: None,
            level: None,
        };
        let job = Job {
            unit: LengthUnit::Mm,
            tools: Tools::one(ToolSetup::new(
                Tool::CupMill(CupMill { outer_radius, inner_radius, active_teeth: TEETH }),
                RevPerMin(REV_PER_MIN),
                law,
                MmPerTooth(scene.chip as f32),
            )),
            ceiling: Default::default(),
            policy: FeedPolicy::OverrideOnly,
            limits,
            machine: Default::default(),
            rules: core::iter::once(rule.clone()).collect(),
            knots: Default::default(),
        };
        let pose = |[x, y]: [Nm; 2]| Pose { linear: [x, y, Nm(0)], ..Pose::default() };
        let segment = Segment {
            sequence: None,
            start: pose(arc.from),
            end: pose(arc.to),
            feed: Feed::PerMinute(feed),
            path: Path::Arc(arc),
        };
        Setup { scene, job, segment, rule, feed_sent: feed.to_mm() }
    }

    /// At a steady speed along the arc.
    fn pose(&self, at_us: u64) -> Pose {
        let ratio = at_us as f64 / DURATION_US as f64;
        let center = self.scene.place(ratio).center_mm.map(|mm| Nm::from_mm(f64::from(mm)));
        Pose { linear: [center[0], center[1], Nm(0)], ..Pose::default() }
    }

    /// One tick every `dt_us` from the start on, with what `input` makes of the plain one.
    fn run(&self, dt_us: u64, input: impl FnMut(u64, Measurement) -> Measurement) -> Vec<Output> {
        self.run_with_levels(dt_us, input).into_iter().map(|(output, _)| output).collect()
    }

    /// The same, with what is put out before rounding.
    fn run_with_levels(
        &self,
        dt_us: u64,
        mut input: impl FnMut(u64, Measurement) -> Measurement,
    ) -> Vec<(Output, f64)> {
        let supervisor = Supervisor::new(&self.job, Settings::default()).expect("limits that make sense");
        let segment = ActiveSegment::new(&self.segment, Some(&self.rule), &self.job);
        let mut memory = Memory::armed();
        let tick = |i: u64| {
            let position = Some(self.pose(i * dt_us));
            let plain = Measurement { position, spindle: RevPerMin(REV_PER_MIN), dt: Span(dt_us as u32) };
            let input = supervisor::input::Input::of(input(i * dt_us, plain));
            let output = supervisor.tick(&mut memory, Some((0, &segment)), &input);
            (output, f64::from(memory.level().ratio()))
        };
        (1..=DURATION_US / dt_us).map(tick).collect()
    }

    fn in_bounds(&self, outputs: &[Output]) -> bool {
        let limits = &self.job.limits;
        let least_percent = limits.min_percent - limits.min_percent % limits.step_percent;
        outputs.iter().all(|output| (least_percent..=limits.max_percent).contains(&output.feed_override.percent))
    }
}

fn percent(output: &Output) -> f64 {
    f64::from(output.feed_override.percent)
}

fn weird_input(random: &mut Rng, plain: Measurement) -> Measurement {
    let speeds = [0.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-45, 3.4e38];
    let coordinates = [0, i64::MAX, i64::MIN, 1, -1_000_000];
    let mut input = plain;
    match random.u8(..5) {
        0 => input.spindle = RevPerMin(speeds[random.usize(..speeds.len())]),
        1 => input.position = None,
        2 => {
            let linear = [0; 3].map(|_| Nm(coordinates[random.usize(..5)]));
            input.position = Some(Pose { linear, ..Pose::default() });
        }
        3 => input.dt = Span([0, 1, 1_000_000, u32::MAX][random.usize(..4)]),
        _ => {}
    }
    input
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_firmware::supervisor::report::Reason;

    const CASES: u32 = 300;

    /// Runs `check` on many setups.
    fn on_many(seed: u64, law: LawKind, mut check: impl FnMut(&mut Rng, &Setup)) {
        println!("seed {seed}");
        let mut random = Rng::with_seed(seed);
        for _ in 0..CASES {
            let setup = Setup::sample(&mut random, law);
            check(&mut random, &setup);
        }
    }

    #[test]
    fn the_override_stays_within_its_limits_whatever_is_measured() {
        on_many(11, LawKind::Circumference, |random, setup| {
            let outputs = setup.run(5_000, |_, plain| weird_input(random, plain));
            let percents = || outputs.iter().map(|output| output.feed_override.percent);
            let range = (percents().min(), percents().max());
            assert!(setup.in_bounds(&outputs), "{range:?} under {:?}: {setup:?}", setup.job.limits);
        });
    }

    #[test]
    fn a_segment_without_a_law_runs_as_programmed_whatever_is_measured() {
        on_many(12, LawKind::Programmed, |random, setup| {
            let outputs = setup.run(5_000, |_, plain| weird_input(random, plain));
            assert!(outputs.iter().all(|output| output.feed_override.percent == 100), "{setup:?}");
            assert!(outputs.iter().all(|output| output.reason == Reason::NoLaw && output.ipt_center.is_none()));
        });
    }

    #[test]
    fn between_any_two_ticks_the_override_slews_no_faster_than_allowed() {
        on_many(13, LawKind::Circumference, |random, setup| {
            let dt_us = [500, 1_000, 8_000][random.usize(..3)];
            let stopped = random.u64(..DURATION_US);
            let outputs = setup.run(dt_us, |at_us, plain| {
                // A spindle that stops makes the demand jump to 100 %.
                if at_us > stopped { Measurement { spindle: RevPerMin(0.0), ..plain } } else { plain }
            });
            let limits = &setup.job.limits;
            let (up, down) = (f64::from(limits.slew_up_percent_per_s), f64::from(limits.slew_down_percent_per_s));
            for apart in [1, 2, 10, 100] {
                for pair in outputs.windows(apart + 1) {
                    let (change, dt_s) =
                        (percent(&pair[apart]) - percent(&pair[0]), (apart as u64 * dt_us) as f64 / 1e6);
                    // Rounding moves either end by less than a step.
                    let step = f64::from(limits.step_percent) + 1e-3;
                    assert!(
                        change <= up * dt_s + step && -change <= down * dt_s + step,
                        "{change} in {dt_s} s: {setup:?}"
                    );
                }
            }
        });
    }

    /// The largest relative excess of the feed in effect over the feed that the law itself demands where the tool is, where no bound
    /// keeps them apart, nor the slew on the way down.
    fn excess(setup: &Setup) -> (f64, f64) {
        let ticks = setup.run_with_levels(1_000, |_, plain| plain);
        let fall = f64::from(setup.job.limits.slew_down_percent_per_s) / 100.0 * 1e-3;
        let excess = |(pair, tick): (&[(Output, f64)], u64)| {
            let [(_, before), (output, level)] = pair else { return None };
            let demand = setup.scene.demand(&PLAIN, (tick * 1_000) as f64 / DURATION_US as f64).ok()?;
            let wanted = demand * f64::from(TEETH) * f64::from(REV_PER_MIN);
            let is_free = output.reason == Reason::Law && before - level < 0.99 * fall;
            is_free.then_some((percent(output) / 100.0 * setup.feed_sent / wanted - 1.0, percent(output)))
        };
        ticks
            .windows(2)
            .zip(2..)
            .filter_map(excess)
            .fold((f64::NEG_INFINITY, 0.0), |one, other| if other.0 > one.0 { other } else { one })
    }

    #[test]
    fn the_override_never_makes_the_chip_thicker_than_wanted_by_more_than_rounding() {
        let mut largest = (f64::NEG_INFINITY, 0.0, None);
        on_many(14, LawKind::Circumference, |_, setup| {
            let (excess, at) = excess(setup);
            if excess > largest.0 {
                largest = (excess, at, Some(setup.job.limits.step_percent));
            }
        });
        println!("largest excess {:.2e} at {} %, step {:?}", largest.0, largest.1, largest.2);
        assert!(largest.0 <= THICK, "{largest:?}");
    }

    #[test]
    fn half_the_period_gives_the_same_override_within_a_step() {
        let (mut compared, mut differ) = (0, 0);
        on_many(15, LawKind::Circumference, |_, setup| {
            let (whole, half) = (setup.run(2_000, |_, plain| plain), setup.run(1_000, |_, plain| plain));
            for (one, other) in whole.iter().zip(half.iter().skip(1).step_by(2)) {
                let apart = (percent(one) - percent(other)).abs();
                compared += 1;
                differ += u32::from(apart > 0.0);
                assert!(apart <= f64::from(setup.job.limits.step_percent), "{one:?}, {other:?}: {setup:?}");
            }
        });
        println!("{compared} ticks compared, {differ} differ by a step");
    }

    #[test]
    fn a_hold_keeps_the_override_and_a_stopped_spindle_takes_it_to_100() {
        on_many(16, LawKind::Circumference, |random, setup| {
            let held = setup.pose(random.u64(DURATION_US / 10..DURATION_US));
            let outputs = setup.run(1_000, |_, plain| Measurement { position: Some(held), ..plain });
            let last = outputs.len() - 1;
            assert!(setup.in_bounds(&outputs) && outputs[last].feed_override == outputs[last - 1].feed_override);
            // From 254 % down and from 0 % up both take no longer than the two seconds.
            let stopped = setup.run(1_000, |_, plain| Measurement { spindle: RevPerMin(0.0), ..plain });
            assert_eq!((stopped[last].feed_override.percent, stopped[last].reason), (100, Reason::NoSpindle));
            assert!(setup.in_bounds(&stopped));
        });
    }

    #[test]
    fn without_samples_the_override_stays_bounded_and_settles() {
        on_many(17, LawKind::Circumference, |random, setup| {
            let lost = random.u64(..DURATION_US / 4);
            let outputs = setup
                .run(1_000, |at_us, plain| Measurement { position: plain.position.filter(|_| at_us < lost), ..plain });
            assert!(setup.in_bounds(&outputs));
            // With a filter that follows the samples as they come the place stays, and so does the demand, which is not reported while the
            // override is below its first step and holds the axes.
            let demands: Vec<_> =
                outputs[lost as usize / 1_000 + 1..].iter().filter_map(|tick| tick.ipt_center).collect();
            assert!(demands.windows(2).all(|pair| pair[0] == pair[1]), "{setup:?}");
        });
    }
}
