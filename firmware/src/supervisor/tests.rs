//! The quick paths of [`Supervisor::tick`] do what [`Supervisor::take_in`] does: random walks of two memories, side by side.

use super::*;
use crate::supervisor::input::Freshness;
use crate::supervisor::signals::BoardFault;
use arcfeed_shared::cut::{CutRule, Moves, Rotation};
use arcfeed_shared::job::{FeedPolicy, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_shared::nc::modal::{Feed, Plane, Pose, Turn as ArcTurn};
use arcfeed_shared::segment::{Arc, Path, Segment};
use arcfeed_shared::stock::{Stock, StockLine};
use arcfeed_shared::tool::{CupMill, Edge, Tool};
use arcfeed_shared::units::{LengthUnit, Nm, RevPerMin};

const SEEDS: [u64; 8] = [1, 2, 3, 4, 0xdead_beef, 0x1234_5678_9abc_def1, 1 << 63, u64::MAX];
const STEPS: u32 = 500_000;
/// How often each quick path must be taken for a walk of all seeds to say anything.
const TAKEN_MIN: u32 = 5_000;

const RADIUS_MM: f64 = 100.0;
const SPINDLE: RevPerMin = RevPerMin(1_000.0);
/// Of the blocks under the law, mm/min: from far too low a feed to far too high a one.
const FEEDS_MM_PER_MIN: [f64; 7] = [100.0, 400.0, 700.0, 1_000.0, 2_000.0, 20_000.0, 2_000_000.0];

/// Which way a tick goes.
#[derive(Clone, Copy, Debug)]
enum Way {
    GoOn,
    GoOnOtherwise,
    TakeUp,
    TakeUpOtherwise,
    TakeIn,
}

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

fn mm(x: f64, y: f64) -> [Nm; 2] {
    [Nm::from_mm(x), Nm::from_mm(y)]
}

fn pose([x, y]: [Nm; 2]) -> Pose {
    Pose { linear: [x, y, Nm(0)], ..Pose::default() }
}

fn job(limits: OverrideLimits) -> Job {
    let outer_radius = Nm::from_mm(RADIUS_MM);
    Job {
        unit: LengthUnit::Mm,
        tools: Tools::one(ToolSetup::new(
            Tool::CupMill(CupMill { outer_radius, inner_radius: Nm::from_mm(90.0), active_teeth: 10 }),
            SPINDLE,
            LawKind::Circumference,
            MmPerTooth(0.1),
        )),
        ceiling: Default::default(),
        policy: FeedPolicy::OverrideOnly,
        limits,
        machine: Default::default(),
        rules: Default::default(),
        knots: Default::default(),
    }
}

/// A stock line that the cutting circle meets at 60 degrees from the rotation centre, or never.
fn rule(offset_mm: f64) -> CutRule {
    let stock = Stock::half_plane(StockLine { normal: [0.0, 1.0], offset_mm, rise_ratio: 0.0 });
    CutRule {
        tool: 0,
        moves: Moves::Rotations(Rotation::Exterior, ArcTurn::Cw),
        work: arcfeed_shared::cut::Work::Ring(Edge::Outer, stock),
        feed_per_tooth: None,
        table: None,
        sequence: None,
        level: None,
    }
}

/// Clockwise quarters from the top under every feed, one of them in another plane, one beside the stock; lines, a rapid, no
/// feed.
fn segments(job: &Job) -> Vec<ActiveSegment> {
    let quarter = |plane| {
        let (from, to) = (mm(0.0, RADIUS_MM), mm(RADIUS_MM, 0.0));
        Path::Arc(Arc { plane, turn: ArcTurn::Cw, center: mm(0.0, 0.0), from, to })
    };
    let prepare = |path, feed, offset_mm: Option<f64>| {
        let (start, end) = (pose(mm(0.0, RADIUS_MM)), pose(mm(RADIUS_MM, 0.0)));
        let rule = offset_mm.map(rule);
        ActiveSegment::new(&Segment { sequence: None, start, end, feed, path }, rule.as_ref(), job)
    };
    let sent = |mm_per_min| Feed::PerMinute(Nm::from_mm(mm_per_min));
    let governed = FEEDS_MM_PER_MIN.map(|feed| prepare(quarter(Plane::Xy), sent(feed), Some(50.0)));
    let others = [
        prepare(quarter(Plane::Zx), sent(800.0), Some(50.0)),
        prepare(quarter(Plane::Xy), sent(900.0), Some(-500.0)),
        prepare(quarter(Plane::Xy), sent(1_000.0), None),
        prepare(quarter(Plane::Xy), Feed::Missing, Some(50.0)),
        prepare(Path::Line, sent(1_000.0), None),
        prepare(Path::Rapid, sent(1_000.0), None),
    ];
    [governed.to_vec(), others.to_vec()].concat()
}

/// What the boards of both memories see.
struct Bench {
    random: Xorshift,
    segments: Vec<ActiveSegment>,
    /// Count, and which of the segments.
    work: Option<(u32, usize)>,
    along_mm: f64,
    /// Per tick.
    speed_mm: f64,
    input: Input,
}

impl Bench {
    fn new(seed: u64, job: &Job) -> Self {
        let measured = controller::Input { position: None, spindle: SPINDLE, dt: Span::from_ms(1) };
        let (random, segments) = (Xorshift(seed), segments(job));
        Bench { random, segments, work: None, along_mm: 0.0, speed_mm: 0.02, input: Input::of(measured) }
    }

    fn work(&self) -> Work<'_> {
        self.work.and_then(|(count, index)| self.segments.get(index).map(|segment| (count, segment)))
    }

    fn turn_knobs(&mut self) {
        self.move_axes();
        let random = &mut self.random;
        let dts = [0, 1, 250, 999, 9_999, 10_000, 10_001, 60_000, u32::MAX].map(Span);
        let measured = &mut self.input.measured;
        measured.dt = if random.one_in(20) { random.of(&dts) } else { Span::from_ms(1) };
        let spindles = [0.0, -1.0, f32::NAN, f32::INFINITY, f32::MIN_POSITIVE, 1e-3, 1e5];
        if random.one_in(30) {
            let share = 0.2 + random.below(1_000) as f32 * 2e-3;
            measured.spindle = RevPerMin(if random.one_in(10) { random.of(&spindles) } else { SPINDLE.0 * share });
        }
        if random.one_in(300) || (self.input.operator_percent != 100 && random.one_in(20)) {
            let dial = [100, 100, 100, 101, 99, 95, 91, 120, 80, 40, 0];
            self.input.operator_percent = random.of(&dial);
        }
        self.signal();
        self.age();
    }

    fn move_axes(&mut self) {
        let random = &mut self.random;
        if random.one_in(25) {
            let count = self.work.map_or(0, |(count, _)| count);
            let governed = random.below(FEEDS_MM_PER_MIN.len() as u64);
            let index = if random.one_in(4) { random.below(self.segments.len() as u64) } else { governed };
            // Again the count of the block before is a count too.
            let next = if random.one_in(50) { count.wrapping_sub(1) } else { count.wrapping_add(1) };
            self.work = (!random.one_in(20)).then_some((next, index as usize));
            self.along_mm = 0.0;
            self.speed_mm = random.of(&[0.0, 1e-3, 0.02, 0.05, 0.2, 2.0]);
        }
        self.along_mm = (self.along_mm + self.speed_mm).min(RADIUS_MM * 1.6);
        let angle_rad = (self.along_mm + random.below(5) as f64 * 1e-3) / RADIUS_MM;
        let (sin, cos) = libm::sincos(angle_rad);
        let wild = [i64::MIN, i64::MAX, 0, 1].map(Nm);
        let at = mm(RADIUS_MM * sin, RADIUS_MM * cos);
        let at = if random.one_in(200) { [random.of(&wild), random.of(&wild)] } else { at };
        self.input.measured.position = (!random.one_in(100)).then_some(pose(at));
    }

    fn signal(&mut self) {
        let random = &mut self.random;
        let arm = Signals::of_request(Request::Arm);
        let all = [
            Signals::FEED_HOLD,
            Signals::RAPID,
            Signals::TAPPING,
            Signals::CUTTER_COMPENSATION,
            Signals::of_request(Request::Disarm),
            Signals::of_request(Request::Reset),
            Signals::of_fault(BoardFault::Hardware),
            Signals::of_fault(BoardFault::Hardware).with(Signals::of_request(Request::Reset)),
            arm.with(Signals::FEED_HOLD),
        ];
        self.input.signals = match self.input.signals {
            held if held != Signals::NONE && !random.one_in(3) => held,
            _ if random.one_in(300) => random.of(&all),
            _ if random.one_in(40) => random.of(&[arm, Signals::of_request(Request::Reset)]),
            _ => Signals::NONE,
        };
    }

    fn age(&mut self) {
        let (random, dt) = (&mut self.random, self.input.measured.dt);
        for (line, stale_ms) in [(&mut self.input.position, 20), (&mut self.input.link, 100)] {
            let is_gone = line.age > Span::from_ms(stale_ms) || line.invalid_in_row > 0;
            if random.one_in(if is_gone { 40 } else { 2 }) {
                *line = Freshness { age: Span(random.below(20_001) as u32), invalid_in_row: 0 };
            } else if is_gone || random.one_in(2_000) {
                line.age = line.age.longer_by(dt).max(Span::from_ms(stale_ms));
                line.invalid_in_row = line.invalid_in_row.saturating_add(random.below(2) as u8);
            }
        }
    }
}

/// The way that the next tick goes, by the document of [`Supervisor::tick`].
fn way(supervisor: &Supervisor, memory: &Memory, work: Work<'_>, input: &Input) -> Way {
    let is_quick = input.is_quiet()
        && supervisor.settings.quality(&input.position, &input.link) == Quality::Fresh
        && input.measured.dt <= supervisor.settings.longest_tick;
    let mut control = memory.control;
    match (work, memory.settled_on) {
        (Some((count, segment)), Some(settled_on)) if is_quick && count == settled_on => {
            let wish = supervisor.controller.usual_wish(&mut control, segment, &input.measured);
            if wish.is_some() { Way::GoOn } else { Way::GoOnOtherwise }
        }
        (Some((_, segment)), Some(_)) if is_quick && segment.takes_override() => {
            let wish = supervisor.controller.begin_usual(&mut control, segment, &input.measured);
            if wish.is_some() { Way::TakeUp } else { Way::TakeUpOtherwise }
        }
        _ => Way::TakeIn,
    }
}

/// A walk from one seed; how often it went each way.
fn walk(seed: u64, limits: OverrideLimits, filter: PositionFilter) -> [u32; 5] {
    let job = job(limits);
    let supervisor = Supervisor::new(&job, Settings::default()).unwrap().with_filter(filter);
    let mut bench = Bench::new(seed, &job);
    let (mut quick, mut full) = (Memory::default(), Memory::default());
    let mut ways = [0; 5];
    for step in 0..STEPS {
        bench.turn_knobs();
        let (work, input) = (bench.work(), &bench.input);
        let (before, way) = (quick, way(&supervisor, &quick, work, input));
        ways[way as usize] += 1;
        let outputs = [supervisor.tick(&mut quick, work, input), supervisor.take_in(&mut full, work, input)];
        let told = || format!("seed {seed:#x}, step {step}, {way:?}: {input:?}\nafter {before:?}");
        assert_eq!(outputs[0], outputs[1], "{}", told());
        assert_eq!(Memory { settled_on: None, ..quick }, Memory { settled_on: None, ..full }, "{}", told());
    }
    println!("seed {seed:#x}: {STEPS} steps, [go on, otherwise, take up, otherwise, take in] {ways:?}");
    ways
}

#[test]
fn the_quick_paths_do_what_a_tick_with_everything_in_it_does() {
    let filters = [PositionFilter::Exact, PositionFilter::Exact, PositionFilter::new(0.3, Span(2_000)).unwrap()];
    let mut sums = [0; 5];
    for (index, seed) in SEEDS.into_iter().enumerate() {
        let min_percent = if index % 2 == 0 { 10 } else { 0 };
        let defaults = OverrideLimits::default();
        // So fast that a tick may more than double the override.
        let up = if index % 4 < 2 { defaults.slew_up_percent_per_s } else { 3_000.0 };
        let limits = OverrideLimits { min_percent, slew_up_percent_per_s: up, ..defaults };
        let ways = walk(seed, limits, filters[index % filters.len()]);
        sums.iter_mut().zip(ways).for_each(|(sum, ways)| *sum += ways);
    }
    println!("{} steps: {sums:?}", sums.iter().sum::<u32>());
    for way in [Way::GoOn, Way::GoOnOtherwise, Way::TakeUp, Way::TakeUpOtherwise] {
        assert!(sums[way as usize] >= TAKEN_MIN, "{way:?} in {sums:?}");
    }
}
