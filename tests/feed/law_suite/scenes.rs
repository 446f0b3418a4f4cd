//! Scenes of the laws that look at a stock.

use super::{Scene, View};
use crate::geometry::{
    Point, RingScene, between, chip, dot, engaged_table, log_between, moved, sample_table, sign, unit,
};
use arcfeed_law::circumference::Circumference;
use arcfeed_law::{FeedLaw, Place};
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::Edge;
use arcfeed_nc::modal::{Plane, Turn};
use arcfeed_nc::segment::Arc;
use arcfeed_units::{Mm, MmPerTooth, Nm};
use core::f64::consts::{PI, TAU};
use fastrand::Rng;

/// The engaged-arc law and its ring.
impl Scene for RingScene {
    fn seen(&self, view: &View) -> Self {
        let turned =
            |[x, y]: Point| moved([x * view.turned[0], x * view.turned[1]], y, [-view.turned[1], view.turned[0]]);
        let place = |point: Point| turned(point).map(|x| x * view.scale);
        let lengths = self.path_radius.min(self.length) + self.outer;
        let grown = view.grown * lengths;
        let stock = match &self.stock {
            Stock::Convex(lines) => {
                let line = |line: &StockLine| StockLine {
                    normal: turned(line.normal),
                    offset_mm: view.scale * (line.offset_mm + grown),
                    ..*line
                };
                Stock::Convex(lines.iter().map(line).collect())
            }
            Stock::Disc { center_mm, radius_mm } => {
                Stock::Disc { center_mm: place(*center_mm), radius_mm: view.scale * (radius_mm + grown) }
            }
            // [`EngagedTableScene`]'s.
            given => given.clone(),
        };
        RingScene {
            stock,
            origin: place(self.origin),
            path_radius: view.scale * self.path_radius,
            start_rad: self.start_rad + libm::atan2(view.turned[1], view.turned[0]),
            length: view.scale * self.length,
            outer: view.scale * self.outer,
            inner: view.scale * self.inner,
            chip: view.scale * view.chip * self.chip,
            mirrored: self.mirrored != view.mirrored,
            ..*self
        }
    }

    fn numbers(&mut self) -> Vec<&mut f64> {
        let mut numbers =
            vec![&mut self.path_radius, &mut self.outer, &mut self.inner, &mut self.chip, &mut self.length];
        numbers.extend(self.origin.iter_mut());
        match &mut self.stock {
            Stock::Convex(lines) => {
                for line in lines {
                    numbers.extend(line.normal.iter_mut());
                    numbers.push(&mut line.offset_mm);
                }
            }
            Stock::Disc { center_mm, radius_mm } => {
                numbers.extend(center_mm.iter_mut());
                numbers.push(radius_mm);
            }
            Stock::Engaged(_) | Stock::PerMove => {}
        }
        numbers
    }

    fn law(&self) -> Option<Box<dyn FeedLaw>> {
        Some(Box::new(RingScene::law(self)))
    }

    fn place(&self, ratio: f64) -> Place {
        RingScene::place(self, ratio)
    }

    /// For each edge: whether it cuts straight ahead, and how many ends of its engaged set advance and can reach the chip.
    fn contacts(&self, ratio: f64) -> Vec<usize> {
        let frame = self.frame(ratio);
        let mut contacts = Vec::new();
        for edge in self.edges() {
            let k = sign(edge);
            let depth = |angle: f64| self.depth_mm(&frame, edge, unit(angle));
            let angles: Vec<f64> = (0..=20_000).map(|i| TAU * f64::from(i) / 20_000.0).collect();
            let inside: Vec<bool> = angles.iter().map(|angle| depth(*angle) >= 0.0).collect();
            let ends = (1..angles.len()).filter(|i| inside[*i] != inside[i - 1]).map(|i| unit(angles[i]));
            let reaches = |u: &Point| {
                let thickest = |i: i32| {
                    let way = self.motion().way(self.chip * libm::pow(1.1, f64::from(i)));
                    if libm::hypot(way[0], way[1]) > self.radius(edge) {
                        f64::NEG_INFINITY
                    } else {
                        chip(k, self.radius(edge), *u, way)
                    }
                };
                k * u[0] > 0.0 && (0..120).any(|i| thickest(i) >= self.chip)
            };
            contacts.push(usize::from(depth(if k > 0.0 { 0.0 } else { PI }) >= 0.0));
            contacts.push(ends.filter(reaches).count());
        }
        contacts
    }
}

/// The engaged-arc law on a table.
#[derive(Clone, Debug)]
pub struct EngagedTableScene {
    ring: RingScene,
    knots: Vec<(f64, [Point; 2])>,
}

impl EngagedTableScene {
    pub fn sample(random: &mut Rng) -> Self {
        let ring = RingScene::sample(random);
        EngagedTableScene { knots: sample_table(random, ring.length), ring }
    }

    fn ring(&self) -> Option<RingScene> {
        Some(RingScene { stock: Stock::Engaged(engaged_table(&self.knots)?), ..self.ring.clone() })
    }
}

/// Angles in the moving frame are the same however the scene is turned, scaled or mirrored.
impl Scene for EngagedTableScene {
    /// A table does not grow, but it moves along the path.
    fn seen(&self, view: &View) -> Self {
        let shift = view.grown * self.ring.length;
        let knots = self.knots.iter().map(|(path, ends)| (view.scale * (path + shift), *ends)).collect();
        EngagedTableScene { ring: self.ring.seen(view), knots }
    }

    fn numbers(&mut self) -> Vec<&mut f64> {
        let knots = self.knots.iter_mut();
        let knots = knots.flat_map(|(path, ends)| core::iter::once(path).chain(ends.iter_mut().flatten()));
        self.ring.numbers().into_iter().chain(knots).collect()
    }

    fn law(&self) -> Option<Box<dyn FeedLaw>> {
        self.ring().map(|ring| Box::new(ring.law()) as Box<dyn FeedLaw>)
    }

    fn place(&self, ratio: f64) -> Place {
        self.ring.place(ratio)
    }

    fn contacts(&self, ratio: f64) -> Vec<usize> {
        self.ring().map_or_else(Vec::new, |ring| ring.contacts(ratio))
    }
}

/// The circumference law on an arc, its centre at the origin.
#[derive(Clone, Debug)]
pub struct CircumferenceScene {
    pub path_radius: f64,
    pub edge_radius: f64,
    pub edge: Edge,
    pub chip: f64,
    pub turn: f64,
    pub start_rad: f64,
    pub sweep_rad: f64,
    pub normal: Point,
    pub offset: f64,
    pub mirrored: bool,
}

impl CircumferenceScene {
    /// A line through a contact between 5 and 89 degrees in the middle of the arc, now and then anywhere.
    pub fn sample(random: &mut Rng) -> Self {
        let edge_radius = log_between(random, 20.0, 300.0);
        let mut scene = CircumferenceScene {
            path_radius: edge_radius * log_between(random, 0.3, 10.0),
            edge_radius,
            edge: if random.bool() { Edge::Outer } else { Edge::Inner },
            chip: log_between(random, 1e-3, 0.5),
            turn: if random.bool() { 1.0 } else { -1.0 },
            start_rad: between(random, 0.0, TAU),
            sweep_rad: between(random, 0.1, 1.0),
            normal: unit(between(random, 0.0, TAU)),
            offset: 0.0,
            mirrored: false,
        };
        let angle = if random.u8(..8) == 0 { between(random, 0.0, TAU) } else { between(random, 0.09, 1.55) };
        scene.offset = dot(scene.normal, scene.contact_point(0.5, angle));
        scene
    }

    fn heading(&self, ratio: f64) -> Point {
        unit(self.start_rad + self.turn * ratio * self.sweep_rad)
    }

    /// On the cutting circle, `angle` from the rotation centre towards the cutting side.
    pub fn contact_point(&self, ratio: f64, angle: f64) -> Point {
        let [x, y] = self.heading(ratio);
        let (sin, cos) = libm::sincos(angle);
        let along = sign(self.edge) * self.turn * self.edge_radius * sin;
        moved(moved([0.0; 2], self.path_radius - self.edge_radius * cos, [x, y]), along, [-y, x])
    }

    fn seen_in_mirror(&self, [x, y]: Point) -> Point {
        if self.mirrored { [-x, y] } else { [x, y] }
    }

    pub fn arc(&self) -> Arc {
        let turn = if (self.turn > 0.0) == self.mirrored { Turn::Cw } else { Turn::Ccw };
        let end = |ratio| self.seen_in_mirror(self.heading(ratio)).map(|x| Nm::from_mm(self.path_radius * x));
        Arc { plane: Plane::Xy, turn, center: [Nm(0); 2], from: end(0.0), to: end(1.0) }
    }

    pub fn stock(&self) -> StockLine {
        StockLine { normal: self.seen_in_mirror(self.normal), offset_mm: self.offset, rise_ratio: 0.0 }
    }
}

impl Scene for CircumferenceScene {
    fn seen(&self, view: &View) -> Self {
        let [x, y] = self.normal;
        CircumferenceScene {
            path_radius: view.scale * self.path_radius,
            edge_radius: view.scale * self.edge_radius,
            chip: view.scale * view.chip * self.chip,
            start_rad: self.start_rad + libm::atan2(view.turned[1], view.turned[0]),
            normal: moved([x * view.turned[0], x * view.turned[1]], y, [-view.turned[1], view.turned[0]]),
            offset: view.scale * (self.offset + view.grown * (self.path_radius + self.edge_radius)),
            mirrored: self.mirrored != view.mirrored,
            ..*self
        }
    }

    fn numbers(&mut self) -> Vec<&mut f64> {
        let [x, y] = &mut self.normal;
        vec![&mut self.path_radius, &mut self.edge_radius, &mut self.chip, &mut self.offset, x, y]
    }

    fn law(&self) -> Option<Box<dyn FeedLaw>> {
        let (radius, chip) = (Mm(self.edge_radius as f32), MmPerTooth(self.chip as f32));
        Some(Box::new(Circumference::for_arc(&self.arc(), radius, self.edge, &self.stock(), chip)))
    }

    fn place(&self, ratio: f64) -> Place {
        let direction = self.seen_in_mirror(self.heading(ratio)).map(|x| x as f32);
        let turn = f32::from(self.arc().turn.sign());
        Place::on_arc(direction, turn, self.path_radius as f32, (ratio * self.sweep_rad * self.path_radius) as f32)
    }

    /// Whether each of the two intersections is admissible: its edge advances, on A's side of O.
    fn contacts(&self, ratio: f64) -> Vec<usize> {
        let [x, y] = self.heading(ratio);
        let k = sign(self.edge) * self.turn;
        let distance = (self.offset - self.path_radius * dot(self.normal, [x, y])) / self.edge_radius;
        let half = libm::sqrt((1.0 - distance * distance).max(0.0));
        let u = |side: f64| {
            moved(
                [distance * self.normal[0], distance * self.normal[1]],
                side * half,
                [-self.normal[1], self.normal[0]],
            )
        };
        let admissible = |u: Point| dot(u, [x, y]) <= 0.0 && k * dot(u, [-y, x]) > 0.0 && half > 0.0;
        [-1.0, 1.0].map(|side| usize::from(admissible(u(side)))).to_vec()
    }
}
