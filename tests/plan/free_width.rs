//! The free width of a ring against plain grids of directions and centres.

use arcfeed_plan::cup_mill::axis::axis;
use arcfeed_plan::cup_mill::free_width::{FreeWidth, SidePoints};
use arcfeed_plan::cup_mill::side::{FarEdge, Hub, OffsetSide};
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::geometry::blisk::{Blisk, Slot};
use arcfeed_plan::vector::{Flat, Point, Vector};
use nalgebra::{Rotation3, Vector2};

use crate::dense::Dense;
use crate::twisted::{ALLOWANCE_MM, ROTORS, ring};

/// Every so manieth sample of the planner's sides each way; the dense ones of a slot are the yardstick of what that costs.
const STRIDE: usize = 4;

/// What a direction must have more for each radian from the blade's axis.
const LEAN_MM_PER_RAD: f64 = 0.003;

fn sides(blisk: &Blisk, slot: &Slot) -> [OffsetSide; 2] {
    let hub = Hub { hub: &blisk.hub, allowance_mm: ALLOWANCE_MM };
    let faces = [(&slot.pressure, FarEdge::Trailing), (&slot.suction, FarEdge::Leading)];
    faces.map(|(face, far)| OffsetSide::new(face, far, &hub, &Rotation3::identity()).unwrap())
}

/// Both sides' points as a tool along `direction` sees them, in a frame of our own.
fn seen(points: &[Vec<Point>; 2], direction: &Vector) -> [Vec<Flat>; 2] {
    let across = direction.cross(&Vector::z()).normalize();
    let along = direction.cross(&across);
    let flat = |p: &Point| Flat::new(p.coords.dot(&across), p.coords.dot(&along));
    [0, 1].map(|side: usize| points[side].iter().map(flat).collect())
}

/// Clearance of a ring at a centre, at the outer and at the inner circle.
fn spare_mm([pressure, suction]: &[Vec<Flat>; 2], cutter: &CupMill, centre: Flat) -> [f64; 2] {
    let nearest = pressure.iter().map(|p| (p - centre).norm_squared()).fold(f64::INFINITY, f64::min);
    let farthest = suction.iter().map(|s| (s - centre).norm_squared()).fold(0.0, f64::max);
    [libm::sqrt(nearest) - cutter.outer_radius_mm, cutter.inner_radius_mm - libm::sqrt(farthest)]
}

/// The best of a grid, then of grids about the best one that become finer where they find nothing better.
fn best_of(start: [f64; 2], [count, step]: [f64; 2], finest: f64, f: impl Fn([f64; 2]) -> f64) -> (f64, [f64; 2]) {
    let grid = |middle: [f64; 2], count: i32, step: f64| {
        let places = (-count..=count).flat_map(move |i| (-count..=count).map(move |j| [f64::from(i), f64::from(j)]));
        places.map(move |[i, j]| [middle[0] + i * step, middle[1] + j * step])
    };
    let better = |a: (f64, [f64; 2]), b: (f64, [f64; 2])| if b.0 > a.0 { b } else { a };
    let mut best = grid(start, count as i32, step).map(|at| (f(at), at)).fold((f64::MIN, start), better);
    let mut step = step / 2.0;
    while step > finest {
        let found = grid(best.1, 2, step).map(|at| (f(at), at)).fold(best, better);
        step *= if found.0 > best.0 { 1.1 } else { 0.5 };
        best = found;
    }
    best
}

/// Greatest value of a function with one peak in an interval.
fn peak([low, high]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..40 {
        let third = (high - low) / 3.0;
        if f(low + third) < f(high - third) { low += third } else { high -= third }
    }
    f((low + high) / 2.0)
}

/// The free width along a direction, from centres in all bearings: the most in each of a grid, at whatever distance, then the most about the best bearing.
fn room_mm(points: &[Vec<Point>; 2], cutter: &CupMill, direction: &Vector) -> f64 {
    let seen = seen(points, direction);
    let middle = |side: &[Flat]| side.iter().fold(Vector2::zeros(), |sum, p| sum + p.coords) / side.len() as f64;
    let (from, to) = (middle(&seen[0]), middle(&seen[1]));
    let bearing = libm::atan2(to.y - from.y, to.x - from.x);
    let free_width = |turn: f64| {
        let (sin, cos) = libm::sincos(bearing + turn);
        let distances_mm = [cutter.inner_radius_mm - 20.0, cutter.outer_radius_mm + 20.0];
        peak(distances_mm, |off_mm| {
            let [outer_mm, inner_mm] = spare_mm(&seen, cutter, Flat::from(from + Vector2::new(cos, sin) * off_mm));
            outer_mm.min(inner_mm)
        })
    };
    let bearings = (-24..=24).map(|k| f64::from(k) * 0.03);
    let best = bearings.map(|turn| (free_width(turn), turn)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap().1;
    peak([best - 0.03, best + 0.03], free_width)
}

/// The direction of the tool along the blade's edge.
fn blade_axis(blisk: &Blisk, slot: &Slot) -> Vector {
    axis(&slot.pressure, &blisk.hub, ALLOWANCE_MM).unwrap().direction
}

#[test]
fn the_roomiest_direction_is_that_of_a_grid_of_directions_and_centres() {
    for rotor in &ROTORS {
        let (blisk, slot) = rotor.slot(0.0);
        let sides = sides(&blisk, &slot);
        let blade = blade_axis(&blisk, &slot);
        let roomiest = SidePoints::new(&sides[0], &sides[1]).roomiest(&ring(), &blade).unwrap();
        let points = [0, 1].map(|k: usize| sides[k].patch.thinned(STRIDE).copied().collect::<Vec<Point>>());
        let bearing = libm::atan2(slot.pressure.point(0.5, 0.5).y, slot.pressure.point(0.5, 0.5).x);
        let direction = |[aside, up]: [f64; 2]| {
            let (sin, cos) = libm::sincos(bearing + aside);
            Vector::new(cos * libm::cos(up), sin * libm::cos(up), libm::sin(up))
        };
        let leaned_mm = |direction: &Vector| LEAN_MM_PER_RAD * direction.angle(&blade);
        let value_mm = |direction: &Vector| room_mm(&points, &ring(), direction) - leaned_mm(direction);
        let (found_mm, _) = best_of([0.0, 0.0], [4.0, 0.12], 1e-3, |at| value_mm(&direction(at)));
        let value_mm = roomiest.per_side_mm - leaned_mm(&roomiest.direction);
        let along_mm = room_mm(&points, &ring(), &roomiest.direction);
        let dense = [(&slot.pressure, 1), (&slot.suction, 0)].map(|(face, far)| {
            let samples = Dense::side(face, far, Rotation3::identity()).samples;
            samples.into_iter().map(|(_, point)| point).collect::<Vec<Point>>()
        });
        let sampled_mm = room_mm(&dense, &ring(), &roomiest.direction) - roomiest.per_side_mm;
        println!(
            "{}: roomiest {:.4} mm, {:.3} rad from the blade's axis, grid {:.1e}, centres along it {:.1e}; dense samples {sampled_mm:.1e}",
            rotor.name,
            roomiest.per_side_mm,
            roomiest.direction.angle(&blade),
            value_mm - found_mm,
            roomiest.per_side_mm - along_mm,
        );
        // It claims the free width that there is, and no place of the grid has more; on an edge of the free width the grid ends below the peak.
        assert!((roomiest.per_side_mm - along_mm).abs() < 1e-4 && found_mm - value_mm < 1e-4, "{}", rotor.name);
        // Free widths are judged on samples: what counts as enough is wider than what lies between them.
        assert!(sampled_mm < 1e-6 && sampled_mm > -0.1, "{}", rotor.name);
    }
}

#[test]
fn a_wider_ring_has_less_room_by_what_it_is_wider_on_each_side() {
    let mut worst_mm = 0.0_f64;
    for rotor in &ROTORS {
        let (blisk, slot) = rotor.slot(0.0);
        let sides = sides(&blisk, &slot);
        let walls = SidePoints::new(&sides[0], &sides[1]);
        let plain = walls.roomiest(&ring(), &blade_axis(&blisk, &slot)).unwrap();
        let aside = (plain.direction + Vector::z() * 0.1).normalize();
        for direction in [plain.direction, aside] {
            let free_width = |cutter: &CupMill| -> FreeWidth { walls.free_width(cutter, &direction).unwrap() };
            for wider_mm in [-1.5, 0.3, 1.0, 2.5] {
                let plain = free_width(&ring());
                let wide = free_width(&CupMill {
                    outer_radius_mm: ring().outer_radius_mm + wider_mm,
                    inner_radius_mm: ring().inner_radius_mm - wider_mm,
                    ..ring()
                });
                worst_mm = worst_mm.max((wide.per_side_mm + wider_mm - plain.per_side_mm).abs());
            }
        }
    }
    println!("wider rings: {worst_mm:.1e} mm");
    assert!(worst_mm < 1e-6);
}
