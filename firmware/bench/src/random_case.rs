//! Random jobs, blocks and tool paths from a seed: a superset of the controller's real inputs.
//!
//! Whole numbers from a seeded generator, and f64 with the four basic operations only, which IEEE 754 fixes to the bit.
//! Blocks of all planes, senses, edges, sides and sizes; stock of each kind; feeds per tooth and depths that no law can
//! take; positions with noise, now and then missing, trusted as they are or filtered; spindles that stand still or are no
//! number, ticks of no and of any length.

use arcfeed_firmware::active::{ActiveSegment, Conditions};
use arcfeed_firmware::controller::Measurement;
use arcfeed_firmware::progress::PositionFilter;
use arcfeed_law::SegmentLaw;
use arcfeed_law::table::Table;
use arcfeed_model::cut::{ContourSide, CutRule, Moves, RotationCircle, Work};
use arcfeed_model::job::{FeedPolicy, Job, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::knots::{Knot, TABLE_KNOTS_MAX};
use arcfeed_model::stock::{EDGES_MAX, Stock, StockLine};
use arcfeed_model::tool::{CupMill, Edge, EndMill, Tool};
use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::{LengthUnit, Mm, MmPerTooth, Nm, RevPerMin, Span};

use crate::random::Random;

/// One of this number of position samples is missing.
const MISSING: u64 = 50;

/// Law under which random cases are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LawChoice {
    /// This law of a job.
    Job(LawKind),
    /// A random table of feeds per tooth, without a job's law.
    Table,
}

/// A random job, one block that it governs, and the moving position of the tool on that block.
#[derive(Debug)]
pub struct RandomCase {
    /// The random job, with its limits.
    pub job: Job,
    /// Filter of position samples.
    pub filter: PositionFilter,
    rule: CutRule,
    segment: Segment,
    table: Option<Table>,
    route: Route,
}

/// Path of the tool's centre. Keeps its state between calls.
#[derive(Clone, Copy, Debug)]
enum Route {
    /// Position relative to the rotation centre, nm; cosine and sine of the turn per tick.
    Arc { arc: Arc, at_nm: [f64; 2], turn: [f64; 2] },
    /// Position and displacement per tick, nm.
    Line { at_nm: [f64; 3], step_nm: [f64; 3] },
}

impl RandomCase {
    /// Draws a random case for a law.
    pub fn draw(random: &mut Random, choice: LawChoice) -> Self {
        let is_for_rings = matches!(choice, LawChoice::Job(LawKind::Circumference | LawKind::EngagedArc { .. }));
        let cutting = if is_for_rings { for_ring(random, choice) } else { for_end_mill(random) };
        let Cutting { tool, segment, route, moves, work } = cutting;
        let law = match choice {
            LawChoice::Job(law) => law,
            LawChoice::Table => LawKind::Programmed,
        };
        let feed_per_tooth = match random.below(10) {
            0 => Some(MmPerTooth(0.0)),
            1 | 2 => Some(MmPerTooth((1 + random.below(500)) as f32 / 1_000.0)),
            _ => None,
        };
        let job = Job {
            unit: LengthUnit::Mm,
            tools: Tools::one(ToolSetup::new(
                tool,
                RevPerMin(1_000.0),
                law,
                MmPerTooth((1 + random.below(1_000)) as f32 / 1_000.0),
            )),
            ceiling: Default::default(),
            policy: FeedPolicy::SafeBase,
            limits: limits(random),
            machine: Default::default(),
            rules: Default::default(),
            knots: Default::default(),
        };
        let table = (choice == LawChoice::Table).then(|| table(random, &segment)).flatten();
        let rule = CutRule { tool: 0, moves, work, feed_per_tooth, table: None, sequence: None, level: None };
        RandomCase { job, filter: filter(random), rule, segment, table, route }
    }

    /// The block, prepared for the controller under its law.
    pub fn active(&self) -> ActiveSegment {
        let conditions = Conditions::of(&self.segment, Some(&self.rule), &self.job);
        match &self.table {
            Some(table) => {
                ActiveSegment::with_law(&self.segment, &SegmentLaw::Table(table.clone()), &conditions, &self.job)
            }
            None => ActiveSegment::with_conditions(&self.segment, &conditions, &self.job),
        }
    }

    /// Whether the block is a straight move.
    pub fn is_line(&self) -> bool {
        self.segment.path == Path::Line
    }

    /// Stock of the block if its tool is a cup mill; `None` for an end mill.
    pub fn stock(&self) -> Option<&Stock> {
        match &self.rule.work {
            Work::Ring(_, stock) => Some(stock),
            Work::Mill { .. } => None,
        }
    }

    /// Moves the tool on by one tick, and returns what the board measures then.
    pub fn advance(&mut self, random: &mut Random) -> Measurement {
        let mut noisy = |nm: f64| Nm(nm as i64 + random.below(10_000) as i64 - 5_000);
        let linear = match &mut self.route {
            Route::Arc { arc, at_nm, turn: [cos, sin] } => {
                let [x, y] = *at_nm;
                *at_nm = [x * *cos - y * *sin, x * *sin + y * *cos];
                in_space(arc, at_nm.map(&mut noisy))
            }
            Route::Line { at_nm, step_nm } => {
                for (at, step) in at_nm.iter_mut().zip(step_nm) {
                    *at += *step;
                }
                at_nm.map(&mut noisy)
            }
        };
        let spindle = match random.below(500) {
            0 => f32::NAN,
            1 => f32::INFINITY,
            2 => 0.0,
            rest => rest as f32 * 10.0,
        };
        let dt = if random.below(100) == 0 { random.below(4_000_000_000) } else { random.below(3_000) };
        let position = (random.below(MISSING) != 0).then_some(Pose { linear, ..Pose::default() });
        Measurement { position, spindle: RevPerMin(spindle), dt: Span(dt as u32) }
    }
}

/// A tool on a block, with the data of its rule.
struct Cutting {
    tool: Tool,
    segment: Segment,
    route: Route,
    moves: Moves,
    work: Work,
}

/// An arc of a cup mill. The circumference law accepts a line as the stock, the other one any stock.
fn for_ring(random: &mut Random, choice: LawChoice) -> Cutting {
    let inner = 5_000_000 + random.below(200_000_000) as i64;
    let tool = CupMill {
        inner_radius: Nm(inner),
        outer_radius: Nm(inner + 1_000_000 + random.below(50_000_000) as i64),
        active_teeth: teeth(random),
    };
    let (segment, arc, route) = arc(random);
    let stock = match (choice, random.below(3)) {
        (LawChoice::Job(LawKind::Circumference), _) | (_, 0) => Stock::half_plane(line(random, &arc, &tool)),
        (_, 1) => polygon(random, &arc, &tool),
        _ => disc(random, &arc, &tool),
    };
    let work = Work::Ring(*random.one_of(&[Edge::Outer, Edge::Inner]), stock);
    let moves = Moves::Rotations(RotationCircle::Interior, arc.turn);
    Cutting { tool: Tool::CupMill(tool), segment, route, moves, work }
}

/// A line or an arc of an end mill; one depth in five exceeds the tool's diameter.
fn for_end_mill(random: &mut Random) -> Cutting {
    let radius = 1_000_000 + random.below(100_000_000);
    let tool = EndMill { radius: Nm(radius as i64), teeth: teeth(random) };
    let side = *random.one_of(&[ContourSide::Inside, ContourSide::Outside, ContourSide::Slot]);
    let work = Work::Mill { side, radial_depth: Nm(random.below(radius / 2 * 5) as i64) };
    let (segment, route, moves) = if random.below(2) == 0 {
        let (segment, route) = straight(random);
        (segment, route, Moves::Lines)
    } else {
        let (segment, arc, route) = arc(random);
        (segment, route, Moves::Arcs(arc.turn))
    };
    Cutting { tool: Tool::EndMill(tool), segment, route, moves, work }
}

fn teeth(random: &mut Random) -> u16 {
    1 + random.below(20) as u16
}

fn segment(random: &mut Random, [start, end]: [Pose; 2], path: Path) -> Segment {
    Segment { sequence: None, start, end, feed: Feed::PerMinute(Nm(random.below(3_000_000_000) as i64)), path }
}

fn anywhere(random: &mut Random) -> Nm {
    Nm(random.below(2_000_000_000_000) as i64 - 1_000_000_000_000)
}

fn arc(random: &mut Random) -> (Segment, Arc, Route) {
    let radius_nm = 1_000_000.0 + random.below(300_000_000) as f64;
    let center = [anywhere(random), anywhere(random)];
    let from = vector(random, radius_nm);
    let to = vector(random, radius_nm);
    let plane = *random.one_of(&[Plane::Xy, Plane::Zx, Plane::Yz]);
    let arc = Arc { plane, turn: *random.one_of(&[Turn::Ccw, Turn::Cw]), center, from, to };
    let ends = [from, to].map(|end| Pose { linear: in_space(&arc, end), ..Pose::default() });
    // Up to 2 mrad a tick: through the usual contacts within a block.
    let [cos, sin] = direction(random.below(1_000) as f64 * 1e-6);
    let turn = [cos, f64::from(arc.turn.sign()) * sin];
    let route = Route::Arc { arc, at_nm: from.map(|Nm(nm)| nm as f64), turn };
    (segment(random, ends, Path::Arc(arc)), arc, route)
}

/// Converts a position relative to an arc's rotation centre to program coordinates.
fn in_space(arc: &Arc, [first, second]: [Nm; 2]) -> [Nm; 3] {
    let [x, y] = arc.center;
    let (first, second) = (Nm(x.0 + first.0), Nm(y.0 + second.0));
    match arc.plane {
        Plane::Xy => [first, second, Nm(0)],
        Plane::Zx => [second, Nm(0), first],
        Plane::Yz => [Nm(0), first, second],
    }
}

/// A line in any direction, some of them of no length, done in 50 to 800 ticks.
fn straight(random: &mut Random) -> (Segment, Route) {
    let start = [anywhere(random), anywhere(random), anywhere(random)];
    let reach = *random.one_of(&[0, 1_000_000, 100_000_000, 100_000_000, 100_000_000]);
    let way = start.map(|_| Nm(random.below(2 * reach + 1) as i64 - reach as i64));
    let mut end = start;
    for (end, way) in end.iter_mut().zip(way) {
        end.0 += way.0;
    }
    let ticks = (50 + random.below(750)) as f64;
    let step_nm = way.map(|Nm(nm)| nm as f64 / ticks);
    let ends = [start, end].map(|linear| Pose { linear, ..Pose::default() });
    (segment(random, ends, Path::Line), Route::Line { at_nm: start.map(|Nm(nm)| nm as f64), step_nm })
}

/// A line that the cutting circle meets on most of the arc.
fn line(random: &mut Random, arc: &Arc, tool: &CupMill) -> StockLine {
    let normal = vector(random, 1e9).map(|Nm(nm)| nm as f64 * 1e-9);
    let [x, y] = arc.center.map(Nm::to_mm);
    let beside_mm = (random.below(2_000) as f64 * 1e-3 - 1.0) * tool.outer_radius.to_mm();
    StockLine { normal, offset_mm: normal[0] * x + normal[1] * y + beside_mm, rise_ratio: 0.0 }
}

/// A piece with its corners on a circle near the arc: in their order they are convex.
fn polygon(random: &mut Random, arc: &Arc, tool: &CupMill) -> Stock {
    let (center_mm, radius_mm) = round(random, arc, tool);
    let count = 3 + random.below(EDGES_MAX as u64 - 2) as usize;
    let mut corners = [[0.0; 2]; EDGES_MAX];
    for (index, corner) in corners.iter_mut().take(count).enumerate() {
        let part = (index as f64 + random.below(900) as f64 * 1e-3) / count as f64;
        let [cos, sin] = direction(6.0 * part - 3.0);
        *corner = [center_mm[0] + radius_mm * cos, center_mm[1] + radius_mm * sin];
    }
    Stock::polygon(&corners[..count]).expect("corners on a circle, in their order, are convex")
}

fn disc(random: &mut Random, arc: &Arc, tool: &CupMill) -> Stock {
    let (center_mm, radius_mm) = round(random, arc, tool);
    Stock::Disc { center_mm, radius_mm }
}

/// A circle that the tool reaches on much of the arc: its centre and radius, mm.
fn round(random: &mut Random, arc: &Arc, tool: &CupMill) -> ([f64; 2], f64) {
    let far_mm = (random.below(1_500) as f64 * 1e-3) * tool.outer_radius.to_mm();
    let [dx, dy] = vector(random, 1e9).map(|Nm(nm)| nm as f64 * 1e-9 * far_mm);
    let [x, y] = arc.center.map(Nm::to_mm);
    ([x + dx, y + dy], (0.2 + random.below(1_500) as f64 * 1e-3) * tool.outer_radius.to_mm())
}

/// 1 to 32 knots along the block, some beyond its end.
fn table(random: &mut Random, segment: &Segment) -> Option<Table> {
    let count = 1 + random.below(TABLE_KNOTS_MAX as u64) as usize;
    let apart_mm = (segment.length_mm() as f32).max(1.0) * 1.2 / count as f32;
    let mut knots = [(Mm(0.0), MmPerTooth(0.0)); TABLE_KNOTS_MAX];
    for (index, knot) in knots.iter_mut().take(count).enumerate() {
        let travelled_mm = (index as f32 + random.below(900) as f32 * 1e-3) * apart_mm;
        *knot = (Mm(travelled_mm), MmPerTooth((1 + random.below(1_000)) as f32 / 1_000.0));
    }
    let knots: &[Knot] = &knots[..count];
    Table::new(knots).ok()
}

/// As they are, or with any gain and delay.
fn filter(random: &mut Random) -> PositionFilter {
    let gain_ratio = (1 + random.below(999)) as f32 / 1_000.0;
    let delay = Span(random.below(5_000) as u32);
    let filtered = PositionFilter::new(gain_ratio, delay).filter(|_| random.below(2) == 0);
    filtered.unwrap_or(PositionFilter::Exact)
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
