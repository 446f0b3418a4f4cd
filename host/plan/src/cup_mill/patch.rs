//! Surface near which the tool may come, prepared for a search: the least value of a function over its points.

use std::fmt;
use std::sync::Arc;

use nalgebra::Rotation3;

use crate::search::{FINEST, Minimum, Steps, descend_to};
use crate::vector::Point;

/// Number of best samples from which a search descends.
const STARTS: usize = 4;
/// Distance below which samples lead to the same place, in mean spacings.
const ONE_PLACE: f64 = 2.5;

type Surface = dyn Fn(f64, f64) -> Point + Send + Sync;

/// Surface over a rectangle of parameters (u, v), with samples at which a search for an extreme value begins.
pub struct Patch {
    point: Arc<Surface>,
    ranges: [[f64; 2]; 2],
    /// Steps between samples, along and across.
    steps: [usize; 2],
    samples: Vec<([f64; 2], Point)>,
    /// Largest distance between neighbouring samples, those across a corner included.
    mesh_mm: f64,
    /// A search ends at the best sample.
    is_coarse: bool,
}

impl fmt::Debug for Patch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Patch").field("ranges", &self.ranges).finish_non_exhaustive()
    }
}

impl Patch {
    /// Surface of the points `point(u, v)` over `ranges`, with samples at `steps` per direction.
    pub fn new(
        ranges: [[f64; 2]; 2],
        steps: [usize; 2],
        point: impl Fn(f64, f64) -> Point + Send + Sync + 'static,
    ) -> Self {
        let place = |axis: usize, index: usize| {
            let [low, high] = ranges[axis];
            let share = index as f64 / steps[axis] as f64;
            // Denser along the border, where blades are round.
            low + (high - low) * (1.0 - libm::cos(core::f64::consts::PI * share)) / 2.0
        };
        let places = (0..=steps[0]).flat_map(|i| (0..=steps[1]).map(move |j| [place(0, i), place(1, j)]));
        let samples: Vec<_> = places.map(|at| (at, point(at[0], at[1]))).collect();
        let mesh_mm = mesh_mm(&samples, steps);
        Patch { point: Arc::new(point), ranges, steps, samples, mesh_mm, is_coarse: false }
    }

    /// The same surface after a rotation about the origin.
    pub fn turned(&self, turn: &Rotation3<f64>) -> Self {
        let (point, turn) = (Arc::clone(&self.point), *turn);
        let samples = self.samples.iter().map(|(at, point)| (*at, turn * point)).collect();
        Patch { point: Arc::new(move |u, v| turn * point(u, v)), samples, ..*self }
    }

    /// The same surface with every `stride`th sample in both directions; its searches end at the best sample. For
    /// comparisons of many plans.
    pub fn coarse(&self, stride: usize) -> Self {
        let samples: Vec<_> = self.thinned_places(stride).copied().collect();
        let steps = self.steps.map(|steps| steps / stride);
        let mesh_mm = mesh_mm(&samples, steps);
        Patch { point: Arc::clone(&self.point), steps, samples, mesh_mm, is_coarse: true, ..*self }
    }

    /// Whether searches end at the best sample, instead of refining it.
    pub fn is_coarse(&self) -> bool {
        self.is_coarse
    }

    /// Largest distance between neighbouring samples, mm. Points between them are nearer than that to a sample, unless the surface bulges
    /// by as much as half of it.
    pub fn mesh_mm(&self) -> f64 {
        self.mesh_mm
    }

    /// Point at `(u, v)`.
    pub fn point(&self, u: f64, v: f64) -> Point {
        (self.point)(u, v)
    }

    /// Sample points on which a search begins.
    pub fn samples(&self) -> impl Iterator<Item = &Point> {
        self.samples.iter().map(|(_, point)| point)
    }

    /// Every `stride`th sample in both directions, with the border: for frequent queries that need no more.
    pub fn thinned(&self, stride: usize) -> impl Iterator<Item = &Point> {
        self.thinned_places(stride).map(|(_, point)| point)
    }

    fn thinned_places(&self, stride: usize) -> impl Iterator<Item = &([f64; 2], Point)> {
        let rows = self.samples.chunks(self.steps[1] + 1).step_by(stride);
        rows.flat_map(move |row| row.iter().step_by(stride))
    }

    /// Smallest value of a function over the points of the surface, and its place; points where it is infinite are ignored.
    pub fn least(&self, f: impl Fn(&Point) -> f64) -> Option<Minimum> {
        self.least_below(f64::INFINITY, f)
    }

    /// Smallest value of a function over the points, if one of the samples is below `limit`, otherwise `None`: fast for surfaces that
    /// rarely matter.
    pub fn least_below(&self, limit: f64, f: impl Fn(&Point) -> f64) -> Option<Minimum> {
        self.least_to(FINEST, limit, f)
    }

    /// The same by searches that end at steps of `finest` times the distance between samples.
    pub fn least_to(&self, finest: f64, limit: f64, f: impl Fn(&Point) -> f64) -> Option<Minimum> {
        let valued = self.samples.iter().map(|(at, point)| Minimum { at: *at, value: f(point) });
        if self.is_coarse {
            return valued.filter(|least| least.value < limit).min_by(|a, b| a.value.total_cmp(&b.value));
        }
        let mut candidates: Vec<Minimum> = valued.filter(|least| least.value < limit).collect();
        let spacing = [0, 1].map(|axis: usize| (self.ranges[axis][1] - self.ranges[axis][0]) / self.steps[axis] as f64);
        let is_near = |a: &Minimum, b: &Minimum| (0..2).all(|k| (a.at[k] - b.at[k]).abs() < ONE_PLACE * spacing[k]);
        let mut starts: Vec<Minimum> = Vec::with_capacity(STARTS);
        while starts.len() < STARTS {
            let Some(start) = candidates.iter().copied().min_by(|a, b| a.value.total_cmp(&b.value)) else { break };
            candidates.retain(|candidate| !is_near(&start, candidate));
            starts.push(start);
        }
        let by_place = |[u, v]: [f64; 2]| f(&self.point(u, v));
        let ends =
            starts.into_iter().map(|start| descend_to(self.ranges, start, Steps { first: spacing, finest }, by_place));
        ends.min_by(|a, b| a.value.total_cmp(&b.value))
    }
}

/// Largest distance between samples of one cell.
fn mesh_mm(samples: &[([f64; 2], Point)], steps: [usize; 2]) -> f64 {
    let rows: Vec<_> = samples.chunks(steps[1] + 1).collect();
    let cells = rows.windows(2).flat_map(|pair| pair[0].windows(2).zip(pair[1].windows(2)));
    let diagonals = cells.flat_map(|(low, high)| [high[1].1 - low[0].1, high[0].1 - low[1].1]);
    diagonals.map(|diagonal| diagonal.norm()).fold(0.0, f64::max)
}
