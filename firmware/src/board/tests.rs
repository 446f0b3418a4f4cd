//! From inputs to pins: a task on a board whose override goes out on eight lines.

use super::*;
use crate::active::{ActiveSegment, Conditions};
use crate::controller;
use crate::output::OverrideOutput;
use crate::output::bench::{Bench, Pin};
use crate::output::latched::Latched;
use crate::output::parallel_lines::ParallelLines;
use crate::supervisor::report::Reason;
use crate::supervisor::settings::Settings;
use crate::supervisor::signals::{BoardFault, Request, Signals};
use crate::supervisor::state::State;
use arcfeed_law::SegmentLaw;
use arcfeed_law::table::Table;
use arcfeed_model::job::{FeedPolicy, Job, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::tool::{CupMill, Tool};
use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::{LengthUnit, Mm, MmPerTooth, Nm, RevPerMin, Span};

const RADIUS_MM: f64 = 100.0;
/// 0.1 mm a tooth, 10 teeth, 1000 rev/min: 1000 mm/min, 125 % of the feed that was sent.
const FEED_PER_TOOTH: MmPerTooth = MmPerTooth(0.1);
const SPINDLE: RevPerMin = RevPerMin(1_000.0);
const FEED_SENT: Nm = Nm(800_000_000);
const WANTED_PERCENT: f64 = 125.0;
/// The slews of the default limits at ticks of 1 ms.
const UP_PERCENT: f64 = 0.05;
const DOWN_PERCENT: f64 = 0.2;
const TICK: Span = Span::from_ms(1);
/// More than what single precision adds up to in a run, %.
const ROUNDING_PERCENT: f64 = 0.005;

/// A board whose axes move along its segment, and that reports its lines' fault.
struct Mill<'b> {
    segment: Option<(u32, ActiveSegment)>,
    ticks: u32,
    request: Signals,
    input: Input,
    lines: Latched<ParallelLines<Pin<'b>>>,
}

impl Board for Mill<'_> {
    fn measure(&mut self) {
        self.ticks += 1;
        // 20 um a tick are 1200 mm/min.
        let (sin, cos) = libm::sincos(0.02 * f64::from(self.ticks) / RADIUS_MM);
        self.input.measured.position = Some(pose(RADIUS_MM * sin, RADIUS_MM * cos));
        let fault = self.lines.fault().map_or(Signals::NONE, |_| Signals::of_fault(BoardFault::Hardware));
        self.input.signals = fault.with(self.request);
    }

    fn input(&self) -> &Input {
        &self.input
    }

    fn work(&self) -> Work<'_> {
        self.segment.as_ref().map(|(count, segment)| (*count, segment))
    }

    fn set_override(&mut self, feed_override: FeedOverride) {
        let _ = self.lines.put(feed_override);
    }
}

/// The levels of the eight pins.
struct Pins<'b> {
    bench: &'b Bench,
    high: u8,
}

impl Pins<'_> {
    /// Takes what was written since the last time; bit i for *FVi, 1 for high.
    fn high(&mut self) -> u8 {
        for (wire, high) in self.bench.written() {
            self.high = if high { self.high | 1 << wire } else { self.high & !(1 << wire) };
        }
        self.bench.clear();
        self.high
    }
}

fn pose(x_mm: f64, y_mm: f64) -> Pose {
    Pose { linear: [Nm::from_mm(x_mm), Nm::from_mm(y_mm), Nm(0)], ..Pose::default() }
}

fn job() -> Job {
    let (outer_radius, inner_radius) = (Nm::from_mm(RADIUS_MM), Nm::from_mm(90.0));
    Job {
        unit: LengthUnit::Mm,
        tools: Tools::one(ToolSetup::new(
            Tool::CupMill(CupMill { outer_radius, inner_radius, active_teeth: 10 }),
            SPINDLE,
            LawKind::Programmed,
            FEED_PER_TOOTH,
        )),
        ceiling: Default::default(),
        policy: FeedPolicy::OverrideOnly,
        limits: OverrideLimits::default(),
        machine: Default::default(),
        rules: Default::default(),
        knots: Default::default(),
    }
}

/// A clockwise quarter on which one feed per tooth is wanted.
fn quarter(job: &Job) -> ActiveSegment {
    let (from, to) = ([Nm(0), Nm::from_mm(RADIUS_MM)], [Nm::from_mm(RADIUS_MM), Nm(0)]);
    let arc = Arc { plane: Plane::Xy, turn: Turn::Cw, center: [Nm(0); 2], from, to };
    let (start, end) = (pose(0.0, RADIUS_MM), pose(RADIUS_MM, 0.0));
    let segment = Segment { sequence: None, start, end, feed: Feed::PerMinute(FEED_SENT), path: Path::Arc(arc) };
    let table = Table::new(&[(Mm(0.0), FEED_PER_TOOTH)]).unwrap();
    ActiveSegment::with_law(&segment, &SegmentLaw::Table(table), &Conditions::of(&segment, None, job), job)
}

fn mill<'b>(bench: &'b Bench, job: &Job) -> (Mill<'b>, Pins<'b>) {
    let measured = controller::Measurement { position: None, spindle: job.tools.first().spindle, dt: TICK };
    let lines = Latched::new(ParallelLines::new(bench.pins()).unwrap());
    let segment = Some((1, quarter(job)));
    let mill = Mill { segment, ticks: 0, request: Signals::NONE, input: Input::of(measured), lines };
    (mill, Pins { bench, high: u8::MAX })
}

/// A tick; the override, which the pins carry as inverted binary: *FVi low for each weight 2^i in it.
fn tick(task: &mut Task, supervisor: &Supervisor, mill: &mut Mill<'_>, pins: &mut Pins<'_>) -> Output {
    let output = task.run(supervisor, mill);
    assert_eq!(pins.high(), !output.feed_override.percent, "tick {}: {output:?}", mill.ticks);
    output
}

#[test]
fn the_pins_carry_the_inverted_binary_of_the_override_at_each_tick_of_a_segment() {
    let (bench, job) = (Bench::default(), job());
    let (mut mill, mut pins) = mill(&bench, &job);
    let supervisor = Supervisor::new(&job, Settings::default()).unwrap();
    let mut task = Task::from(Memory::armed());
    let mut seen = std::collections::BTreeSet::new();
    // Up by the slew, there for a while, down to half the demand with half the spindle's speed.
    let mut due_percent: f64 = 100.0;
    for at in 1..=1_200 {
        if at == 801 {
            mill.input.measured.spindle = RevPerMin(SPINDLE.0 / 2.0);
        }
        due_percent = if at <= 800 {
            (due_percent + UP_PERCENT).min(WANTED_PERCENT)
        } else {
            (due_percent - DOWN_PERCENT).max(WANTED_PERCENT / 2.0)
        };
        let output = tick(&mut task, &supervisor, &mut mill, &mut pins);
        let due = [-ROUNDING_PERCENT, ROUNDING_PERCENT].map(|off| libm::floor(due_percent + off) as u8);
        assert!(due.contains(&output.feed_override.percent), "tick {at}: {output:?}, {due_percent} % is due");
        assert_eq!((output.state, output.reason), (State::Running, Reason::Law));
        seen.insert(output.feed_override.percent);
    }
    // Each whole percentage from 62 to 125.
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), (62..=125).collect::<Vec<u8>>());
}

#[test]
fn after_a_pin_has_failed_the_pins_carry_0_percent_until_a_person_resets() {
    let (bench, job) = (Bench::default(), job());
    let (mut mill, mut pins) = mill(&bench, &job);
    let supervisor = Supervisor::new(&job, Settings::default()).unwrap();
    let mut task = Task::from(Memory::armed());
    for _ in 0..300 {
        tick(&mut task, &supervisor, &mut mill, &mut pins);
    }
    // *FV3 says that it failed, though it obeys: not to be trusted.
    bench.refuses.set(Some((3, true)));
    let refused = (0..100).find(|_| {
        task.run(&supervisor, &mut mill);
        mill.lines.fault().is_some()
    });
    assert!(refused.is_some(), "the pin was never written");
    assert_eq!(pins.high(), u8::MAX, "released in the tick that found it");
    bench.refuses.set(None);
    for _ in 0..1_000 {
        let output = tick(&mut task, &supervisor, &mut mill, &mut pins);
        assert_eq!(output.state, State::Faulted { fault: BoardFault::Hardware });
        assert_eq!(output.feed_override.percent, 0);
    }
    mill.lines.reset();
    mill.request = Signals::of_request(Request::Reset);
    assert_eq!(tick(&mut task, &supervisor, &mut mill, &mut pins).state, State::Idle);
    let risen = (0..100).map(|_| tick(&mut task, &supervisor, &mut mill, &mut pins)).last();
    assert_eq!(risen.map(|output| output.feed_override.percent), Some(5), "from 0 % by the slew to the dial's");
}
