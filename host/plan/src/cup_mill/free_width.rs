//! Free width of a ring in a slot over its whole depth, for one direction of the tool.
//!
//! ```text
//! free_width(C) = min( min |p - C| - R,  r - max |s - C| )                          (1)
//! ```
//!
//! over the points p of the pressure and s of the suction side, seen along the tool; the free width of a direction is the
//! largest value of (1) over all centres. A ring wider by twice the free width has none left; a negative free width is the missing
//! width.
//!
//! The published axis lies along one blade. The other blade leans over it by the pitch, less its twist: with 19 blades
//! 1 mm in 3 of depth. [`SidePoints::roomiest`] is the direction with the most free width, [`SidePoints::nearest`] one with enough free width
//! on the way there.

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};

use crate::cutter::CupMill;
use crate::frame::slot_frame;
use crate::search::{FINEST, Minimum, Steps, descend_by, descend_parallel};
use crate::vector::{Flat, Point, Vector};

use super::side::OffsetSide;

/// Free width of a ring in a slot, on each of its sides, for one direction of the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeWidth {
    /// Width by which the ring could be wider on each side, mm; negative: the width that is missing. Value of (1) at the best centre.
    pub per_side_mm: f64,
    /// Centre of the ring with the most free width, slot frame.
    pub centre: Flat,
    /// Direction of the tool's axis, in the rotor's own frame.
    pub direction: Vector,
}

/// Free width of a ring for many directions of the tool.
#[derive(Clone, Debug)]
pub struct FreeWidths {
    /// Free widths for the directions of a grid.
    pub grid: Vec<FreeWidth>,
    /// Free width of the direction that has the most.
    pub roomiest: FreeWidth,
}

/// Sample points of both sides of a slot, in the rotor's own frame.
pub struct SidePoints {
    pressure: Vec<Point>,
    suction: Vec<Point>,
}

/// Stride through the samples of a side in both directions: a divisor of both numbers of steps.
const STRIDE: usize = 4;
/// Largest angle of the searched directions from the slot's middle, rad.
pub const LEAN_MAX_RAD: f64 = 0.5;
/// Steps of the coarse grid, to each side.
const LEANS: i32 = 6;
/// Step of the grid of directions, rad.
pub const LEAN_STEP_RAD: f64 = LEAN_MAX_RAD / LEANS as f64;
/// Centres of the coarse grid, about the slot, degrees.
const BEARINGS_DEG: [f64; 25] = {
    let mut bearings = [0.0; 25];
    let mut k = 0;
    while k < 25 {
        bearings[k] = (k as f64 - 12.0) * 5.0;
        k += 1;
    }
    bearings
};

impl SidePoints {
    /// Samples of the sides, which are given in the part frame.
    pub fn new(pressure: &OffsetSide, suction: &OffsetSide) -> Self {
        let points = |side: &OffsetSide| side.patch.thinned(STRIDE).copied().collect();
        SidePoints { pressure: points(pressure), suction: points(suction) }
    }

    /// Free space along a direction; `None` along the rotor's axis.
    pub fn free_width(&self, cutter: &CupMill, direction: &Vector) -> Option<FreeWidth> {
        let turn = slot_frame(direction)?;
        let seen = |points: &[Point]| -> Vec<Flat> { points.iter().map(|point| (turn * point).xy()).collect() };
        let (pressure, suction) = (seen(&self.pressure), seen(&self.suction));
        let (from, to) = (middle(&pressure), middle(&suction));
        let bearing = libm::atan2(to.y - from.y, to.x - from.x);
        let between = nalgebra::center(&from, &to);
        let radius_mm = (cutter.outer_radius_mm + cutter.inner_radius_mm) / 2.0;
        let mut missing = MissingWidth::new(cutter, [pressure, suction]);
        let starts = BEARINGS_DEG.map(|deg| {
            let (sin, cos) = libm::sincos(bearing + deg.to_radians());
            let at = [between.x + radius_mm * cos, between.y + radius_mm * sin];
            Minimum { at, value: missing.value(at) }
        });
        let start = starts.into_iter().min_by(|a, b| a.value.total_cmp(&b.value))?;
        let everywhere = [[f64::MIN, f64::MAX]; 2];
        let steps = Steps { first: [2.0, 2.0], finest: FINEST };
        let found = descend_by(everywhere, start, steps, |best, reach_mm, places| {
            missing.approach(best.at, reach_mm);
            places.iter_mut().for_each(|place| place.value = missing.value(place.at));
        });
        Some(FreeWidth { per_side_mm: -found.value, centre: Flat::from(found.at), direction: *direction })
    }

    /// First direction on the way from `from` to `to` with at least `enough_mm` of free space; `to` if there is none
    /// before.
    pub fn nearest(&self, cutter: &CupMill, from: &FreeWidth, to: &FreeWidth, enough_mm: f64) -> FreeWidth {
        if from.per_side_mm >= enough_mm {
            return *from;
        }
        let at =
            |share: f64| self.free_width(cutter, &(from.direction * (1.0 - share) + to.direction * share).normalize());
        let (mut short, mut best, mut best_share) = (0.0, *to, 1.0);
        for _ in 0..HALVINGS {
            let middle = (short + best_share) / 2.0;
            match at(middle).filter(|width| width.per_side_mm >= enough_mm) {
                Some(width) => (best, best_share) = (width, middle),
                None => short = middle,
            }
        }
        best
    }

    /// Direction with the most free space, and that space.
    pub fn roomiest(&self, cutter: &CupMill) -> Option<FreeWidth> {
        self.free_widths(cutter).map(|found| found.roomiest)
    }

    /// Free space for a grid of directions, and the largest one, which a local search from the best of them finds.
    pub fn free_widths(&self, cutter: &CupMill) -> Option<FreeWidths> {
        let about = DirectionGrid::new(self)?;
        let free_width = |at: [f64; 2]| self.free_width(cutter, &about.direction(at));
        let missing = |width: Option<FreeWidth>| width.map_or(f64::INFINITY, |width| -width.per_side_mm);
        let places: Vec<[f64; 2]> = leans().collect();
        let grid: Vec<Option<FreeWidth>> = places.par_iter().map(|at| free_width(*at)).collect();
        let starts = places.into_iter().zip(&grid).map(|(at, free_width)| Minimum { at, value: missing(*free_width) });
        let start = starts.min_by(|a, b| a.value.total_cmp(&b.value))?;
        let range = [-LEAN_MAX_RAD, LEAN_MAX_RAD];
        let found = descend_parallel([range, range], start, [LEAN_STEP_RAD / 2.0; 2], |at| missing(free_width(at)));
        Some(FreeWidths { grid: grid.into_iter().flatten().collect(), roomiest: free_width(found.at)? })
    }
}

/// Width that a ring lacks on each side, by its centre: (1), negative.
struct MissingWidth<'c> {
    cutter: &'c CupMill,
    /// All points of the pressure and of the suction side, seen along the tool.
    sides: [Vec<Flat>; 2],
    near: NearPoints,
}

/// The points that can be the nearest or the farthest of their side, of any centre within a reach.
struct NearPoints {
    centre: Flat,
    reach_mm: f64,
    sides: [Vec<Flat>; 2],
    lanes: [Lanes; 2],
}

/// Reach that points are selected for, over that of a step: the steps grow, too.
const AHEAD: f64 = 2.0;
/// Part of the reach of the points below which fewer points are selected.
const SMALL: f64 = 0.125;
/// More than the rounding errors of distances, mm.
const ROUNDING_MM: f64 = 1e-9;

impl<'c> MissingWidth<'c> {
    fn new(cutter: &'c CupMill, sides: [Vec<Flat>; 2]) -> Self {
        let near = NearPoints::new(Flat::origin(), f64::INFINITY, sides.clone());
        MissingWidth { cutter, sides, near }
    }

    /// Prepares for values within `reach_mm` of `centre`.
    fn approach(&mut self, centre: [f64; 2], reach_mm: f64) {
        let centre = Flat::from(centre);
        let is_inside = (centre - self.near.centre).norm() + reach_mm <= self.near.reach_mm;
        if !is_inside || reach_mm < SMALL * self.near.reach_mm {
            let from = if is_inside { &self.near.sides } else { &self.sides };
            self.near = NearPoints::of(from, centre, AHEAD * reach_mm);
        }
    }

    /// Missing width at a centre that has been approached.
    fn value(&self, [x, y]: [f64; 2]) -> f64 {
        let centre = Flat::new(x, y);
        debug_assert!((centre - self.near.centre).norm() <= self.near.reach_mm, "points left out may matter there");
        let [pressure, suction] = &self.near.lanes;
        let outer = libm::sqrt(pressure.nearest_mm2(centre)) - self.cutter.outer_radius_mm;
        let inner = self.cutter.inner_radius_mm - libm::sqrt(suction.farthest_mm2(centre));
        -outer.min(inner) // (1)
    }
}

impl NearPoints {
    fn new(centre: Flat, reach_mm: f64, sides: [Vec<Flat>; 2]) -> Self {
        let lanes = [0, 1].map(|side: usize| Lanes::new(&sides[side]));
        NearPoints { centre, reach_mm, sides, lanes }
    }

    /// Points of the pressure side up to twice the reach farther from the centre than the nearest one, and of the suction side up to twice the
    /// reach nearer than the farthest one. Seen from another centre, each distance differs by the reach at most.
    fn of([pressure, suction]: &[Vec<Flat>; 2], centre: Flat, reach_mm: f64) -> Self {
        let spread_mm = 2.0 * reach_mm + ROUNDING_MM;
        let square_mm2 = |point: &Flat| (point - centre).norm_squared();
        let nearest_mm2 = pressure.iter().map(square_mm2).fold(f64::INFINITY, f64::min);
        let farthest_mm2 = suction.iter().map(square_mm2).fold(0.0, f64::max);
        let most_mm = libm::sqrt(nearest_mm2) + spread_mm;
        let least_mm = (libm::sqrt(farthest_mm2) - spread_mm).max(0.0);
        let pressure = pressure.iter().filter(|point| square_mm2(point) <= most_mm * most_mm).copied().collect();
        let suction = suction.iter().filter(|point| square_mm2(point) >= least_mm * least_mm).copied().collect();
        NearPoints::new(centre, reach_mm, [pressure, suction])
    }
}

/// Number of points that are compared at once.
const LANES: usize = 8;

/// Coordinates of points, arranged for vector instructions.
struct Lanes(Vec<[[f64; LANES]; 2]>);

impl Lanes {
    fn new(points: &[Flat]) -> Self {
        // The last lanes are filled with copies of points.
        let block = |points: &[Flat]| [0, 1].map(|axis| std::array::from_fn(|k| points[k.min(points.len() - 1)][axis]));
        Lanes(points.chunks(LANES).map(block).collect())
    }

    /// Least squared distance from `centre`.
    fn nearest_mm2(&self, centre: Flat) -> f64 {
        self.extreme_mm2(centre, f64::INFINITY, |a, b| if a < b { a } else { b })
    }

    /// Greatest squared distance from `centre`.
    fn farthest_mm2(&self, centre: Flat) -> f64 {
        self.extreme_mm2(centre, 0.0, |a, b| if a > b { a } else { b })
    }

    fn extreme_mm2(&self, centre: Flat, start: f64, better: impl Fn(f64, f64) -> f64) -> f64 {
        let mut found = [start; LANES];
        for [xs, ys] in &self.0 {
            for lane in 0..LANES {
                let (x, y) = (xs[lane] - centre.x, ys[lane] - centre.y);
                found[lane] = better(x * x + y * y, found[lane]);
            }
        }
        found.into_iter().fold(start, better)
    }
}

/// Halvings of the interval between two directions.
const HALVINGS: i32 = 20;

/// Directions about the slot's middle, by their lean along the circumference and their tilt along the rotor's axis.
pub struct DirectionGrid {
    middle: Vector,
    aside: Vector,
}

impl DirectionGrid {
    /// Directions about the middle of a slot.
    pub fn new(walls: &SidePoints) -> Option<Self> {
        let mean = walls.pressure.iter().chain(&walls.suction).map(|point| point.coords).sum::<Vector>();
        let middle = Vector::new(mean.x, mean.y, 0.0).try_normalize(1e-9)?;
        Some(DirectionGrid { middle, aside: Vector::z().cross(&middle) })
    }

    /// Direction at a place of the grid.
    pub fn direction(&self, [lean, tilt]: [f64; 2]) -> Vector {
        (self.middle + self.aside * lean + Vector::z() * tilt).normalize()
    }
}

/// Leans and tilts of the coarse grid.
pub fn leans() -> impl Iterator<Item = [f64; 2]> {
    let step = |index: i32| f64::from(index) * LEAN_STEP_RAD;
    (-LEANS..=LEANS).flat_map(move |i| (-LEANS..=LEANS).map(move |j| [step(i), step(j)]))
}

fn middle(places: &[Flat]) -> Flat {
    let sum = places.iter().map(|place| place.coords).sum::<nalgebra::Vector2<f64>>();
    Flat::from(sum / places.len() as f64)
}
