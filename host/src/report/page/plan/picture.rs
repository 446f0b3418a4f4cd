//! Picture of the slot seen along the tool: blades, ring at the base position, and the path of its centre.

use std::fmt::Write;

use arcfeed_nc::modal::Turn;
use arcfeed_plan::path::{Purpose, SlotPath, Step};
use arcfeed_plan::vector::Flat;

use super::{Outline, PlanReport};
use crate::report::page::escaped;

const WIDTH: f64 = 700.0;
/// Margin around the content, as a fraction of it.
const MARGIN: f64 = 0.06;
/// Colours of the movements, from 1.
const COLORS: [&str; 4] = ["#c0392b", "#2471a3", "#1e8449", "#b9770e"];

/// Two pictures of a slot: all curves, and the path of the tool centre alone.
pub fn slot(report: &PlanReport) -> String {
    let PlanReport { path, mill, outlines, .. } = report;
    let radius_mm = mill.outer_radius_mm;
    let ring = [[-1.0, -1.0], [1.0, 1.0]].map(|[x, y]| [path.base.x + x * radius_mm, path.base.y + y * radius_mm]);
    let around = outlines.iter().flat_map(|outline| outline.points_mm.iter().copied()).chain(ring);
    let mut whole = Picture::of(around);
    for outline in outlines {
        whole.outline(outline);
    }
    for circle_mm in [mill.outer_radius_mm, mill.inner_radius_mm] {
        whole.circle(path.base, circle_mm);
    }
    whole.way(path);
    whole.mark("A", path.exterior);
    whole.mark("B1", path.interior);
    whole.mark("C", path.base);
    let ends = path.levels.iter().flat_map(|level| [level.exterior_end, level.interior_end]);
    let mut way = Picture::of(ends.chain([path.base]).map(|end| [end.x, end.y]));
    way.way(path);
    way.mark("C", path.base);
    let legend: String = COLORS.iter().enumerate().fold(String::new(), |mut legend, (index, color)| {
        let _ = write!(legend, "<span style=\"border-bottom:3px solid {color}\">movement {}</span> ", index + 1);
        legend
    });
    format!(
        "{}<p>Ring at the base position, blades, and the way of its centre. {legend}</p>\n{}<p>The centre's way, all levels.</p>\n",
        whole.end(),
        way.end()
    )
}

struct Picture {
    svg: String,
    low_mm: [f64; 2],
    high_mm: [f64; 2],
    scale: f64,
}

impl Picture {
    /// Picture large enough for these points.
    fn of(points_mm: impl Iterator<Item = [f64; 2]>) -> Self {
        let (mut low_mm, mut high_mm) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points_mm.filter(|[x, y]| x.is_finite() && y.is_finite()) {
            for axis in 0..2 {
                low_mm[axis] = low_mm[axis].min(point[axis]);
                high_mm[axis] = high_mm[axis].max(point[axis]);
            }
        }
        let size_mm = (high_mm[0] - low_mm[0]).max(high_mm[1] - low_mm[1]).max(1e-3);
        for axis in 0..2 {
            low_mm[axis] -= MARGIN * size_mm;
            high_mm[axis] += MARGIN * size_mm;
        }
        let scale = WIDTH / (high_mm[0] - low_mm[0]).max(high_mm[1] - low_mm[1]);
        let [width, height] = [0, 1].map(|axis| (high_mm[axis] - low_mm[axis]) * scale);
        let svg = format!(
            "<svg viewBox=\"0 0 {WIDTH} {height:.1}\" xmlns=\"http://www.w3.org/2000/svg\">\n\
             <rect width=\"{width:.1}\" height=\"{height:.1}\" fill=\"#fcfcfc\" stroke=\"#ccc\"/>\n"
        );
        Picture { svg, low_mm, high_mm, scale }
    }

    fn end(self) -> String {
        self.svg + "</svg>\n"
    }

    /// Position in the picture, with Y upwards.
    fn at(&self, x_mm: f64, y_mm: f64) -> [f64; 2] {
        [(x_mm - self.low_mm[0]) * self.scale, (self.high_mm[1] - y_mm) * self.scale]
    }

    fn outline(&mut self, outline: &Outline) {
        let points = outline.points_mm.iter().map(|[x, y]| {
            let [x, y] = self.at(*x, *y);
            format!("{x:.1},{y:.1}")
        });
        let points = points.collect::<Vec<_>>().join(" ");
        let _ = writeln!(
            self.svg,
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"#555\"><title>{}</title></polyline>",
            escaped(&outline.name)
        );
    }

    fn circle(&mut self, center: Flat, radius_mm: f64) {
        let [x, y] = self.at(center.x, center.y);
        let _ = writeln!(
            self.svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" fill=\"none\" stroke=\"#999\"/>",
            radius_mm * self.scale
        );
    }

    fn mark(&mut self, name: &str, place: Flat) {
        let [x, y] = self.at(place.x, place.y);
        let _ = writeln!(
            self.svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/><text x=\"{:.1}\" y=\"{:.1}\">{name}</text>",
            x + 6.0,
            y - 6.0
        );
    }

    fn way(&mut self, path: &SlotPath) {
        for step in path
            .steps()
            .iter()
            .filter(|step| !matches!(step.purpose, Purpose::Approach | Purpose::Entry | Purpose::Retract))
        {
            self.step(step);
        }
    }

    fn step(&mut self, step: &Step) {
        let [[from_x, from_y], [x, y]] = [step.from, step.to].map(|[x, y, _]| self.at(x, y));
        let color = step.purpose.movement().map_or("#000", |movement| COLORS[(movement - 1) % COLORS.len()]);
        let shape = match step.about {
            None => format!("L{x:.2} {y:.2}"),
            Some((center, turn)) => {
                let radius = libm::hypot(step.from[0] - center.x, step.from[1] - center.y) * self.scale;
                // On the screen y goes down: an arc with the flag goes clockwise.
                let clockwise = u8::from(turn == Turn::Cw);
                let large = u8::from(step.sweep_rad() > std::f64::consts::PI);
                format!("A{radius:.2} {radius:.2} 0 {large} {clockwise} {x:.2} {y:.2}")
            }
        };
        let _ = writeln!(self.svg, "<path d=\"M{from_x:.2} {from_y:.2}{shape}\" fill=\"none\" stroke=\"{color}\"/>");
    }
}
