//! A surface the tool may come up to, ready to be searched: the least value of a function over its points.

use std::fmt;
use std::sync::Arc;

use nalgebra::Rotation3;

use crate::search::{Least, descend};
use crate::vector::Point;

/// Best samples from which a search descends.
const STARTS: usize = 4;
/// Samples nearer than this, in their mean spacing, lead to one place.
const ONE_PLACE: f64 = 2.5;

type Surface = dyn Fn(f64, f64) -> Point + Send + Sync;

/// A surface over a rectangle of parameters.
pub struct Patch {
    point: Arc<Surface>,
    ranges: [[f64; 2]; 2],
    /// Steps between samples, along and across.
    steps: [usize; 2],
    samples: Vec<([f64; 2], Point)>,
}

impl fmt::Debug for Patch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Patch").field("ranges", &self.ranges).finish_non_exhaustive()
    }
}

impl Patch {
    /// `point` over `ranges`, searched on samples so many steps apart.
    pub fn new(
        ranges: [[f64; 2]; 2],
        steps: [usize; 2],
        point: impl Fn(f64, f64) -> Point + Send + Sync + 'static,
    ) -> Self {
        let place = |axis: usize, index: usize| {
            let [low, high] = ranges[axis];
            let share = index as f64 / steps[axis] as f64;
            // Closer along the border, where blades are round.
            low + (high - low) * (1.0 - libm::cos(core::f64::consts::PI * share)) / 2.0
        };
        let places = (0..=steps[0]).flat_map(|i| (0..=steps[1]).map(move |j| [place(0, i), place(1, j)]));
        let samples = places.map(|at| (at, point(at[0], at[1]))).collect();
        Patch { point: Arc::new(point), ranges, steps, samples }
    }

    /// The same surface turned about the origin.
    pub fn turned(&self, turn: &Rotation3<f64>) -> Self {
        let (point, turn) = (Arc::clone(&self.point), *turn);
        let samples = self.samples.iter().map(|(at, point)| (*at, turn * point)).collect();
        Patch { point: Arc::new(move |u, v| turn * point(u, v)), samples, ..*self }
    }

    /// The point at `(u, v)`.
    pub fn point(&self, u: f64, v: f64) -> Point {
        (self.point)(u, v)
    }

    /// The points on which it is searched.
    pub fn samples(&self) -> impl Iterator<Item = &Point> {
        self.samples.iter().map(|(_, point)| point)
    }

    /// Every `stride`th of them each way, with the border: for what is asked often and needs no more.
    pub fn thinned(&self, stride: usize) -> impl Iterator<Item = &Point> {
        let row = self.steps[1] + 1;
        let is_kept = move |index: usize| (index / row).is_multiple_of(stride) && (index % row).is_multiple_of(stride);
        self.samples.iter().enumerate().filter(move |(index, _)| is_kept(*index)).map(|(_, (_, point))| point)
    }

    /// Where a function of the points is least. Places where it is infinite do not count.
    pub fn least(&self, f: impl Fn(&Point) -> f64) -> Option<Least> {
        let valued = self.samples.iter().map(|(at, point)| Least { at: *at, value: f(point) });
        let mut candidates: Vec<Least> = valued.filter(|least| least.value.is_finite()).collect();
        let spacing = [0, 1].map(|axis: usize| (self.ranges[axis][1] - self.ranges[axis][0]) / self.steps[axis] as f64);
        let is_near = |a: &Least, b: &Least| (0..2).all(|k| (a.at[k] - b.at[k]).abs() < ONE_PLACE * spacing[k]);
        let mut starts: Vec<Least> = Vec::with_capacity(STARTS);
        while starts.len() < STARTS {
            let Some(start) = candidates.iter().copied().min_by(|a, b| a.value.total_cmp(&b.value)) else { break };
            candidates.retain(|candidate| !is_near(&start, candidate));
            starts.push(start);
        }
        let ends = starts.into_iter().map(|start| descend(self.ranges, start, spacing, |[u, v]| f(&self.point(u, v))));
        ends.min_by(|a, b| a.value.total_cmp(&b.value))
    }
}
