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
//!
//! A ring that leans along its slot hardly gains or loses room: over 30 degrees some rotors have the same free width to a micrometre. So the roomiest
//! direction d is that with the most of
//!
//! ```text
//! free_width(d) - 0.003 mm |d - b|                                           (2)
//! ```
//!
//! with b the blade's axis; d and b are leans across the slot and tilts along it ([`DirectionGrid`]).

use nalgebra::Vector2;

use crate::cutter::CupMill;
use crate::frame::slot_frame;
use crate::parallel;
use crate::search::{Minimum, Steps, descend_to};
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
/// Free width that a direction must gain for each radian from the blade's axis. Over all directions that is less than a proof loses to its triangles.
const LEAN_MM_PER_RAD: f64 = 0.003;
/// Bearings of the coarse grid, to each side of that of a ring square to the slot.
const BEARINGS: i32 = 12;
/// Step of these bearings, degrees.
const BEARING_STEP_DEG: f64 = 5.0;

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
        let square_rad = libm::atan2(to.y - from.y, to.x - from.x);
        let slot = Slot {
            cutter,
            middle: nalgebra::center(&from, &to),
            sides: [pressure, suction].map(|points| Lanes::new(&points)),
        };
        let radius_mm = (cutter.outer_radius_mm + cutter.inner_radius_mm) / 2.0;
        let bearings = (-BEARINGS..=BEARINGS).map(|index| (f64::from(index) * BEARING_STEP_DEG).to_radians());
        let rings = bearings.map(|turn_rad| slot.balanced(square_rad + turn_rad, radius_mm));
        let start = rings.min_by(|a, b| a.missing_mm.total_cmp(&b.missing_mm))?;
        let best = Minimum { at: [start.bearing_rad, 0.0], value: start.missing_mm };
        let steps = Steps { first: [BEARING_STEP_DEG.to_radians(), 0.0], finest: FINEST_BEARING };
        let found = descend_to([[f64::MIN, f64::MAX], [0.0; 2]], best, steps, |[bearing_rad, _]| {
            slot.balanced(bearing_rad, start.distance_mm).missing_mm
        });
        let ring = slot.balanced(found.at[0], start.distance_mm);
        Some(FreeWidth { per_side_mm: -ring.missing_mm, centre: ring.centre, direction: *direction })
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

    /// Direction with the most free width, after (2), and that width; `blade` is the direction of the blade's axis. At each tilt along the slot the
    /// best lean across it is searched, as from tilt to tilt the free width changes little and from lean to lean much.
    pub fn roomiest(&self, cutter: &CupMill, blade: &Vector) -> Option<FreeWidth> {
        let grid = DirectionGrid::of_slot(self)?;
        let blade = grid.place(blade);
        let valued = |at: [f64; 2]| {
            let width_mm =
                self.free_width(cutter, &grid.direction(at)).map_or(f64::NEG_INFINITY, |width| width.per_side_mm);
            let lean_rad = libm::hypot(at[0] - blade[0], at[1] - blade[1]);
            Minimum { at, value: LEAN_MM_PER_RAD * lean_rad - width_mm } // (2)
        };
        let range = [-LEAN_MAX_RAD, LEAN_MAX_RAD];
        let steps = Steps { first: [LEAN_STEP_RAD / 2.0, 0.0], finest: FINEST_LEAN };
        let best_lean = |start: Minimum| descend_to([range, [start.at[1]; 2]], start, steps, |at| valued(at).value);
        let tilts: Vec<f64> = grid_leans().collect();
        let row = |tilt: &f64| least(grid_leans().map(|lean| valued([lean, *tilt]))).map(best_lean);
        let row = least(parallel::filter_map(&tilts, &row))?;
        let at_tilt = |tilt: f64| best_lean(valued([row.at[0], tilt]));
        let start = Minimum { at: [row.at[1], 0.0], ..row };
        let found = descend_to([range, [0.0; 2]], start, steps, |[tilt, _]| at_tilt(tilt).value);
        self.free_width(cutter, &grid.direction(at_tilt(found.at[0]).at))
    }
}

/// The best of some places.
fn least(places: impl IntoIterator<Item = Minimum>) -> Option<Minimum> {
    places.into_iter().min_by(|a, b| a.value.total_cmp(&b.value))
}

/// Both sides of a slot, seen along the tool, for a ring between them.
struct Slot<'c> {
    cutter: &'c CupMill,
    middle: Flat,
    /// Points of the pressure and of the suction side.
    sides: [Lanes; 2],
}

/// Ring with the same room on both sides, of all whose centre lies in one bearing from the slot's middle: the farther it is, the farther the ring is
/// from the pressure and the nearer to the suction side, so no other has more.
#[derive(Clone, Copy)]
struct BalancedRing {
    bearing_rad: f64,
    /// Distance of the centre from the slot's middle.
    distance_mm: f64,
    centre: Flat,
    /// Width that is missing on each side: (1), negative.
    missing_mm: f64,
}

/// Difference of both sides' room that counts as none, mm.
const BALANCE_MM: f64 = 1e-11;
/// Limit of the secants to a balanced ring, more than it needs.
const SECANTS_MAX: usize = 50;
/// Last step of the bearing, relative to the first.
const FINEST_BEARING: f64 = 1e-9;
/// Last step of a direction, relative to the first.
const FINEST_LEAN: f64 = 1e-4;

impl Slot<'_> {
    /// The balanced ring in a bearing, found by secants from a distance on.
    fn balanced(&self, bearing_rad: f64, distance_mm: f64) -> BalancedRing {
        let (sin, cos) = libm::sincos(bearing_rad);
        let at = |distance_mm: f64| {
            let centre = self.middle + Vector2::new(cos, sin) * distance_mm;
            let [on_pressure, on_suction] = self.missing_mm(centre);
            let missing_mm = on_pressure.max(on_suction);
            (BalancedRing { bearing_rad, distance_mm, centre, missing_mm }, on_pressure - on_suction)
        };
        let (mut ring, mut excess_mm) = at(distance_mm);
        // Square to the slot each side changes as the distance does.
        let mut per_mm = -2.0;
        for _ in 0..SECANTS_MAX {
            if excess_mm.abs() <= BALANCE_MM {
                break;
            }
            let (next, next_mm) = at(ring.distance_mm - excess_mm / per_mm);
            let slope = (next_mm - excess_mm) / (next.distance_mm - ring.distance_mm);
            if slope < 0.0 {
                per_mm = slope;
            }
            (ring, excess_mm) = (next, next_mm);
        }
        ring
    }

    /// Width that a ring about a centre lacks on the pressure and on the suction side: both terms of (1), negative.
    fn missing_mm(&self, centre: Flat) -> [f64; 2] {
        let [pressure, suction] = &self.sides;
        let outer = self.cutter.outer_radius_mm - libm::sqrt(pressure.nearest_mm2(centre));
        let inner = libm::sqrt(suction.farthest_mm2(centre)) - self.cutter.inner_radius_mm;
        [outer, inner]
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

/// Directions about the slot's middle, by their leans towards two axes square to it.
pub struct DirectionGrid {
    middle: Vector,
    axes: [Vector; 2],
}

impl DirectionGrid {
    /// Directions about the middle of a slot, by their lean along the circumference and their tilt along the rotor's axis.
    pub fn new(walls: &SidePoints) -> Option<Self> {
        let mean = walls.pressure.iter().chain(&walls.suction).map(|point| point.coords).sum::<Vector>();
        let middle = Vector::new(mean.x, mean.y, 0.0).try_normalize(1e-9)?;
        Some(DirectionGrid { middle, axes: [Vector::z().cross(&middle), Vector::z()] })
    }

    /// The same directions, by their lean across the slot and their tilt along it.
    fn of_slot(walls: &SidePoints) -> Option<Self> {
        let DirectionGrid { middle, .. } = DirectionGrid::new(walls)?;
        let mean = |points: &[Point]| points.iter().map(|point| point.coords).sum::<Vector>() / points.len() as f64;
        let from_side_to_side = mean(&walls.suction) - mean(&walls.pressure);
        let along = middle.cross(&from_side_to_side).try_normalize(1e-9)?;
        Some(DirectionGrid { middle, axes: [along.cross(&middle), along] })
    }

    /// Place of a direction, or the nearest one to it within the grid.
    fn place(&self, direction: &Vector) -> [f64; 2] {
        let lean = |axis: Vector| direction.dot(&axis) / direction.dot(&self.middle);
        self.axes.map(|axis| lean(axis).clamp(-LEAN_MAX_RAD, LEAN_MAX_RAD))
    }

    /// Direction at a place of the grid.
    pub fn direction(&self, [first, second]: [f64; 2]) -> Vector {
        (self.middle + self.axes[0] * first + self.axes[1] * second).normalize()
    }
}

/// Leans of the coarse grid towards one axis.
fn grid_leans() -> impl Iterator<Item = f64> {
    (-LEANS..=LEANS).map(|index| f64::from(index) * LEAN_STEP_RAD)
}

/// Leans and tilts of the coarse grid.
pub fn leans() -> impl Iterator<Item = [f64; 2]> {
    grid_leans().flat_map(|lean| grid_leans().map(move |tilt| [lean, tilt]))
}

fn middle(places: &[Flat]) -> Flat {
    let sum = places.iter().map(|place| place.coords).sum::<nalgebra::Vector2<f64>>();
    Flat::from(sum / places.len() as f64)
}
