//! A long deterministic run of the controller, and the hash of everything that it puts out.
//!
//! The same code makes the inputs on the desk and on the chip: whole numbers from a seeded generator, and f64 with the
//! four basic operations only, which IEEE 754 fixes to the bit. Blocks of all planes, senses, edges and sizes; positions
//! with noise, spindles that stand still or are no number, ticks of no and of any length, rests between blocks.

use core::hash::{Hash, Hasher};

use arcfeed_firmware::controller::{ActiveSegment, Controller, Input, Output, Reason, State};
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_shared::cut::{CutRule, Moves, Rotation, Work};
use arcfeed_shared::job::{FeedPolicy, Job, LawKind, OverrideLimits};
use arcfeed_shared::nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_shared::segment::{Arc, Path, Segment};
use arcfeed_shared::stock::{Stock, StockLine};
use arcfeed_shared::tool::{CupMill, Edge, Tool};
use arcfeed_shared::units::{LengthUnit, MmPerTooth, Nm, RevPerMin, Span};

use crate::random::Random;

/// Ticks of a run.
pub const TICKS: u32 = 120_000;
/// The laws a run is made for, by the word that a job file uses.
pub const LAWS: [(&str, LawKind); 1] = [("circumference", LawKind::Circumference)];

const SEED: u64 = 0x5eed_0fa2_cfee_d001;
const TICKS_PER_BLOCK: u64 = 400;

/// What came out of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trace {
    /// FNV-1a of all outputs.
    pub hash: u64,
    /// Ticks on which the law's wish decided, bounded or not.
    pub governed: u32,
    /// Ticks on which the law had no wish.
    pub refused: u32,
}

/// Runs [`TICKS`] ticks under a law.
pub fn run(law: LawKind) -> Trace {
    let mut random = Random::new(SEED);
    let mut hash = Fnv::default();
    let mut trace = Trace { hash: 0, governed: 0, refused: 0 };
    let (mut state, mut segment, mut begins) = (State::default(), None, false);
    let mut drawn = Drawn::draw(&mut random, law);
    for _ in 0..TICKS {
        if random.below(TICKS_PER_BLOCK) == 0 {
            drawn = Drawn::draw(&mut random, law);
            let rests = random.below(4) == 0;
            segment = (!rests).then(|| ActiveSegment::new(&drawn.segment, Some(&drawn.rule), &drawn.job));
            begins = true;
        }
        let input = drawn.advance(&mut random);
        let controller = Controller::new(&drawn.job).ok();
        let output = controller.zip(segment.as_ref()).map(|(controller, segment)| match begins {
            true => controller.begin(&mut state, segment, &input),
            false => controller.tick(&mut state, segment, &input),
        });
        begins = false;
        match output.map(|output| output.reason) {
            Some(Reason::Law | Reason::Bounded(_)) => trace.governed += 1,
            Some(Reason::NoWish(_)) => trace.refused += 1,
            _ => {}
        }
        output.map(fields).hash(&mut hash);
    }
    trace.hash = hash.finish();
    trace
}

fn fields(output: Output) -> (FeedOverride, Option<u32>, Reason) {
    (output.feed_override, output.ipt_center.map(|MmPerTooth(mm)| mm.to_bits()), output.reason)
}

/// A job, one block of it, and where on it the tool is.
struct Drawn {
    job: Job,
    rule: CutRule,
    segment: Segment,
    arc: Arc,
    /// From the rotation centre, nm.
    at_nm: [f64; 2],
    /// Cosine and sine of the turn per tick.
    turn: [f64; 2],
}

impl Drawn {
    fn draw(random: &mut Random, law: LawKind) -> Self {
        let inner = 5_000_000 + random.below(200_000_000) as i64;
        let tool = CupMill {
            inner_radius: Nm(inner),
            outer_radius: Nm(inner + 1_000_000 + random.below(50_000_000) as i64),
            active_teeth: 1 + random.below(20) as u16,
        };
        let arc = arc(random);
        let rule = CutRule {
            moves: Moves::Rotations(Rotation::Interior, arc.turn),
            work: Work::Ring(
                *random.one_of(&[Edge::Outer, Edge::Inner]),
                Stock::half_plane(stock(random, &arc, &tool)),
            ),
            feed_per_tooth: None,
            table: None,
            sequence: None,
            level: None,
        };
        let job = Job {
            unit: LengthUnit::Mm,
            tool: Tool::CupMill(tool),
            spindle: RevPerMin(1_000.0),
            law,
            feed_per_tooth: MmPerTooth((1 + random.below(1_000)) as f32 / 1_000.0),
            policy: FeedPolicy::SafeBase,
            limits: limits(random),
            rules: Default::default(),
            knots: Default::default(),
        };
        let feed = Feed::PerMinute(Nm(random.below(3_000_000_000) as i64));
        let at = Pose::default();
        let segment = Segment { sequence: None, start: at, end: at, feed, path: Path::Arc(arc) };
        let sign = f64::from(arc.turn.sign());
        // Up to 2 mrad a tick: through the usual contacts within a block.
        let [cos, sin] = direction(random.below(1_000) as f64 * 1e-6);
        Drawn { job, rule, segment, arc, at_nm: arc.from.map(|Nm(nm)| nm as f64), turn: [cos, sign * sin] }
    }

    /// The inputs of the next tick.
    fn advance(&mut self, random: &mut Random) -> Input {
        let ([x, y], [cos, sin]) = (self.at_nm, self.turn);
        self.at_nm = [x * cos - y * sin, x * sin + y * cos];
        let [first, second] = self.at_nm.map(|nm| Nm(nm as i64 + random.below(10_000) as i64 - 5_000));
        let (first, second) = (self.arc.center[0].0 + first.0, self.arc.center[1].0 + second.0);
        let linear = match self.arc.plane {
            Plane::Xy => [first, second, 0],
            Plane::Zx => [second, 0, first],
            Plane::Yz => [0, first, second],
        };
        let spindle = match random.below(500) {
            0 => f32::NAN,
            1 => f32::INFINITY,
            2 => 0.0,
            rest => rest as f32 * 10.0,
        };
        let dt = if random.below(100) == 0 { random.below(4_000_000_000) } else { random.below(3_000) };
        let position = Pose { linear: linear.map(Nm), ..Pose::default() };
        Input { position: Some(position), spindle: RevPerMin(spindle), dt: Span(dt as u32) }
    }
}

fn arc(random: &mut Random) -> Arc {
    let radius_nm = 1_000_000.0 + random.below(300_000_000) as f64;
    let mut anywhere = || Nm(random.below(2_000_000_000_000) as i64 - 1_000_000_000_000);
    let center = [anywhere(), anywhere()];
    let from = vector(random, radius_nm);
    Arc {
        plane: *random.one_of(&[Plane::Xy, Plane::Zx, Plane::Yz]),
        turn: *random.one_of(&[Turn::Ccw, Turn::Cw]),
        center,
        from,
        to: vector(random, radius_nm),
    }
}

/// A line that the cutting circle meets on most of the arc.
fn stock(random: &mut Random, arc: &Arc, tool: &CupMill) -> StockLine {
    let normal = vector(random, 1e9).map(|Nm(nm)| nm as f64 * 1e-9);
    let [x, y] = [0, 1].map(|axis: usize| arc.center[axis].to_mm());
    let beside_mm = (random.below(2_000) as f64 * 1e-3 - 1.0) * tool.outer_radius.to_mm();
    StockLine { normal, offset_mm: normal[0] * x + normal[1] * y + beside_mm }
}

fn limits(random: &mut Random) -> OverrideLimits {
    OverrideLimits {
        min_percent: random.below(101) as u8,
        max_percent: 100 + random.below(155) as u8,
        step_percent: *random.one_of(&[1, 1, 2, 5, 10]),
        slew_up_percent_per_s: (1 + random.below(500)) as f32,
        slew_down_percent_per_s: (1 + random.below(2_000)) as f32,
    }
}

/// A vector of this length in any direction.
fn vector(random: &mut Random, length: f64) -> [Nm; 2] {
    let [cos, sin] = direction(random.below(2_001) as f64 * 1e-3 - 1.0);
    let mut sign = || if random.below(2) == 0 { length } else { -length };
    [cos * sign(), sin * sign()].map(|nm| Nm(nm as i64))
}

/// The unit vector at the angle whose half has this tangent.
fn direction(half_tangent: f64) -> [f64; 2] {
    let square = half_tangent * half_tangent;
    [(1.0 - square) / (1.0 + square), 2.0 * half_tangent / (1.0 + square)]
}

/// FNV-1a, 64 bits. Sizes and discriminants are hashed as 64 bits: they are shorter on the chip.
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Fnv(0xcbf2_9ce4_8422_2325)
    }
}

impl Hasher for Fnv {
    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn write_isize(&mut self, number: isize) {
        self.write(&(number as i64).to_le_bytes());
    }

    fn write_usize(&mut self, number: usize) {
        self.write(&(number as u64).to_le_bytes());
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
