//! The yardstick of the method: dense samples of surfaces, ever finer grids about the best of them, and the ring as a solid.

use arcfeed_plan::cup_mill::side::edges;
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::vector::{Flat, Point, Vector};
use nalgebra::Rotation3;

use crate::twisted::{ALLOWANCE_MM, HUB_MM};

/// Samples each way.
const CELLS: [usize; 2] = [240, 100];

/// Distance of a point from the ring, mm, negative inside: straight walls over rounded corners, nothing above them.
pub fn gap_mm(cutter: &CupMill, centre: Flat, bottom_mm: f64, point: &Point) -> f64 {
    let rounding_mm = cutter.insert_radius_mm;
    let from_axis_mm = libm::hypot(point.x - centre.x, point.y - centre.y);
    let half_mm = (cutter.outer_radius_mm - cutter.inner_radius_mm) / 2.0 - rounding_mm;
    let middle_mm = (cutter.outer_radius_mm + cutter.inner_radius_mm) / 2.0;
    let aside_mm = (from_axis_mm - middle_mm).abs() - half_mm;
    let below_mm = rounding_mm - (point.z - bottom_mm);
    let outside_mm = libm::hypot(aside_mm.max(0.0), below_mm.max(0.0));
    outside_mm + aside_mm.max(below_mm).min(0.0) - rounding_mm
}

/// A surface, sampled.
pub struct Dense<'f> {
    surface: Box<dyn Fn(f64, f64) -> Point + 'f>,
    ranges: [[f64; 2]; 2],
    pub samples: Vec<([f64; 2], Point)>,
}

impl<'f> Dense<'f> {
    /// `surface` over `ranges`.
    pub fn new(ranges: [[f64; 2]; 2], surface: impl Fn(f64, f64) -> Point + 'f) -> Self {
        let at = |axis: usize, k: usize| {
            let [from, to] = ranges[axis];
            from + (to - from) * k as f64 / CELLS[axis] as f64
        };
        let places = (0..=CELLS[0]).flat_map(|i| (0..=CELLS[1]).map(move |j| [at(0, i), at(1, j)]));
        let samples = places.map(|place| (place, surface(place[0], place[1]))).collect();
        Dense { surface: Box::new(surface), ranges, samples }
    }

    /// A side with its allowance, turned: from where it begins to where it ends, with the round of the edge `far` (0 leading, 1 trailing),
    /// from its lowest foot on the hub to the tip and, straight, by the allowance above that.
    pub fn side(face: &'f Face, far: usize, turn: Rotation3<f64>) -> Self {
        let floor_mm = HUB_MM + ALLOWANCE_MM;
        let ends = edges(face);
        let foot = |k: i32| {
            let u = ends[0] + (ends[1] - ends[0]) * f64::from(k) / 8.0;
            let (mut below, mut above) = (0.0, 0.5);
            for _ in 0..50 {
                let middle = (below + above) / 2.0;
                let point = face.offset(u, middle, ALLOWANCE_MM);
                if libm::hypot(point.x, point.y) >= floor_mm { above = middle } else { below = middle }
            }
            above
        };
        let low = (0..=8).map(foot).fold(1.0, f64::min);
        let per_v_mm = face.jet(0.5, 1.0).v.norm();
        let mut along = ends;
        along[far] = far as f64;
        Dense::new([along, [low, 1.0 + ALLOWANCE_MM / per_v_mm]], move |u, v| {
            let point = face.offset(u, v, ALLOWANCE_MM);
            let above = if v > 1.0 { face.jet(u, 1.0).v * (v - 1.0) } else { Vector::zeros() };
            turn * (point + above)
        })
    }

    /// The least value over the samples.
    pub fn coarse(&self, f: impl Fn(&Point) -> f64) -> (f64, [f64; 2]) {
        let valued = self.samples.iter().map(|(at, point)| (f(point), *at));
        valued.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    }

    /// The same, and then over ever finer grids about the best one.
    pub fn least(&self, f: impl Fn(&Point) -> f64) -> (f64, [f64; 2]) {
        self.finer(self.coarse(&f), f)
    }

    /// From a place that is known to be near it: grids that become finer where they find nothing better.
    pub fn finer(&self, mut best: (f64, [f64; 2]), f: impl Fn(&Point) -> f64) -> (f64, [f64; 2]) {
        let cell = [0, 1].map(|axis| (self.ranges[axis][1] - self.ranges[axis][0]) / CELLS[axis] as f64);
        let mut share = 0.5;
        for _ in 0..400 {
            let (before, middle) = best;
            for [i, j] in (-2..=2).flat_map(|i| (-2..=2).map(move |j| [f64::from(i), f64::from(j)])) {
                let place = |offset: f64, axis: usize| {
                    (middle[axis] + offset * share * cell[axis]).clamp(self.ranges[axis][0], self.ranges[axis][1])
                };
                let at = [place(i, 0), place(j, 1)];
                let value = f(&(self.surface)(at[0], at[1]));
                if value < best.0 {
                    best = (value, at);
                }
            }
            share *= if best.0 < before { 1.2 } else { 0.4 };
            if share < 1e-6 {
                break;
            }
        }
        best
    }

    /// The point at a place.
    pub fn point(&self, [u, v]: [f64; 2]) -> Point {
        (self.surface)(u, v)
    }
}
