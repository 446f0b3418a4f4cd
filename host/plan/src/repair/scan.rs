//! Measured points as heights above the nominal surface.
//!
//! ```text
//! D = n.(P - S(u, v)) - r          (u, v) the nearest nominal point, r the stylus radius of ball centres      (1)
//! D(u, v) = a0 + a1 x + a2 y + a3 x2 + a4 xy + a5 y2,  x, y in mm from the place,
//!           over the 24 nearest points with the weights (1 - (d/d24)^3)^3, within their heights                (2)
//! ```
//!
//! At the foot of a weld the polynomial alone would run below the old surface. Fewer neighbours than 24 amplify the noise of a point. Places farther than a limit from every point are holes. The measured surface is S + D n; Feng et al. construct it as a B-spline through scan lines,
//! which scattered points do not have.

use nalgebra::{SMatrix, SVector};
use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::registration::NominalFoot;
use crate::geometry::surface::{Foot, Surface};
use crate::parallel;
use crate::vector::Point;

/// Seeds along both parameters.
const SEEDS: [usize; 2] = [33, 65];
/// Points farther from the tip are no weld on it.
const WELD_MAX_MM: f64 = 5.0;
/// Points of a fit (2).
const NEIGHBOURS: usize = 24;
/// Neighbours with which a point is compared.
const BESIDE: usize = 8;
/// Unknowns of a fit.
const UNKNOWNS: usize = 6;
/// Largest variance of a fit over that of a point.
const AMPLIFICATION_MAX: f64 = 2.0;
/// Farther than this many mean spacings from every point is a hole: at the border of an evenly random cloud two occur by chance.
const HOLE_SPACINGS: f64 = 3.0;

/// Nominal surface, prepared for finding the nearest point to a measured one.
pub struct NominalSurface<'s> {
    surface: Box<dyn Surface + 's>,
    seeds: RTree<GeomWithData<[f64; 3], [f64; 2]>>,
    /// Mean lengths of the lines of both parameters, mm.
    lengths_mm: [f64; 2],
    area_mm2: f64,
}

/// Height of a measured point above the nominal surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightSample {
    /// Parameters u and v of the nearest nominal point.
    pub at: [f64; 2],
    /// Height D of (1), positive outside.
    pub height_mm: f64,
}

/// Measured height above the nominal surface as a function of its parameters.
#[derive(Clone, Debug)]
pub struct HeightField {
    samples: RTree<GeomWithData<[f64; 2], f64>>,
    lengths_mm: [f64; 2],
    hole_mm: f64,
}

impl<'s> NominalSurface<'s> {
    /// Prepares a surface for finding nearest points.
    pub fn new(surface: impl Surface + 's) -> Self {
        let surface = Box::new(surface);
        let [us, vs] = surface.ranges();
        let place =
            |range: [f64; 2], k: usize, count: usize| range[0] + (range[1] - range[0]) * k as f64 / (count - 1) as f64;
        let rows: Vec<Vec<(Point, [f64; 2])>> = (0..SEEDS[0])
            .map(|i| {
                let at = |j: usize| [place(us, i, SEEDS[0]), place(vs, j, SEEDS[1])];
                (0..SEEDS[1]).map(|j| (surface.jet(at(j)).point, at(j))).collect()
            })
            .collect();
        let gauge_mm = surface.gauge_mm();
        let raised = |at: &(Point, [f64; 2])| match surface.is_over_edge() {
            true => at.0 + surface.point_and_normal(at.1).1 * gauge_mm,
            false => at.0,
        };
        let apart = |a: &(Point, [f64; 2]), b: &(Point, [f64; 2])| (raised(a) - raised(b)).norm();
        let across: f64 = rows.iter().flat_map(|row| row.windows(2)).map(|pair| apart(&pair[0], &pair[1])).sum();
        let along: f64 =
            rows.windows(2).flat_map(|pair| pair[0].iter().zip(&pair[1])).map(|(one, other)| apart(one, other)).sum();
        let lengths_mm = [along / SEEDS[1] as f64, across / SEEDS[0] as f64];
        let seeds = rows.into_iter().flatten().map(|(point, at)| GeomWithData::new(point.into(), at)).collect();
        let area_mm2 = lengths_mm[0] * lengths_mm[1];
        NominalSurface { surface, seeds: RTree::bulk_load(seeds), lengths_mm, area_mm2 }
    }

    /// The surface itself.
    pub fn surface(&self) -> &(dyn Surface + 's) {
        &*self.surface
    }

    /// Mean lengths of the lines of both parameters, mm.
    pub fn lengths_mm(&self) -> [f64; 2] {
        self.lengths_mm
    }

    fn seed(&self, point: &Point) -> [f64; 2] {
        self.seeds.nearest_neighbor([point.x, point.y, point.z]).map_or([0.5; 2], |found| found.data)
    }

    /// Nearest point of the surface, with its parameters.
    pub fn foot(&self, point: &Point) -> Foot {
        self.surface.foot(point, self.seed(point))
    }

    /// Height of a point above the end of the surface at the tip; `None` if its nearest point lies elsewhere, or farther than a weld is thick.
    pub fn beyond_tip_mm(&self, point: &Point) -> Option<f64> {
        let tip = self.surface.ranges()[0][1];
        let foot = (self.seed(point)[0] >= tip).then(|| self.foot(point))?;
        let is_over = foot.at[0] >= tip && foot.distance_mm < WELD_MAX_MM;
        is_over.then(|| self.surface.jet(foot.at).u.normalize().dot(&(point - foot.point)))
    }

    /// Nearest point of the surface, if it lies on an end of the second parameter between the ends of the first.
    pub fn edge_foot(&self, point: &Point) -> Option<Foot> {
        let [[root, tip], [first, last]] = self.surface.ranges();
        let beside = 2.0 * (last - first) / (SEEDS[1] - 1) as f64;
        let v = self.seed(point)[1];
        let foot = (v <= first + beside || v >= last - beside).then(|| self.foot(point))?;
        let [u, v] = foot.at;
        (u > root && u < tip && (v <= first || v >= last)).then_some(foot)
    }

    /// Nearest point of the surface and its normal.
    pub fn foot_and_normal(&self, point: &Point) -> (Foot, NominalFoot) {
        let foot = self.foot(point);
        (foot, NominalFoot { point: foot.point, normal: self.surface.point_and_normal(foot.at).1 })
    }

    /// Heights (1) of the points above the surface; those whose nearest point lies on its border belong to something else.
    pub fn heights(&self, points: &[Point], stylus_mm: f64) -> Vec<HeightSample> {
        let sample = |point: &Point| {
            let (foot, on) = self.foot_and_normal(point);
            let height_mm = on.normal.dot(&(point - on.point)) - stylus_mm; // (1)
            (!foot.is_on_border).then_some(HeightSample { at: foot.at, height_mm })
        };
        parallel::filter_map(points, &sample)
    }

    /// Three mean spacings of so many samples, mm: the farthest distance from a sample that is no hole, if nothing else is required.
    pub fn usual_hole_mm(&self, samples: usize) -> f64 {
        HOLE_SPACINGS * libm::sqrt(self.area_mm2 / samples.max(1) as f64)
    }

    /// Height field of samples; `hole_mm` is the farthest distance from a sample that is no hole.
    pub fn height_field(&self, samples: &[HeightSample], hole_mm: f64) -> HeightField {
        let place = |sample: &HeightSample| scaled(sample.at, self.lengths_mm);
        let samples = samples.iter().map(|sample| GeomWithData::new(place(sample), sample.height_mm)).collect();
        HeightField { samples: RTree::bulk_load(samples), lengths_mm: self.lengths_mm, hole_mm }
    }
}

fn scaled([u, v]: [f64; 2], [along_mm, across_mm]: [f64; 2]) -> [f64; 2] {
    [u * along_mm, v * across_mm]
}

impl HeightField {
    /// Farthest distance from a point that is no hole.
    pub fn hole_mm(&self) -> f64 {
        self.hole_mm
    }

    /// Whether a measured point lies within a distance of the parameters `at`, as far as the surface is measured at its gauge.
    pub fn is_measured(&self, at: [f64; 2], within_mm: f64) -> bool {
        let place = scaled(at, self.lengths_mm);
        self.samples
            .nearest_neighbor_iter_with_distance_2(place)
            .next()
            .is_some_and(|(_, square)| square <= within_mm * within_mm)
    }

    /// Distance, mm, of the height of one of the samples from the range of the heights of its nearest neighbours.
    pub fn apart_mm(&self, sample: &HeightSample) -> f64 {
        let near = self.samples.nearest_neighbor_iter(scaled(sample.at, self.lengths_mm)).skip(1).take(BESIDE);
        let (low, high) = near
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), other| (low.min(other.data), high.max(other.data)));
        (low - sample.height_mm).max(sample.height_mm - high)
    }

    /// Measured height, mm, at the parameters `at`; `None` in a hole of the measurement.
    pub fn height_mm(&self, at: [f64; 2]) -> Option<f64> {
        let place = scaled(at, self.lengths_mm);
        let mut near = self.samples.nearest_neighbor_iter_with_distance_2(place).take(NEIGHBOURS).peekable();
        if near.peek().is_none_or(|(_, square)| *square > self.hole_mm * self.hole_mm) {
            return None;
        }
        let near: Vec<([f64; 2], f64, f64)> = near.map(|(point, square)| (*point.geom(), point.data, square)).collect();
        if near.len() < NEIGHBOURS {
            return Some(near.iter().map(|(_, height, _)| height).sum::<f64>() / near.len() as f64);
        }
        fitted(place, &near)
    }
}

/// Value of (2) at its place, within the heights of the points, by the polynomial of highest degree that hardly amplifies the noise of a point: points in a row or on one side
/// of the place determine less.
fn fitted(place: [f64; 2], near: &[([f64; 2], f64, f64)]) -> Option<f64> {
    let reach_mm = near.last().map_or(0.0, |(_, _, square)| libm::sqrt(*square)).max(f64::MIN_POSITIVE) * 1.001;
    let row = |(point, _, square): &([f64; 2], f64, f64)| {
        let share = libm::sqrt(*square) / reach_mm;
        let rest = 1.0 - share * share * share;
        let [x, y] = [(point[0] - place[0]) / reach_mm, (point[1] - place[1]) / reach_mm];
        (SVector::from([1.0, x, y, x * x, x * y, y * y]), rest * rest * rest)
    };
    let rows: Vec<(SVector<f64, UNKNOWNS>, f64)> = near.iter().map(row).collect();
    let heights = near.iter().map(|(_, height_mm, _)| *height_mm);
    let (low, high) =
        heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| (low.min(height), high.max(height)));
    let found = value::<UNKNOWNS>(&rows, near).or_else(|| value::<3>(&rows, near)).or_else(|| value::<1>(&rows, near));
    found.map(|height_mm| height_mm.max(low).min(high))
}

/// Value at the place of the polynomial with the first `N` terms; `None` if it amplifies noise too much.
fn value<const N: usize>(rows: &[(SVector<f64, UNKNOWNS>, f64)], near: &[([f64; 2], f64, f64)]) -> Option<f64> {
    let mut matrix = SMatrix::<f64, N, N>::zeros();
    for (terms, weight) in rows {
        let terms = terms.fixed_rows::<N>(0);
        matrix += terms * terms.transpose() * *weight;
    }
    let mut first = SVector::<f64, N>::zeros();
    first[0] = 1.0;
    let solved = matrix.cholesky()?.solve(&first);
    let shares: Vec<f64> = rows.iter().map(|(terms, weight)| weight * terms.fixed_rows::<N>(0).dot(&solved)).collect();
    let amplification = shares.iter().map(|share| share * share).sum::<f64>();
    let value = shares.iter().zip(near).map(|(share, (_, height_mm, _))| share * height_mm).sum::<f64>();
    (amplification <= AMPLIFICATION_MAX).then_some(value)
}
