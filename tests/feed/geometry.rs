//! Plane geometry in f64 for tests of laws: stock, a ring that moves past it, and the chip it takes.
//!
//! Nothing here knows a law: a chip is the distance by which a circle has moved on along a ray (see [`Motion::chip`]).

use arcfeed_law::Place;
use arcfeed_law::engaged_arc::{EdgePolicy, EngagedArc, Ring};
use arcfeed_law::region::Region;
use arcfeed_model::engaged::{EngagedInterval, EngagedKnot, EngagedTable};
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::Edge;
use arcfeed_units::{Mm, MmPerTooth};
use core::f64::consts::{PI, TAU};
use fastrand::Rng;

pub type Point = [f64; 2];

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// `origin + length * direction`.
pub fn moved(origin: Point, length: f64, direction: Point) -> Point {
    [origin[0] + length * direction[0], origin[1] + length * direction[1]]
}

pub fn unit(angle_rad: f64) -> Point {
    let (sin, cos) = libm::sincos(angle_rad);
    [cos, sin]
}

pub fn between(random: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.f64()
}

pub fn log_between(random: &mut Rng, low: f64, high: f64) -> f64 {
    libm::exp(between(random, libm::log(low), libm::log(high)))
}

/// Depth of a point inside the stock; negative outside. A table has no shape.
fn depth_mm(stock: &Stock, point: Point) -> f64 {
    match stock {
        Stock::Convex(lines) => {
            lines.iter().map(|line| line.offset_mm - dot(line.normal, point)).fold(f64::INFINITY, f64::min)
        }
        Stock::Disc { center_mm, radius_mm } => {
            radius_mm - libm::hypot(point[0] - center_mm[0], point[1] - center_mm[1])
        }
        Stock::Engaged(_) | Stock::PerMove => f64::NAN,
    }
}

/// From and to of a circle's engaged arc after this path, degrees, as [`EngagedTable`] documents them: linear between
/// knots, level beyond.
pub fn engaged_deg(table: &EngagedTable, edge: Edge, travelled: f64) -> [f64; 2] {
    let path = |knot: &EngagedKnot| f64::from(knot.travelled.0);
    let ends = |knot: &EngagedKnot| (if edge == Edge::Outer { knot.outer } else { knot.inner }).degrees();
    let knots = table.knots();
    let last = knots.len() - 1;
    if travelled <= path(&knots[0]) || last == 0 {
        return ends(&knots[0]);
    }
    let pair = knots.windows(2).find(|pair| travelled < path(&pair[1]));
    let Some([before, behind]) = pair else { return ends(&knots[last]) };
    let ratio = (travelled - path(before)) / (path(behind) - path(before));
    let (low, high) = (ends(before), ends(behind));
    [0, 1].map(|i| low[i] + (high[i] - low[i]) * ratio)
}

/// Depth of a direction inside an engaged arc, radians; negative outside, and everywhere if the arc is empty.
fn depth_rad([from, to]: Point, direction_rad: f64) -> f64 {
    let [from, to] = [from, to].map(f64::to_radians);
    if from >= to {
        return -PI;
    }
    let turns = (-3..=3).map(|turn| direction_rad + TAU * f64::from(turn));
    turns.map(|angle| (angle - from).min(to - angle)).fold(f64::NEG_INFINITY, f64::max)
}

/// Frame of the moving tool centre: x along v, y towards the rotation centre.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Infinite on a line.
    pub path_radius: f64,
}

impl Motion {
    /// The way from O to O' after this path, in the moving frame.
    pub fn way(&self, path: f64) -> Point {
        if self.path_radius.is_infinite() {
            return [path, 0.0];
        }
        let half = libm::sin(path / self.path_radius / 2.0);
        [self.path_radius * libm::sin(path / self.path_radius), 2.0 * self.path_radius * half * half]
    }
}

/// By how much the circle (r0, k) has moved on along the ray from its old centre in direction u when its centre moved by
/// `way`; no chip where the ray misses it.
pub fn chip(k: f64, r0: f64, u: Point, way: Point) -> f64 {
    let across = u[0] * way[1] - u[1] * way[0];
    let square = (r0 - across) * (r0 + across);
    if square < 0.0 {
        return f64::NEG_INFINITY;
    }
    k * dot(u, way) - k * across * across / (r0 + libm::sqrt(square))
}

/// Quick upper bound of [`chip`], with room for rounding.
pub fn chip_at_most(k: f64, r0: f64, u: Point, way: Point) -> f64 {
    let (along, across) = (k * dot(u, way), u[0] * way[1] - u[1] * way[0]);
    let beside = if k > 0.0 { 0.0 } else { across * across / r0 };
    along + beside + 1e-12 * r0
}

/// A ring at a stock, in the program's coordinates, mm.
#[derive(Clone, Debug)]
pub struct RingScene {
    pub stock: Stock,
    /// The rotation centre, or the start of a line.
    pub origin: Point,
    /// Infinite for a line.
    pub path_radius: f64,
    /// +1 counter-clockwise, -1 clockwise.
    pub turn: f64,
    /// Direction of the start as seen from the rotation centre; on a line, direction of the motion.
    pub start_rad: f64,
    /// Length of the path.
    pub length: f64,
    pub outer: f64,
    /// Zero for a solid tool.
    pub inner: f64,
    pub chip: f64,
    pub policy: EdgePolicy,
    /// Whether the whole scene is mirrored, x to -x.
    pub mirrored: bool,
}

/// The moving frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub position: Point,
    /// Path from the start.
    pub travelled: f64,
    pub along: Point,
    pub towards: Point,
}

impl Frame {
    /// The direction u in the plane's axes from the one in the moving frame.
    pub fn direction(&self, [x, y]: Point) -> Point {
        moved([x * self.along[0], x * self.along[1]], y, self.towards)
    }
}

pub fn sign(edge: Edge) -> f64 {
    f64::from(edge.advance())
}

impl RingScene {
    pub fn motion(&self) -> Motion {
        Motion { path_radius: self.path_radius }
    }

    pub fn radius(&self, edge: Edge) -> f64 {
        if edge == Edge::Outer { self.outer } else { self.inner }
    }

    pub fn edges(&self) -> Vec<Edge> {
        let protects = |edge: &Edge| self.policy == EdgePolicy::Both || self.policy == EdgePolicy::Only(*edge);
        [Edge::Outer, Edge::Inner].into_iter().filter(|edge| self.radius(*edge) != 0.0).filter(protects).collect()
    }

    fn seen(&self, [x, y]: Point) -> Point {
        if self.mirrored { [-x, y] } else { [x, y] }
    }

    fn is_line(&self) -> bool {
        self.path_radius.is_infinite()
    }

    /// The direction from the rotation centre, or of the motion, before the mirror.
    fn heading(&self, ratio: f64) -> Point {
        let turned = if self.is_line() { 0.0 } else { self.turn * ratio * self.length / self.path_radius };
        unit(self.start_rad + turned)
    }

    /// The moving frame at this part of the path, before the mirror.
    pub fn frame(&self, ratio: f64) -> Frame {
        let ([x, y], travelled) = (self.heading(ratio), ratio * self.length);
        if self.is_line() {
            let position = moved(self.origin, ratio * self.length, [x, y]);
            return Frame { position, travelled, along: [x, y], towards: [-y, x] };
        }
        let along = [-self.turn * y, self.turn * x];
        Frame { position: moved(self.origin, self.path_radius, [x, y]), travelled, along, towards: [-x, -y] }
    }

    pub fn place(&self, ratio: f64) -> Place {
        let direction = self.seen(self.heading(ratio)).map(|x| x as f32);
        let travelled = (ratio * self.length) as f32;
        if self.is_line() {
            return Place::on_line(direction, travelled);
        }
        let turn = if self.mirrored { -self.turn } else { self.turn };
        Place::on_arc(direction, turn as f32, self.path_radius as f32, travelled)
    }

    pub fn law(&self) -> EngagedArc {
        let ring = Ring {
            outer_radius: Mm(self.outer as f32),
            inner_radius: Mm(self.inner as f32),
            path_radius: Mm(self.path_radius as f32),
            feed_per_tooth: MmPerTooth(self.chip as f32),
        };
        let stock = match &self.stock {
            Stock::Convex(lines) => {
                Stock::Convex(lines.iter().map(|line| StockLine { normal: self.seen(line.normal), ..*line }).collect())
            }
            Stock::Disc { center_mm, radius_mm } => {
                Stock::Disc { center_mm: self.seen(*center_mm), radius_mm: *radius_mm }
            }
            given => given.clone(),
        };
        let region = Region::new(&stock, self.seen(self.origin), 0.0).expect("a shape or a table");
        EngagedArc::new(ring, self.policy, region)
    }

    /// Depth of the edge in the stock in a direction of the moving frame.
    pub fn depth_mm(&self, frame: &Frame, edge: Edge, u: Point) -> f64 {
        if let Stock::Engaged(table) = &self.stock {
            let from_center = libm::atan2(sign(edge) * u[0], u[1]);
            return self.radius(edge) * depth_rad(engaged_deg(table, edge, frame.travelled), from_center);
        }
        depth_mm(&self.stock, moved(frame.position, self.radius(edge), frame.direction(u)))
    }
}

impl RingScene {
    /// Half planes, half planes with two ends, polygons and discs, most of them at the cutting circles.
    pub fn sample(random: &mut Rng) -> Self {
        let outer = log_between(random, 5.0, 300.0);
        let inner = outer * between(random, 0.5, 0.97);
        let is_line = random.u8(..5) == 0;
        let path_radius = if is_line { f64::INFINITY } else { outer * log_between(random, 0.05, 20.0) };
        let length = if is_line { between(random, 1.0, 200.0) } else { path_radius * between(random, 0.1, 3.0) };
        let mut scene = RingScene {
            stock: Stock::Disc { center_mm: [0.0; 2], radius_mm: 1.0 },
            origin: [0; 2].map(|_| between(random, -300.0, 300.0)),
            path_radius,
            turn: if random.bool() { 1.0 } else { -1.0 },
            start_rad: between(random, 0.0, TAU),
            length,
            outer,
            inner,
            chip: log_between(random, 1e-3, 1.0).min(0.1 * inner).min(0.5 * path_radius),
            policy: [EdgePolicy::Both, EdgePolicy::Only(Edge::Outer), EdgePolicy::Only(Edge::Inner)][random.usize(..3)],
            mirrored: false,
        };
        let edge = if random.bool() { outer } else { inner };
        let touch = moved(scene.frame(0.5).position, edge, unit(between(random, 0.0, TAU)));
        scene.stock = stock_at(random, touch, edge);
        scene
    }
}

/// Random knots on a path of this length, some before it and some behind; ends anywhere, a third of the arcs empty.
pub fn sample_table(random: &mut Rng, length: f64) -> Vec<(f64, [Point; 2])> {
    let mut paths: Vec<f64> = (0..random.usize(1..=16)).map(|_| length * between(random, -0.2, 1.2)).collect();
    paths.sort_by(f64::total_cmp);
    paths.dedup_by(|next, path| *next - *path < 0.01 * length);
    let mut ends = || {
        let from = between(random, -180.0, 180.0);
        [from, from + between(random, -90.0, 180.0)]
    };
    paths.into_iter().map(|path| (path, [ends(), ends()])).collect()
}

/// The table of these knots: path and ends of the outer and the inner circle's engaged arcs, degrees.
pub fn engaged_table(knots: &[(f64, [Point; 2])]) -> Option<EngagedTable> {
    let interval = |[from, to]: Point| EngagedInterval::from_degrees(from, to);
    let knot = |(path, [outer, inner]): &(f64, [Point; 2])| {
        let (travelled, outer, inner) = (Mm(*path as f32), interval(*outer)?, interval(*inner)?);
        Some(EngagedKnot { travelled, outer, inner })
    };
    EngagedTable::new(&knots.iter().map(knot).collect::<Option<Vec<_>>>()?).ok()
}

/// A stock whose boundary, or near it, goes through `touch`.
fn stock_at(random: &mut Rng, touch: Point, size: f64) -> Stock {
    let normal_rad = between(random, 0.0, TAU);
    let line = |angle: f64, point: Point| StockLine {
        normal: unit(angle),
        offset_mm: dot(unit(angle), point),
        rise_ratio: 0.0,
    };
    match random.u8(..4) {
        0 => Stock::Convex([line(normal_rad, touch)].into_iter().collect()),
        1 => {
            let [left, right] = [-1.0, 1.0].map(|side| {
                let end = moved(touch, side * size * log_between(random, 0.02, 2.0), unit(normal_rad + PI / 2.0));
                line(normal_rad + side * PI / 2.0, end)
            });
            Stock::Convex([line(normal_rad, touch), left, right].into_iter().collect())
        }
        2 => polygon(random, touch, size),
        _ => {
            let radius_mm = size * log_between(random, 0.05, 4.0);
            Stock::Disc { center_mm: moved(touch, radius_mm, unit(normal_rad)), radius_mm }
        }
    }
}

fn polygon(random: &mut Rng, touch: Point, size: f64) -> Stock {
    loop {
        let radius = size * log_between(random, 0.05, 3.0);
        let center = moved(touch, radius * random.f64(), unit(between(random, 0.0, TAU)));
        let mut angles: Vec<f64> = (0..random.usize(3..=8)).map(|_| between(random, 0.0, TAU)).collect();
        angles.sort_by(f64::total_cmp);
        let corners: Vec<Point> = angles.iter().map(|angle| moved(center, radius, unit(*angle))).collect();
        let clear = corners
            .windows(2)
            .all(|pair| libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]) > 0.01 * radius);
        if let (true, Some(stock)) = (clear, Stock::polygon(&corners)) {
            return stock;
        }
    }
}
