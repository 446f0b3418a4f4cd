//! Axis, base position and B1 on twisted rotors, against meshes, searches over centres, and scans of pivots and turns.

use arcfeed_nc::modal::Turn;
use arcfeed_plan::cup_mill::axis::axis;
use arcfeed_plan::cup_mill::base::triangle;
use arcfeed_plan::cup_mill::plan::SlotPlan;
use arcfeed_plan::cup_mill::side::edges;
use arcfeed_plan::geometry::blisk::Slot;
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::vector::{Flat, Point, Vector};
use nalgebra::{Matrix2, Rotation2, Vector2};

use crate::dense::Dense;
use crate::twisted::{ALLOWANCE_MM, HUB_MM, ROTORS, Twisted, ring, roughing};

/// Overlap from which the planner counts a contact.
const TOUCH_MM: f64 = 2e-6;

/// Triangles of a side with its allowance, between its edges.
fn mesh(face: &Face, cells: usize) -> Vec<[Point; 3]> {
    let [first, last] = edges(face);
    let share = |k: usize| k as f64 / cells as f64;
    let row = |i: usize| -> Vec<Point> {
        let u = first + (last - first) * share(i);
        (0..=cells).map(|j| face.offset(u, share(j), ALLOWANCE_MM)).collect()
    };
    let rows: Vec<Vec<Point>> = (0..=cells).map(row).collect();
    let cell = |i: usize, j: usize| {
        let [a, b, c, d] = [rows[i][j], rows[i + 1][j], rows[i + 1][j + 1], rows[i][j + 1]];
        [[a, b, c], [a, c, d]]
    };
    (0..cells).flat_map(|i| (0..cells).flat_map(move |j| [(i, j)])).flat_map(|(i, j)| cell(i, j)).collect()
}

/// Zeros of a function that is linear between the corners, on a triangle's border.
fn zeros(triangle: &[Point; 3], f: impl Fn(&Point) -> f64) -> Vec<Point> {
    let pairs = [[0, 1], [1, 2], [2, 0]].map(|[a, b]| [triangle[a], triangle[b]]);
    let cut = pairs.into_iter().filter_map(|[a, b]| {
        let (from, to) = (f(&a), f(&b));
        (from * to < 0.0).then(|| a + (b - a) * (from / (from - to)))
    });
    cut.collect()
}

/// LN3's lower end by a mesh: the plane's cut of the face where that reaches the hub, or the place on the hub nearest to the plane.
fn foot(face: &Face, tip: &Point, plane: &Vector) -> (Point, bool) {
    let above_mm = |p: &Point| libm::hypot(p.x, p.y) - HUB_MM - ALLOWANCE_MM;
    let off_mm = |p: &Point| (p - tip).dot(plane);
    let mut on_hub: Vec<Point> = Vec::new();
    for triangle in mesh(face, 400) {
        let ends = zeros(&triangle, above_mm);
        if let [a, b] = ends[..] {
            let (from, to) = (off_mm(&a), off_mm(&b));
            if from * to < 0.0 {
                return (a + (b - a) * (from / (from - to)), true);
            }
            on_hub.extend([a, b]);
        }
    }
    (*on_hub.iter().min_by(|a, b| off_mm(a).abs().total_cmp(&off_mm(b).abs())).unwrap(), false)
}

#[test]
fn the_axis_is_that_of_a_mesh_cut_by_the_plane_of_both_normals() {
    for rotor in ROTORS {
        let (blisk, slot) = rotor.slot(0.3);
        let found = axis(&slot.pressure, &blisk.hub, ALLOWANCE_MM).unwrap();
        let [first, _] = edges(&slot.pressure);
        let tip = slot.pressure.offset(first, 1.0, ALLOWANCE_MM);
        let up = Vector::new(tip.x, tip.y, 0.0);
        let plane = up.cross(&slot.pressure.normal(first, 1.0)).normalize();
        let (foot, reaches) = foot(&slot.pressure, &tip, &plane);
        let off_rad = (tip - foot).normalize().cross(&found.direction).norm();
        let foot_mm = (foot - found.foot).norm();
        println!("{}: reaches the hub {reaches}, foot {foot_mm:.1e} mm, axis {off_rad:.1e} rad", rotor.name);
        assert!(foot_mm < 1e-3 && off_rad < 5e-5, "{}", rotor.name);
    }
}

#[test]
fn a_triangle_is_where_two_circles_cross() {
    let mut worst_mm = 0.0_f64;
    for k in 0..2000 {
        // Fractions of multiples of irrational numbers: spread, and the same each time.
        let [a, b, c, d, e] = [2, 3, 5, 7, 11].map(|n| libm::fmod(f64::from(k) * libm::sqrt(f64::from(n)), 1.0));
        let centre = Flat::new(a * 100.0, b * 100.0);
        let outer_mm = 50.0 + c * 100.0;
        let inner_mm = outer_mm - 5.0 - d * 20.0;
        let on = |radius_mm: f64, bearing: f64| centre + Rotation2::new(bearing) * Vector2::new(radius_mm, 0.0);
        let bearing = a * 6.0;
        let (exterior, interior) = (on(outer_mm, bearing), on(inner_mm, bearing + (e - 0.5) * 0.6));
        let found = triangle(exterior, interior, [outer_mm, inner_mm], on(inner_mm - 10.0, bearing)).unwrap();
        worst_mm = worst_mm.max((found.centre - centre).norm());
    }
    println!("2000 triangles: centre {worst_mm:.1e} mm off that they were made from");
    // If the three corners lie on one line, the angle, and so the centre, has half the digits.
    assert!(worst_mm < 1e-4);
}

/// The sides that a slot's tool sees, sampled.
fn sampled<'f>(slot: &'f Slot, plan: &SlotPlan) -> [Dense<'f>; 2] {
    [(&slot.pressure, 1), (&slot.suction, 0)].map(|(face, far)| Dense::side(face, far, plan.turn))
}

/// Gaps of both circles about a centre, with where they are least.
type Gaps = [(f64, [f64; 2]); 2];

fn largest_mm([outer, inner]: Gaps) -> f64 {
    outer.0.abs().max(inner.0.abs())
}

/// On every `stride`th sample.
fn gaps(sides: &[Dense<'_>; 2], centre: Flat, stride: usize) -> Gaps {
    let off = |p: &Point| libm::hypot(p.x - centre.x, p.y - centre.y);
    let outer = sides[0].samples.iter().step_by(stride).map(|(at, p)| (off(p) - ring().outer_radius_mm, *at));
    let inner = sides[1].samples.iter().step_by(stride).map(|(at, p)| (ring().inner_radius_mm - off(p), *at));
    [outer.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap(), inner.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()]
}

/// On ever finer grids about the best samples.
fn exact_gaps(sides: &[Dense<'_>; 2], centre: Flat) -> Gaps {
    let near = gaps(sides, centre, 1);
    let off = |p: &Point| libm::hypot(p.x - centre.x, p.y - centre.y);
    let outer = sides[0].finer(near[0], |p| off(p) - ring().outer_radius_mm);
    let inner = sides[1].finer(near[1], |p| ring().inner_radius_mm - off(p));
    [outer, inner]
}

/// The centre at which both circles touch, the outer one nearer to the leading edge than the inner one: on a grid about `start`, then
/// by Newton's method with differences.
fn touching(sides: &[Dense<'_>; 2], start: Flat) -> (Flat, Gaps) {
    let grid = |middle: Flat, count: i32, step_mm: f64| {
        let offsets = (-count..=count).flat_map(move |i| (-count..=count).map(move |j| [f64::from(i), f64::from(j)]));
        offsets.map(move |[i, j]| middle + Vector2::new(i, j) * step_mm).collect::<Vec<Flat>>()
    };
    let is_base = |gaps: &Gaps| gaps[0].1[0] < gaps[1].1[0];
    let valued = |centres: Vec<Flat>, stride: usize| {
        let all = centres.into_iter().map(|centre| (gaps(sides, centre, stride), centre));
        let those = all.filter(|(gaps, _)| is_base(gaps)).map(|(gaps, centre)| (largest_mm(gaps), centre));
        those.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap().1
    };
    let mut centre = valued(grid(start, 40, 1.0), 101);
    for _ in 0..40 {
        let now = exact_gaps(sides, centre);
        let slope = [Vector2::x(), Vector2::y()].map(|axis| {
            let [ahead, behind] = [1e-4, -1e-4].map(|way| exact_gaps(sides, centre + axis * way));
            Vector2::new(ahead[0].0 - behind[0].0, ahead[1].0 - behind[1].0) / 2e-4
        });
        let solved = Matrix2::from_columns(&slope).try_inverse().unwrap() * Vector2::new(now[0].0, now[1].0);
        centre -= solved * (0.5 / solved.norm()).min(1.0);
    }
    (centre, exact_gaps(sides, centre))
}

/// Start of a search over centres: half the ring's width inside of the outer circle through PT1.
fn beside(slot: &Slot, plan: &SlotPlan) -> Flat {
    let tip = |face: &Face| (plan.turn * face.offset(0.5, 1.0, ALLOWANCE_MM)).xy();
    let (pressure, suction) = (tip(&slot.pressure), tip(&slot.suction));
    pressure + (suction - pressure).normalize() * ring().outer_radius_mm
}

#[test]
fn the_base_position_touches_both_sides_and_takes_neither() {
    for rotor in ROTORS {
        let (_, slot) = rotor.slot(0.0);
        let plan = rotor.plan();
        let sides = sampled(&slot, &plan);
        let (centre, ends) = touching(&sides, beside(&slot, &plan));
        let missed_mm = largest_mm(ends);
        let off_mm = (centre - plan.base.centre).norm();
        let at = [0, 1].map(|k| (sides[k].point(ends[k].1).xy() - [plan.base.exterior, plan.base.interior][k]).norm());
        let [outer_mm, inner_mm] = [ring().outer_radius_mm, ring().inner_radius_mm];
        let a_mm = (plan.base.interior - plan.base.exterior).norm();
        let alpha = (outer_mm * outer_mm + a_mm * a_mm - inner_mm * inner_mm) / (2.0 * outer_mm * a_mm);
        let eq5 = (libm::cos(plan.base.alpha_rad) - alpha).abs();
        let takes_mm = largest_mm(exact_gaps(&sides, plan.base.centre));
        // Two spokes that lie nearly in one line leave the centre free across them.
        let spokes = [plan.base.exterior, plan.base.interior].map(|end| (end - plan.base.centre).normalize());
        let lever = 2.0 / spokes[0].perp(&spokes[1]).abs();
        println!(
            "{}: gaps {takes_mm:.1e}, C {off_mm:.1e} (lever {lever:.0}), A {:.1e}, B {:.1e} mm, (5) {eq5:.1e}, {missed_mm:.0e} left",
            rotor.name, at[0], at[1]
        );
        assert!(takes_mm < 1.1e-6 && off_mm < lever * 1.1e-6 && eq5 < 1e-12, "{}", rotor.name);
    }
}

/// Share of the tip curve that the inner circle meets first when it turns about `pivot`: the turn is halved where a scan finds the first
/// overlap.
fn first_met(curve: &[Flat], plan: &SlotPlan, pivot: Flat) -> Option<f64> {
    let sense = if plan.path.outward == Turn::Ccw { 1.0 } else { -1.0 };
    let farthest = |turn: f64, stride: usize| {
        let centre = pivot + Rotation2::new(turn * sense) * (plan.base.centre - pivot);
        let off = curve.iter().enumerate().step_by(stride).map(|(k, p)| ((p - centre).norm(), k));
        off.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    };
    let limit_mm = ring().inner_radius_mm + TOUCH_MM;
    let beyond = (1..=600).map(|k| f64::from(k) * 2e-3).find(|turn| farthest(*turn, 10).0 > limit_mm)?;
    let (mut clear, mut beyond) = (0.0, beyond);
    for _ in 0..40 {
        let middle = (clear + beyond) / 2.0;
        if farthest(middle, 1).0 > limit_mm { beyond = middle } else { clear = middle }
    }
    Some(farthest(beyond, 1).1 as f64 / (curve.len() - 1) as f64)
}

/// The pivot nearest to B on the inner circle, towards the leading edge, by which contact comes within `share`.
fn scanned_pivot(rotor: &Twisted, plan: &SlotPlan, share: f64) -> Option<Flat> {
    let (_, slot) = rotor.slot(0.0);
    let [first, last] = edges(&slot.suction);
    let place = |k: i32| {
        let u = first + (last - first) * f64::from(k) / 4000.0;
        (plan.turn * slot.suction.offset(u, 1.0, ALLOWANCE_MM)).xy()
    };
    let curve: Vec<Flat> = (0..=4000).map(place).collect();
    let spoke = plan.base.interior - plan.base.centre;
    let towards = libm::copysign(1.0, spoke.perp(&(curve[0] - plan.base.centre)));
    let pivot = |angle: f64| plan.base.centre + Rotation2::new(angle * towards) * spoke;
    let is_met = |angle: f64| first_met(&curve, plan, pivot(angle)).is_some_and(|at| at <= share);
    let beyond = (0..300).map(|k| f64::from(k) * 1e-3).find(|angle| is_met(*angle))?;
    let (mut before, mut beyond) = ((beyond - 1e-3).max(0.0), beyond);
    for _ in 0..16 {
        let middle = (before + beyond) / 2.0;
        if is_met(middle) { beyond = middle } else { before = middle }
    }
    Some(pivot(beyond))
}

#[test]
fn the_interior_pivot_is_that_of_a_scan_of_pivots_and_turns() {
    for rotor in ROTORS {
        let plan = rotor.plan();
        let share = roughing().interior_contact;
        let scanned = scanned_pivot(&rotor, &plan, share);
        let off_mm = scanned.map(|pivot| (pivot - plan.interior.pivot).norm());
        let Some(off_mm) = off_mm else {
            println!("{}: no pivot leads within the share; the planner takes {:.9}", rotor.name, plan.interior.contact);
            assert!(plan.interior.contact > share);
            continue;
        };
        println!("{}: contact at {:.9} of the curve, B1 {off_mm:.1e} mm", rotor.name, plan.interior.contact);
        // One sample of the curve is 1/4000 of it, and B1 moves by some ten millimetres over the whole.
        assert!(off_mm < 0.02, "{}", rotor.name);
    }
}
