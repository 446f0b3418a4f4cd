//! A supervisor on the bench: every input has a knob, a tick is a millisecond.

use arcfeed_firmware::active::{ActiveSegment, Conditions};
use arcfeed_firmware::controller;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::input::{Freshness, Input};
use arcfeed_law::SegmentLaw;
use arcfeed_law::table::Table;

use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::{BoardFault, Request, Signals};
use arcfeed_firmware::supervisor::state::State;
use arcfeed_firmware::supervisor::{Output, Supervisor};
use arcfeed_model::cut::{CutRule, Moves, RotationCircle, Work};
use arcfeed_model::job::{FeedCeiling, FeedPolicy, Job, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{CupMill, Edge, Tool};
use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::{LengthUnit, Mm, MmPerTooth, Nm, RevPerMin, Span};

/// The tick of all figures.
pub const TICK: Span = Span::from_ms(1);

const RADIUS: Nm = Nm(100_000_000);
const LINE_FEED: Nm = Nm(1_000_000_000);

/// Segment in work, by its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Piece {
    /// An arc whose law wants this many per cent at its start.
    Wants(u16),
    /// An arc that misses the stock.
    Misses,
    /// A line that no law governs.
    Line,
    /// Positioning.
    Rapid,
}

/// The pieces of the random walk, and more for single tests.
pub const PIECES: [Piece; 10] = [
    Piece::Wants(150),
    Piece::Wants(60),
    Piece::Wants(8),
    Piece::Wants(500),
    Piece::Misses,
    Piece::Line,
    Piece::Rapid,
    Piece::Wants(200),
    Piece::Wants(120),
    Piece::Wants(0),
];

/// Supervisor, memory and settings.
#[derive(Clone, Debug)]
pub struct Bench {
    supervisor: Supervisor,
    pub memory: Memory,
    segments: Vec<(Piece, ActiveSegment, f64)>,
    pub work: Option<(u32, Piece)>,
    pub pose: Pose,
    pub spindle: RevPerMin,
    pub dt: Span,
    pub position: Freshness,
    pub link: Freshness,
    pub dial: u8,
    pub conditions: Signals,
    pub fault: Option<BoardFault>,
    pub request: Option<Request>,
}

impl Bench {
    /// Idle, dial and lines at 100 %, fresh samples, nothing in work.
    pub fn new(limits: OverrideLimits) -> Self {
        let job = job(limits);
        Bench {
            supervisor: Supervisor::new(&job, Settings::default()).expect("the settings are sound"),
            memory: Memory::with_override(FeedOverride::PROGRAMMED),
            segments: PIECES.map(|piece| prepare(piece, &job)).to_vec(),
            work: None,
            pose: start(),
            spindle: job.tools.first().spindle,
            dt: TICK,
            position: Freshness::NOW,
            link: Freshness::NOW,
            dial: 100,
            conditions: Signals::NONE,
            fault: None,
            request: None,
        }
    }

    pub fn standard() -> Self {
        Bench::new(OverrideLimits::default())
    }

    /// Armed, nothing in work.
    pub fn armed() -> Self {
        let mut bench = Bench::standard();
        bench.tick();
        bench.ask(Request::Arm);
        assert_eq!(bench.state(), State::Armed);
        bench
    }

    /// Running on a piece, for long enough that the override has settled.
    pub fn running(piece: Piece) -> Self {
        let mut bench = Bench::armed();
        bench.begin(piece);
        bench.run(5_000);
        bench
    }

    pub fn tick(&mut self) -> Output {
        let segment = self.work.and_then(|(count, piece)| {
            self.segments.iter().find(|(other, ..)| *other == piece).map(|(_, segment, _)| (count, segment))
        });
        let measured = controller::Measurement { position: Some(self.pose), spindle: self.spindle, dt: self.dt };
        let input = Input {
            measured,
            position: self.position,
            link: self.link,
            operator_percent: self.dial,
            signals: self
                .conditions
                .with(self.fault.map_or(Signals::NONE, Signals::of_fault))
                .with(self.request.map_or(Signals::NONE, Signals::of_request)),
        };
        self.supervisor.tick(&mut self.memory, segment, &input)
    }

    /// Several ticks, at least one; answers the last.
    pub fn run(&mut self, ticks: u32) -> Output {
        let mut output = self.tick();
        for _ in 1..ticks {
            output = self.tick();
        }
        output
    }

    /// One tick with a button pressed, one with it released; answers the first.
    pub fn ask(&mut self, request: Request) -> Output {
        self.request = Some(request);
        let output = self.tick();
        self.request = None;
        self.tick();
        output
    }

    /// The next block comes into work.
    pub fn begin(&mut self, piece: Piece) {
        let count = self.work.map_or(0, |(count, _)| count) + 1;
        self.work = Some((count, piece));
    }

    /// Ticks during which no valid sample comes; answers the last.
    pub fn silence(&mut self, ticks: u32) -> Output {
        let mut output = None;
        for _ in 0..ticks {
            self.position.age = self.position.age.longer_by(self.dt);
            output = Some(self.tick());
        }
        output.expect("at least one tick")
    }

    pub fn state(&self) -> State {
        self.memory.state()
    }

    /// The feed as sent on a piece; `None` where the override has nothing to act on.
    pub fn feed_sent(&self, piece: Piece) -> Option<f64> {
        let found = self.segments.iter().find(|(other, ..)| *other == piece);
        found.map(|(.., feed)| *feed).filter(|_| piece != Piece::Rapid)
    }
}

/// A state's name as the document has it.
pub fn name(state: &State) -> &'static str {
    match state {
        State::Idle => "idle",
        State::Armed => "armed",
        State::Running => "running",
        State::Holding { .. } => "holding",
        State::Fallback { .. } => "fallback",
        State::Faulted { .. } => "faulted",
        State::Inhibited { .. } => "inhibited",
        State::Disarmed { .. } => "disarmed",
    }
}

/// Start of every arc.
pub fn start() -> Pose {
    Pose { linear: [Nm(0), RADIUS, Nm(0)], ..Pose::default() }
}

fn job(limits: OverrideLimits) -> Job {
    Job {
        unit: LengthUnit::Mm,
        tools: Tools::one(ToolSetup::new(
            Tool::CupMill(CupMill { outer_radius: RADIUS, inner_radius: Nm(90_000_000), active_teeth: 10 }),
            RevPerMin(1_000.0),
            LawKind::Circumference,
            MmPerTooth(0.1),
        )),
        ceiling: FeedCeiling { max_feed: None, max_raise_ratio: 4.0 },
        policy: FeedPolicy::OverrideOnly,
        limits,
        machine: Default::default(),
        rules: Default::default(),
        knots: Default::default(),
    }
}

/// A rule whose stock the cutting circle does not meet.
fn rule_that_misses() -> CutRule {
    let stock = StockLine { normal: [0.0, 1.0], offset_mm: -500.0, rise_ratio: 0.0 };
    CutRule {
        tool: 0,
        moves: Moves::Rotations(RotationCircle::Exterior, Turn::Cw),
        work: Work::Ring(Edge::Outer, Stock::half_plane(stock)),
        feed_per_tooth: None,
        table: None,
        sequence: None,
        level: None,
    }
}

fn segment(path: Path, feed: Feed) -> Segment {
    let end = Pose { linear: [RADIUS, Nm(0), Nm(0)], ..Pose::default() };
    Segment { sequence: None, start: start(), end, feed, path }
}

fn prepare(piece: Piece, job: &Job) -> (Piece, ActiveSegment, f64) {
    let arc = Path::Arc(Arc {
        plane: Plane::Xy,
        turn: Turn::Cw,
        center: [Nm(0), Nm(0)],
        from: [Nm(0), RADIUS],
        to: [RADIUS, Nm(0)],
    });
    let with = |path: Path, feed: Nm, law: Option<SegmentLaw>| {
        let segment = segment(path, Feed::PerMinute(feed));
        let limit = law.as_ref().and_then(|_| job.feed_limit(&segment, Some(feed)));
        let conditions = Conditions { limit, ..Conditions::of(&segment, None, job) };
        let law = law.unwrap_or(SegmentLaw::Programmed);
        (piece, ActiveSegment::with_law(&segment, &law, &conditions, job), feed.to_mm())
    };
    match piece {
        Piece::Wants(percent) => with(arc, feed_for(percent, job), Some(constant(job))),
        Piece::Misses => {
            let segment = segment(arc, Feed::PerMinute(LINE_FEED));
            (piece, ActiveSegment::new(&segment, Some(&rule_that_misses()), job), LINE_FEED.to_mm())
        }
        Piece::Line => with(Path::Line, LINE_FEED, None),
        Piece::Rapid => with(Path::Rapid, LINE_FEED, None),
    }
}

/// One feed per tooth all along: where the tool stands and what comes further on makes no difference.
fn constant(job: &Job) -> SegmentLaw {
    SegmentLaw::Table(Table::new(&[(Mm(0.0), job.tools.first().feed_per_tooth)]).expect("one knot"))
}

/// The feed to send so that the law wants `percent` of it; 0 %: so much that a thousandth of it is wanted.
fn feed_for(percent: u16, job: &Job) -> Nm {
    let teeth_per_min = f64::from(job.tools.first().tool.active_teeth()) * f64::from(job.tools.first().spindle.0);
    let wanted_mm_per_min = f64::from(job.tools.first().feed_per_tooth.0) * teeth_per_min;
    let ratio = if percent == 0 { 1e-3 } else { f64::from(percent) / 100.0 };
    Nm::from_mm(wanted_mm_per_min / (ratio * (1.0 + 1e-6)))
}
