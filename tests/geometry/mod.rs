//! Plane geometry in f64 for tests of laws: stock, a ring that moves past it, and the chip it takes.
//!
//! Nothing here knows a law: a chip is the distance by which a circle has moved on along a ray (see [`Motion::chip`]).

use arcfeed_firmware::law::Place;
use arcfeed_firmware::law::engaged_arc::{EdgePolicy, EngagedArc, Ring};
use arcfeed_firmware::law::region::Region;
use arcfeed_shared::stock::{Stock, StockLine};
use arcfeed_shared::tool::Edge;
use arcfeed_shared::units::{Mm, MmPerTooth};
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

/// How deep inside the stock a point lies; negative outside.
pub fn depth_mm(stock: &Stock, point: Point) -> f64 {
    match stock {
        Stock::Convex(lines) => {
            lines.iter().map(|line| line.offset_mm - dot(line.normal, point)).fold(f64::INFINITY, f64::min)
        }
        Stock::Disc { center_mm, radius_mm } => {
            radius_mm - libm::hypot(point[0] - center_mm[0], point[1] - center_mm[1])
        }
    }
}

/// How the tool's centre moves: x along v, y towards the rotation centre.
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
    /// Of the start as seen from the rotation centre; of the motion on a line.
    pub start_rad: f64,
    /// Length of the path.
    pub length: f64,
    pub outer: f64,
    /// Zero for a solid tool.
    pub inner: f64,
    pub chip: f64,
    pub policy: EdgePolicy,
    /// Whether all of it is seen in a mirror, x to -x.
    pub mirrored: bool,
}

/// The moving frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub position: Point,
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
        let protects = |edge: &Edge| self.policy == EdgePolicy::Protect || self.policy == EdgePolicy::Only(*edge);
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
        let [x, y] = self.heading(ratio);
        if self.is_line() {
            let position = moved(self.origin, ratio * self.length, [x, y]);
            return Frame { position, along: [x, y], towards: [-y, x] };
        }
        let along = [-self.turn * y, self.turn * x];
        Frame { position: moved(self.origin, self.path_radius, [x, y]), along, towards: [-x, -y] }
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
        };
        EngagedArc::new(ring, self.policy, Region::new(&stock, self.seen(self.origin)))
    }

    /// How deep the edge lies in the stock in a direction of the moving frame.
    pub fn depth_mm(&self, frame: &Frame, edge: Edge, u: Point) -> f64 {
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
            policy: [EdgePolicy::Protect, EdgePolicy::Only(Edge::Outer), EdgePolicy::Only(Edge::Inner)]
                [random.usize(..3)],
            mirrored: false,
        };
        let edge = if random.bool() { outer } else { inner };
        let touch = moved(scene.frame(0.5).position, edge, unit(between(random, 0.0, TAU)));
        scene.stock = stock_at(random, touch, edge);
        scene
    }
}

/// A stock whose boundary, or near it, goes through `touch`.
fn stock_at(random: &mut Rng, touch: Point, size: f64) -> Stock {
    let normal_rad = between(random, 0.0, TAU);
    let line = |angle: f64, point: Point| StockLine { normal: unit(angle), offset_mm: dot(unit(angle), point) };
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
