//! The engaged-arc law against brute force, on 10^4 random stocks and on 10^4 random tables of engaged arcs.
//!
//! *The oracle* knows no formula for a step. It samples 10^4 directions of each cutting circle (and the ends of the
//! engaged set between two samples by bisection), keeps those inside the stock whose edge advances, and looks for the
//! shortest path after which the thickest chip over them is a: the chip is the distance by which the circle has moved on
//! along the ray (see `geometry`), the path is found by bracketing. All in f64.
//!
//! *What the law's definition leaves out.* The thickest chip of a tooth is where its chord points, half a turn of the
//! tooth from v. Where an end of the engaged set lies between the two, the law takes v for the chord: the class "between
//! v and chord", off either way by at most what the step for a contact at v itself is longer than the chord's.
//!
//! *Where the oracle ends.* Once a circle has left its old centre a ray from there meets it twice or not at all: steps with a chord
//! longer than r0 are not looked for, and where the law gives one it is counted, not judged.
//!
//! *How far f32 may be off.* Lengths up to `lengths` times r0 are rounded before they are subtracted; over the sine of the
//! angle between circle and boundary that moves the end, and the step with it as fast as the oracle's own step changes
//! when its end is moved. Roundings of the chip and of the terms of the step count as fast as the step changes with the
//! chip. Both rates are measured, not derived ([`Truth::condition`]).

use crate::geometry::{
    Frame, Motion, Point, RingScene, chip, chip_at_most, dot, engaged_deg, engaged_table, sample_table, sign, unit,
};
use arcfeed_law::circumference::Circumference;
use arcfeed_law::engaged_arc::{EdgePolicy, EngagedArc, Ring};
use arcfeed_law::region::Region;
use arcfeed_law::step::Cut;
use arcfeed_law::{FeedDemand, FeedLaw, NoDemand, Place};
use arcfeed_model::engaged::EngagedTable;
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::Edge;
use arcfeed_nc::modal::{Plane, Turn};
use arcfeed_nc::segment::Arc;
use arcfeed_units::{MM_PER_INCH, Mm, MmPerTooth, Nm};
use core::f64::consts::{PI, TAU};
use fastrand::Rng;

const SCENES: usize = 10_000;
/// Sampled angles of each circle.
const SAMPLES: usize = 10_000;
/// Half a unit in the last place of f32, relative.
const HALF_ULP: f64 = 1.0 / (1 << 24) as f64;
/// Half units that may add up along the law's formulas where nothing is magnified.
const ROUNDINGS: f64 = 12.0;
/// Closer to a boundary or to a right angle than this, rounding the inputs decides.
const BRINK: f64 = 1e-4;
/// Below this sine of the angle between circle and boundary the end of the engaged set is a matter of rounding.
const TANGENT: f64 = 0.02;
/// Above this rate of the step with the chip (1 far from grazing) no step may reach the chip, or only just.
const GRAZING: f64 = 4.0;

/// Result of brute force for one edge.
#[derive(Clone, Copy, Debug)]
struct Truth {
    /// The path, or why there is none.
    path: Result<f64, NoDemand>,
    /// Relative change of the path by one half unit of rounding everywhere, in half units.
    condition: f64,
    /// If an end of the engaged set lies between v and the chord: relative error of taking v for the chord.
    between: Option<f64>,
    /// Whether rounding decides the contact.
    brink: bool,
    /// Whether the step only just reaches the chip.
    grazing: bool,
}

/// One edge of a scene at its place.
struct EdgeAt<'s> {
    scene: &'s RingScene,
    frame: Frame,
    edge: Edge,
    motion: Motion,
}

/// The path whose chord is `chord`.
fn path_of_chord(motion: &Motion, chord: f64) -> f64 {
    if motion.path_radius.is_infinite() {
        return chord;
    }
    2.0 * motion.path_radius * libm::asin(chord / (2.0 * motion.path_radius))
}

/// The longest path that leaves a circle's old centre inside it.
fn farthest(motion: &Motion, r0: f64) -> f64 {
    if r0 < 2.0 * motion.path_radius { path_of_chord(motion, r0) } else { PI * motion.path_radius }
}

/// The last place between `low`, where `holds`, and `high`, where it does not.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

/// The shortest path after which the thickest chip over `directions` is `wanted`; none where it never is.
fn shortest_path(motion: &Motion, (k, r0): (f64, f64), directions: &[Point], wanted: f64) -> Option<f64> {
    // The direction of the thickest chip so far is looked at first; few others may then have a thicker one.
    let mut best = *directions.first()?;
    let mut thickest = |path: f64| {
        let way = motion.way(path);
        // Below nothing at all it does not matter by how much.
        let mut most = chip(k, r0, best, way).max(-wanted);
        for u in directions {
            if chip_at_most(k, r0, *u, way) > most {
                let found = chip(k, r0, *u, way);
                (most, best) = if found > most { (found, *u) } else { (most, best) };
            }
        }
        most
    };
    // No chip is thicker than the chord; and a circle that has left its old centre takes no chip in the sense of the law.
    let mut low = path_of_chord(motion, wanted);
    let farthest = farthest(motion, r0);
    let mut below = thickest(low) - wanted;
    if below >= 0.0 {
        return Some(low);
    }
    let (mut high, mut above) = loop {
        let growth = if below <= -0.9 * wanted { 1.25 } else { (1.001 * wanted / (below + wanted)).clamp(1.001, 1.25) };
        let next = low * growth;
        if next > farthest {
            return None;
        }
        let error = thickest(next) - wanted;
        if error >= 0.0 {
            break (next, error);
        }
        (low, below) = (next, error);
    };
    // False position, Illinois: the end that stays counts half.
    for _ in 0..60 {
        let middle = (low * above - high * below) / (above - below);
        let error = thickest(middle) - wanted;
        if libm::fabs(error) < 1e-13 * wanted || high - low < 1e-13 * high {
            return Some(middle);
        }
        if error < 0.0 {
            (low, below, above) = (middle, error, above / 2.0);
        } else {
            (high, above, below) = (middle, error, below / 2.0);
        }
    }
    Some((low + high) / 2.0)
}

impl<'s> EdgeAt<'s> {
    fn new(scene: &'s RingScene, edge: Edge) -> Self {
        EdgeAt { scene, frame: scene.frame(0.5), edge, motion: scene.motion() }
    }

    fn circle(&self) -> (f64, f64) {
        (sign(self.edge), self.scene.radius(self.edge))
    }

    fn depth(&self, u: Point) -> f64 {
        self.scene.depth_mm(&self.frame, self.edge, u)
    }

    fn path(&self, directions: &[Point], wanted: f64) -> Option<f64> {
        shortest_path(&self.motion, self.circle(), directions, wanted)
    }

    fn truth(&self, table: &[Point]) -> Truth {
        let (k, r0) = self.circle();
        let inside: Vec<bool> = table.iter().map(|u| self.depth(*u) >= 0.0).collect();
        let flips = (0..SAMPLES).filter(|i| inside[*i] != inside[(i + 1) % SAMPLES]);
        let flips: Vec<usize> = flips.collect();
        let angle = |i: usize| TAU * i as f64 / SAMPLES as f64;
        let end = |i: &usize| {
            let within = |angle: f64| self.depth(unit(angle)) >= 0.0;
            bisect(angle(*i), angle(i + 1), |angle| within(angle) == inside[*i])
        };
        let ends: Vec<f64> = flips.iter().map(end).collect();
        let advancing = |u: &Point| k * u[0] > 0.0;
        let sampled = table.iter().zip(&inside).filter(|(_, inside)| **inside).map(|(u, _)| *u);
        let directions: Vec<Point> = sampled.chain(ends.iter().map(|angle| unit(*angle))).filter(advancing).collect();
        let tiny = flips.windows(2).any(|pair| pair[1] - pair[0] < 3);
        let path = if !inside.contains(&true) {
            Err(NoDemand::NoContact)
        } else if directions.is_empty() {
            Err(NoDemand::OutsideValidity)
        } else {
            self.path(&directions, self.scene.chip).ok_or(NoDemand::ChipUnreachable)
        };
        let brink = tiny
            || self.is_narrow()
            || libm::fabs(self.depth([k, 0.0])) < BRINK * r0
            || ends.iter().any(|angle| libm::fabs(libm::cos(*angle)) < BRINK || self.crossing(*angle) < TANGENT)
            || (ends.is_empty() && table.iter().any(|u| libm::fabs(self.depth(*u)) < BRINK * r0));
        self.judged(path, &ends, brink)
    }

    /// The sine of the angle between circle and boundary.
    fn crossing(&self, angle: f64) -> f64 {
        let [before, behind] = [-1e-6, 1e-6].map(|step| self.depth(unit(angle + step)));
        libm::fabs(behind - before) / 2e-6 / self.circle().1
    }

    /// Adds to a path how well it is known.
    fn judged(&self, path: Result<f64, NoDemand>, ends: &[f64], brink: bool) -> Truth {
        let plain = Truth { path, condition: 1.0, between: None, brink, grazing: false };
        let (k, a) = (self.circle().0, self.scene.chip);
        let probe = path.unwrap_or_else(|_| path_of_chord(&self.motion, a));
        let way = self.motion.way(probe);
        let length = libm::hypot(way[0], way[1]);
        let chord = [k * way[0] / length, k * way[1] / length];
        let is_between = (self.depth([k, 0.0]) >= 0.0) != (self.depth(chord) >= 0.0);
        let at_v = || self.path(&[[k, 0.0]], a).unwrap_or(f64::INFINITY);
        let between = is_between.then(|| at_v() / path_of_chord(&self.motion, a) - 1.0);
        let decisive = ends
            .iter()
            .filter_map(|angle| Some((self.path(&[unit(*angle)], a)?, *angle)))
            .min_by(|one, other| one.0.total_cmp(&other.0));
        let (Ok(path), Some((least, angle))) = (path, decisive) else { return Truth { between, ..plain } };
        if self.depth(chord) >= 0.0 || libm::fabs(least / path - 1.0) > 1e-6 {
            return Truth { between, ..plain };
        }
        let one = |angle: f64, chip: f64| self.path(&[unit(angle)], chip);
        let rate = |low: Option<f64>, high: Option<f64>, step: f64| match (low, high) {
            (Some(low), Some(high)) => libm::fabs(high - low) / path / (2.0 * step),
            _ => f64::INFINITY,
        };
        let by_angle = rate(one(angle - 1e-5, a), one(angle + 1e-5, a), 1e-5);
        let by_chip = rate(one(angle, a * (1.0 - 1e-5)), one(angle, a * (1.0 + 1e-5)), 1e-5);
        let condition = 1.0 + by_chip + by_angle * (1.0 + self.lengths() / self.crossing(angle));
        Truth { condition, between, grazing: by_chip > GRAZING, ..plain }
    }

    /// Lengths that are rounded before the distance of circle and boundary comes out of them, over r0.
    fn lengths(&self) -> f64 {
        let from_origin = |p: Point| libm::hypot(p[0] - self.scene.origin[0], p[1] - self.scene.origin[1]);
        let stock = match &self.scene.stock {
            Stock::Convex(lines) => {
                lines.iter().map(|line| libm::fabs(line.distance_mm(self.scene.origin))).fold(0.0, f64::max)
            }
            Stock::Disc { center_mm, radius_mm } => from_origin(*center_mm) + radius_mm,
            Stock::Engaged(table) => return self.angles(table),
            Stock::PerMove => f64::NAN,
        };
        let r0 = self.circle().1;
        (from_origin(self.frame.position) + stock + r0) / r0
    }

    /// The same of a table: the end's angle, and the path it follows, radians.
    fn angles(&self, table: &EngagedTable) -> f64 {
        let (at, step) = (self.frame.travelled, 1e-6 * self.scene.length);
        let [before, here, behind] = [at - step, at, at + step].map(|path| engaged_deg(table, self.edge, path));
        let angle = |i: usize| libm::fabs(here[i]) + libm::fabs(at * (behind[i] - before[i]) / (2.0 * step));
        angle(0).max(angle(1)).to_radians()
    }

    /// Whether the engaged arc of a table lies between two samples, or would if it were not just empty.
    fn is_narrow(&self) -> bool {
        let Stock::Engaged(table) = &self.scene.stock else { return false };
        let [from, to] = engaged_deg(table, self.edge, self.frame.travelled);
        libm::fabs(to - from).to_radians() < 3.0 * TAU / SAMPLES as f64
    }
}

fn table() -> Vec<Point> {
    (0..SAMPLES).map(|i| unit(TAU * i as f64 / SAMPLES as f64)).collect()
}

/// The least of the edges' paths; of refusals the one that says most about the cut.
fn together(truths: &[Truth]) -> Truth {
    let path = |truth: &Truth| truth.path.unwrap_or(f64::INFINITY);
    let mut least = *truths.iter().min_by(|one, other| path(one).total_cmp(&path(other))).expect("an edge");
    if least.path.is_err() {
        let why = |why: NoDemand| truths.iter().any(|truth| truth.path == Err(why)).then_some(Err(why));
        let kinds = [NoDemand::ChipUnreachable, NoDemand::OutsideValidity].map(why);
        least.path = kinds.into_iter().flatten().next().unwrap_or(Err(NoDemand::NoContact));
    }
    least.brink = truths.iter().any(|truth| truth.brink);
    least.between = truths.iter().filter_map(|truth| truth.between).reduce(f64::max);
    least
}

/// A movement of Petean's table 5.4 on its arc of the NC listing with the stock line fitted to it (see `stock_fit`), inches.
struct Row {
    edge: Edge,
    turn: Turn,
    start: Point,
    center_offset: Point,
    /// Normal, degrees from +X, and offset.
    line: Point,
}

/// N144, N146, N150 and N152.
const ROWS: [Row; 4] = [
    Row {
        edge: Edge::Outer,
        turn: Turn::Ccw,
        start: [-2.967, 11.3933],
        center_offset: [3.2165, -3.0564],
        line: [54.187, 4.2391],
    },
    Row {
        edge: Edge::Outer,
        turn: Turn::Cw,
        start: [-3.6044, 10.5358],
        center_offset: [4.0397, -3.0504],
        line: [48.104, 10.4502],
    },
    Row {
        edge: Edge::Inner,
        turn: Turn::Ccw,
        start: [-2.6598, 11.491],
        center_offset: [3.0951, -4.0056],
        line: [81.715, 10.7843],
    },
    Row {
        edge: Edge::Inner,
        turn: Turn::Cw,
        start: [-3.6045, 10.5358],
        center_offset: [3.854, -2.1988],
        line: [97.563, 7.2959],
    },
];
/// Ends of the four arcs.
const ENDS: [Point; 4] = [[-3.6044, 10.5358], [-2.5752, 11.5549], [-3.6045, 10.5358], [-3.0241, 11.3322]];
/// R, r and a (Petean 5.2, table 5.4).
const PUBLISHED: [f64; 3] = [5.06205, 4.43706, 0.004];
/// n z, assumed.
const TEETH_PER_MIN: f64 = 1e4;

impl Row {
    fn arc(&self, end: Point) -> Arc {
        let nm = |point: Point| point.map(|inches| Nm::from_mm(inches * MM_PER_INCH));
        let ([from, offset, to], minus) = ([self.start, self.center_offset, end].map(nm), |a: Nm, b: Nm| Nm(a.0 - b.0));
        let center = [0, 1].map(|i| Nm(from[i].0 + offset[i].0));
        let [from, to] = [from, to].map(|point| [minus(point[0], center[0]), minus(point[1], center[1])]);
        Arc { plane: Plane::Xy, turn: self.turn, center, from, to }
    }

    /// Circumference and engaged-arc law, in/min, at this part of the arc.
    fn feeds(&self, end: Point, ratio: f64) -> [f64; 2] {
        let (arc, stock) = (self.arc(end), StockLine::from_angle(self.line[0], self.line[1] * MM_PER_INCH));
        let [outer, inner, a] = PUBLISHED.map(|inches| (inches * MM_PER_INCH) as f32);
        let (path_radius, feed_per_tooth) = (Mm(arc.radius_mm() as f32), MmPerTooth(a));
        let edge_radius = if self.edge == Edge::Outer { outer } else { inner };
        let ring = Ring { outer_radius: Mm(outer), inner_radius: Mm(inner), path_radius, feed_per_tooth };
        let half_plane = Stock::Convex([stock].into_iter().collect());
        let region = Region::new(&half_plane, arc.center.map(Nm::to_mm), 0.0).expect("a shape");
        let direction = arc.direction_at(ratio).map(|x| x as f32);
        let place = Place::on_arc(direction, f32::from(arc.turn.sign()), path_radius.0, 0.0);
        let one = Circumference::for_arc(&arc, Mm(edge_radius), self.edge, &stock, feed_per_tooth).demand(&place);
        let other = EngagedArc::new(ring, EdgePolicy::Only(self.edge), region).demand(&place);
        let feed = |demand: FeedDemand| f64::from(demand.path_mm_per_tooth) / MM_PER_INCH * TEETH_PER_MIN;
        [one, other].map(|demand| feed(demand.expect("both laws govern the published arcs")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use std::sync::OnceLock;

    /// Cases that are not judged.
    const BEYOND: &str = "a step beyond where the oracle looks";

    /// Errors of one class, relative: positive where the law's step is longer, the chip thicker.
    #[derive(Default)]
    struct Class {
        errors: Vec<f64>,
        half_units: f64,
    }

    /// Results of all scenes.
    #[derive(Default)]
    struct Outcome {
        classes: BTreeMap<String, Class>,
        refused: BTreeMap<String, u32>,
        /// Errors of "between v and chord" over the allowance for them.
        of_allowance: f64,
        wrong: Vec<String>,
        wrong_reasons: Vec<String>,
    }

    impl Class {
        fn print(&mut self, name: &str) {
            self.errors.sort_by(|one, other| libm::fabs(*one).total_cmp(&libm::fabs(*other)));
            let (Some(last), count) = (self.errors.last(), self.errors.len()) else { return };
            let (median, coarse) =
                (libm::fabs(self.errors[count / 2]), self.errors.iter().filter(|error| libm::fabs(**error) > 1e-5));
            println!(
                "{name}: {count} cases, median {median:.1e}, largest {last:+.1e}, {} above 1e-5; {:.2} half units over the condition",
                coarse.count(),
                self.half_units
            );
        }
    }

    fn kind(truth: &Truth) -> &'static str {
        match truth {
            Truth { between: Some(_), .. } => "between v and chord",
            Truth { grazing: true, .. } => "grazing",
            Truth { condition: 1.0, .. } => "straight ahead",
            _ => "an end",
        }
    }

    impl Outcome {
        fn compare(&mut self, scene: &RingScene, truth: &Truth) {
            let found = scene.law().demand(&scene.place(0.5)).map(|demand| f64::from(demand.path_mm_per_tooth));
            let policy = if scene.policy == EdgePolicy::Both { "both edges" } else { "one edge" };
            match (found, truth.path) {
                (found, path) if truth.brink => {
                    let same = if found.is_ok() == path.is_ok() { "same" } else { "other" };
                    *self.refused.entry(format!("on the brink, {same}")).or_default() += 1;
                }
                (Ok(found), Ok(path)) => {
                    let error = found / path - 1.0;
                    let definition = truth.between.unwrap_or(0.0);
                    let half_units = (libm::fabs(error) - definition).max(0.0) / HALF_ULP / truth.condition;
                    if truth.between.is_some() {
                        self.of_allowance = self.of_allowance.max(libm::fabs(error) / definition);
                    }
                    let class = self.classes.entry(format!("{policy}, {}", kind(truth))).or_default();
                    class.errors.push(error);
                    class.half_units = class.half_units.max(half_units);
                    if half_units.is_nan() || half_units > ROUNDINGS {
                        self.wrong.push(format!("{error:+.1e}, {half_units:.1} half units: {truth:?} {scene:?}"));
                    }
                }
                (Err(found), Err(why)) => {
                    *self.refused.entry(format!("{policy}: {found:?}, brute force {why:?}")).or_default() += 1;
                    if found != why {
                        self.wrong_reasons.push(format!("{found:?}, should be {why:?}: {scene:?}"));
                    }
                }
                (Ok(found), Err(NoDemand::ChipUnreachable))
                    if found
                        > scene
                            .edges()
                            .iter()
                            .map(|edge| farthest(&scene.motion(), scene.radius(*edge)))
                            .fold(0.0, f64::max) =>
                {
                    *self.refused.entry(BEYOND.into()).or_default() += 1;
                }
                (found, path) => self.wrong.push(format!("{found:?}, should be {path:?}: {truth:?} {scene:?}")),
            }
        }
    }

    /// Shapes, then tables.
    fn outcomes() -> &'static [Outcome; 2] {
        static OUTCOMES: OnceLock<[Outcome; 2]> = OnceLock::new();
        OUTCOMES.get_or_init(|| [outcome("stocks", RingScene::sample), outcome("tables", on_a_table)])
    }

    fn outcome(what: &str, make: fn(&mut Rng) -> RingScene) -> Outcome {
        let (seed, table) = (3, table());
        let (mut random, mut outcome) = (Rng::with_seed(seed), Outcome::default());
        for _ in 0..SCENES {
            let scene = make(&mut random);
            let edges = scene.edges();
            let truths: Vec<Truth> = edges.iter().map(|edge| EdgeAt::new(&scene, *edge).truth(&table)).collect();
            outcome.compare(&scene, &together(&truths));
        }
        println!("{SCENES} {what}, seed {seed}");
        for (name, class) in &mut outcome.classes {
            class.print(name);
        }
        println!("no demand: {:#?}", outcome.refused);
        println!("v taken for the chord costs at most {:.2} of what is allowed for it", outcome.of_allowance);
        outcome
    }

    fn on_a_table(random: &mut Rng) -> RingScene {
        let scene = RingScene::sample(random);
        let table = engaged_table(&sample_table(random, scene.length)).expect("ordinary knots");
        RingScene { stock: Stock::Engaged(table), ..scene }
    }

    fn first(complaints: &[String]) -> String {
        format!(
            "{} of {SCENES}:\n{}",
            complaints.len(),
            complaints.iter().take(4).cloned().collect::<Vec<_>>().join("\n")
        )
    }

    #[test]
    fn brute_force_finds_the_same_step_on_ten_thousand_stocks_and_as_many_tables() {
        for outcome in outcomes() {
            assert!(outcome.wrong.is_empty(), "{}", first(&outcome.wrong));
        }
    }

    #[test]
    fn a_refusal_says_whether_the_edge_recedes_or_the_chip_is_out_of_reach() {
        for outcome in outcomes() {
            assert!(outcome.wrong_reasons.is_empty(), "{}", first(&outcome.wrong_reasons));
        }
    }

    #[test]
    fn the_oracle_looks_as_far_as_the_law_goes_but_for_single_cases() {
        let beyond = |outcome: &Outcome| outcome.refused.get(BEYOND).copied().unwrap_or_default();
        let counts: Vec<u32> = outcomes().iter().map(beyond).collect();
        println!("{BEYOND}: {counts:?}");
        assert!(counts.iter().all(|count| *count <= 2), "{counts:?}");
    }

    /// The engaged arc of a half plane, degrees, from the circle's own geometry: where u.n <= distance / r0.
    fn engaged_by(scene: &RingScene, edge: Edge, ratio: f64, near_deg: f64) -> Point {
        let line = scene.stock.line().expect("a half plane");
        let frame = scene.frame(ratio);
        let inward = line.normal.map(|component| -component);
        let middle = libm::atan2(sign(edge) * dot(inward, frame.along), dot(inward, frame.towards)).to_degrees();
        let half = 180.0 - libm::acos(line.distance_mm(frame.position) / scene.radius(edge)).to_degrees();
        // The same way round as at the knot before.
        let middle = middle + 360.0 * libm::round((near_deg - middle) / 360.0);
        [middle - half, middle + half]
    }

    fn sampled(scene: &RingScene, knots: i32) -> Option<RingScene> {
        let mut near = 0.0;
        let knot = |i: i32| {
            let ratio = f64::from(i) / f64::from(knots - 1);
            let ends = [Edge::Outer, Edge::Inner].map(|edge| engaged_by(scene, edge, ratio, near));
            near = (ends[0][0] + ends[0][1]) / 2.0;
            (ratio * scene.length, ends)
        };
        let table = engaged_table(&(0..knots).map(knot).collect::<Vec<_>>())?;
        Some(RingScene { stock: Stock::Engaged(table), ..scene.clone() })
    }

    /// A half plane that one edge meets between 15 and 80 degrees all along an arc of up to a radian.
    fn smooth_scene(random: &mut Rng) -> Option<RingScene> {
        let mut scene = RingScene::sample(random);
        let edge = if random.bool() { Edge::Outer } else { Edge::Inner };
        (scene.policy, scene.length) = (EdgePolicy::Only(edge), scene.length.min(scene.path_radius));
        let law = scene.law();
        let is_smooth = |i: i32| {
            let demand = law.demand(&scene.place(f64::from(i) / 64.0));
            demand.is_ok_and(|demand| (15.0..80.0).contains(&demand.contact_rad().to_degrees()))
        };
        (scene.stock.line().is_some() && scene.path_radius.is_finite() && (0..=64).all(is_smooth)).then_some(scene)
    }

    /// Relative change of the half plane's answer when both ends of its engaged arc move by at most `by_rad`.
    fn leeway(scene: &RingScene, edge: Edge, ratio: f64, by_rad: [f64; 2]) -> f64 {
        let cut = Cut {
            path_radius: Mm(scene.path_radius as f32),
            edge_radius: Mm(scene.radius(edge) as f32),
            edge,
            feed_per_tooth: MmPerTooth(scene.chip as f32),
        };
        let path = |angle: f64| {
            let [towards, advance] = unit(angle);
            cut.path_per_tooth((sign(edge) * advance) as f32, towards as f32).map(|path| f64::from(path.0))
        };
        let ends = engaged_by(scene, edge, ratio, 0.0).map(f64::to_radians).into_iter().zip(by_rad);
        let change = |(end, by): (f64, f64)| {
            let moved = [end - by, end + by].map(path);
            match (path(end), moved) {
                (Ok(path), [Ok(less), Ok(more)]) => libm::fabs(less / path - 1.0).max(libm::fabs(more / path - 1.0)),
                // Neither here nor there it limits, or it comes and goes.
                (Err(_), [Err(_), Err(_)]) => 0.0,
                _ => f64::INFINITY,
            }
        };
        ends.map(change).fold(0.0, f64::max)
    }

    /// The largest second derivative of both ends over the path, rad/mm^2, from differences of the half plane's own geometry.
    fn bends(scene: &RingScene, edge: Edge) -> [f64; 2] {
        const PARTS: i32 = 400;
        let mut near = 0.0;
        let ends = (0..=PARTS).map(|i| {
            let ends = engaged_by(scene, edge, f64::from(i) / f64::from(PARTS), near);
            near = (ends[0] + ends[1]) / 2.0;
            ends.map(f64::to_radians)
        });
        let ends: Vec<Point> = ends.collect();
        let way = scene.length / f64::from(PARTS);
        let second = |end: usize| {
            let differences = ends.windows(3).map(|three| three[0][end] - 2.0 * three[1][end] + three[2][end]);
            differences.map(libm::fabs).fold(0.0, f64::max) / (way * way)
        };
        [second(0), second(1)]
    }

    /// Between knots h apart a straight line leaves a curve by no more than h^2/8 of its second derivative; what stays is the
    /// rounding of the angles.
    #[test]
    fn a_table_sampled_from_a_half_plane_converges_to_its_answer() {
        let mut random = Rng::with_seed(8);
        let (mut worst, mut of_leeway, mut scenes) = ([0.0_f64; 4], 0.0_f64, 0);
        let rounding = (0.5 / 90.0_f64).to_radians();
        while scenes < 300 {
            let Some(scene) = smooth_scene(&mut random) else { continue };
            let tables = [2, 4, 8, 16].map(|knots| sampled(&scene, knots));
            let [Some(two), Some(four), Some(eight), Some(sixteen)] = tables else { continue };
            let EdgePolicy::Only(edge) = scene.policy else { continue };
            scenes += 1;
            let bends = bends(&scene, edge);
            for (i, (table, ways)) in [(two, 1.0), (four, 3.0), (eight, 7.0), (sixteen, 15.0)].into_iter().enumerate() {
                let way = scene.length / ways;
                let by_rad = bends.map(|bend| 1.02 * bend * way * way / 8.0 + rounding);
                for ratio in (0..=97).map(|i| f64::from(i) / 97.0) {
                    let demand = |scene: &RingScene| {
                        scene.law().demand(&scene.place(ratio)).map(|demand| demand.path_mm_per_tooth)
                    };
                    let (Ok(exact), Ok(found)) = (demand(&scene), demand(&table)) else { continue };
                    let error = libm::fabs(f64::from(found) / f64::from(exact) - 1.0);
                    let leeway = leeway(&scene, edge, ratio, by_rad);
                    assert!(error <= leeway + 1e-6, "{error} at {ratio} by {ways} ways, at most {leeway}: {scene:?}");
                    worst[i] = worst[i].max(error);
                    of_leeway = of_leeway.max(error / leeway);
                }
            }
        }
        let [two, four, eight, sixteen] = worst;
        println!(
            "2, 4, 8, 16 knots: off by at most {two:.1e}, {four:.1e}, {eight:.1e}, {sixteen:.1e}; {of_leeway:.2} of the bound"
        );
        assert!(worst.windows(2).all(|pair| pair[1] < pair[0] / 2.0), "{worst:?}");
    }

    /// Greatest relative difference of the two laws over some of the arc's 1000 parts.
    fn differs(feeds: &[[f64; 2]]) -> f64 {
        feeds.iter().map(|[one, other]| libm::fabs(other / one - 1.0)).fold(0.0, f64::max)
    }

    #[test]
    fn on_published_rows_3_and_4_it_is_the_circumference_law_and_on_row_1_flat() {
        for (i, (row, end)) in ROWS.iter().zip(ENDS).enumerate() {
            let feeds: Vec<[f64; 2]> = (0..=1_000).map(|i| row.feeds(end, f64::from(i) / 1e3)).collect();
            let range = |i: usize| {
                let feeds = feeds.iter().map(|feeds| feeds[i]);
                (feeds.clone().fold(f64::INFINITY, f64::min), feeds.fold(0.0, f64::max))
            };
            let (one, other) = (range(0), range(1));
            println!("row {}: circumference {one:.2?}, engaged arc {other:.2?} in/min", i + 1);
            println!("    differ by {:.1e}", differs(&feeds));
            match i {
                0 => assert!(feeds.iter().all(|[_, engaged]| libm::fabs(engaged - 40.0) < 0.001)),
                1 => {}
                _ => assert!(differs(&feeds) < 1e-6),
            }
        }
    }

    /// The line of row 2 leaves the circle again at 93 degrees, beyond what the circumference law looks at; the material
    /// behind that is engaged, and nearer to v than the contact at 77 degrees.
    #[test]
    fn on_row_2_the_start_of_the_cut_is_protected() {
        let feeds: Vec<[f64; 2]> = (0..=1_000).map(|i| ROWS[1].feeds(ENDS[1], f64::from(i) / 1e3)).collect();
        let same = |[one, other]: &[f64; 2]| libm::fabs(other / one - 1.0) < 1e-6;
        let first = feeds.iter().position(same).expect("the laws meet");
        println!("row 2: they meet after {first} of 1000, before that they differ by {:.4}", differs(&feeds[..first]));
        assert!(differs(&feeds[first..]) < 1e-6);
        assert!(feeds[..first].iter().all(|[one, other]| other < one));
        // 1/sin 93.0 and 1/sin 77.3 degrees, times 40 in/min.
        assert!(libm::fabs(feeds[0][1] - 40.055) < 0.01 && libm::fabs(feeds[0][0] - 41.0) < 0.1);
    }
}
