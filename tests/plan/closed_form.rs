//! A slot whose path follows from geometry: walls that are circular cylinders along the tool over a cylindrical hub.
//!
//! With the pressure side's tip at angle 0, both normals there lie in planes through the tool's axis, which so is radial: x of the part. In
//! the slot frame a place is (y, z, x) of the part. Radii and centres are those of the walls with their allowance.

use arcfeed_plan::cup_mill::depth::lowest_mm;
use arcfeed_plan::cup_mill::level::StopSurface;
use arcfeed_plan::cup_mill::patch::Patch;
use arcfeed_plan::cup_mill::plan::{SlotPlan, plan};
use arcfeed_plan::geometry::blisk::{Blank, Blisk, Revolution, Slot};
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::vector::{Flat, Point, Vector};
use nalgebra::Vector2;

use crate::twisted::{ALLOWANCE_MM, HUB_MM, ring, roughing};

/// The tip goes on by the allowance, and ends within the rounding of the inserts at the first level.
const TIP_MM: f64 = 105.5;
const BLANK_MM: f64 = 106.9;
/// Ends of both walls along the rotor's axis.
const HALF_MM: f64 = 13.0;
/// The share of the tip curve that the turn about B1 is to meet.
const SHARE: f64 = 0.15;
/// Contact is where the circles are this far within each other: the planner's bound, which a lever lengthens.
const TOUCH_MM: f64 = 2e-6;
const POINTS: usize = 121;

/// An arc, from its leading end.
#[derive(Clone, Copy)]
struct Arc {
    centre: Flat,
    radius_mm: f64,
    from_rad: f64,
    to_rad: f64,
}

impl Arc {
    fn at(&self, share: f64) -> Flat {
        let (sin, cos) = libm::sincos(self.from_rad + (self.to_rad - self.from_rad) * share);
        self.centre + Vector2::new(cos, sin) * self.radius_mm
    }

    /// With its middle looking along +x but for `tilt_rad`, through `end` at one of its ends.
    fn through(end: Flat, is_leading: bool, radius_mm: f64, tilt_rad: f64) -> Self {
        let half_rad = libm::asin(HALF_MM / radius_mm);
        let [from_rad, to_rad] = [tilt_rad + half_rad, tilt_rad - half_rad];
        let (sin, cos) = libm::sincos(if is_leading { from_rad } else { to_rad });
        Arc { centre: end - Vector2::new(cos, sin) * radius_mm, radius_mm, from_rad, to_rad }
    }

    /// The wall that has this arc `outward_mm` outside of it, over the whole depth and some below.
    fn wall(&self, radius_mm: f64, outward: f64) -> Face {
        let bare = Arc { radius_mm, ..*self };
        let height_mm = |j: i32| 70.0 + (TIP_MM - 70.0) * f64::from(j) / 4.0;
        let section = |j: i32| {
            let places = (0..POINTS).map(|i| bare.at(i as f64 / (POINTS - 1) as f64));
            places.map(|place| Point::new(height_mm(j), place.x, place.y)).collect()
        };
        Face::through(&(0..5).map(section).collect::<Vec<_>>(), Vector::y() * outward).unwrap()
    }
}

/// Intersections of circles about `a` and `b`: first the one on the left of the line from a to b, then the other.
fn crossings(a: Flat, a_mm: f64, b: Flat, b_mm: f64) -> [Flat; 2] {
    let way = b - a;
    let square = way.norm_squared();
    let share = (square + a_mm * a_mm - b_mm * b_mm) / (2.0 * square);
    let aside = libm::sqrt(a_mm * a_mm / square - share * share);
    [1.0, -1.0].map(|side| a + way * share + Vector2::new(-way.y, way.x) * (aside * side))
}

fn nearest(places: [Flat; 2], to: Flat) -> Flat {
    let [a, b] = places;
    if (a - to).norm() < (b - to).norm() { a } else { b }
}

/// The slot: concave pressure side through (0, HALF_MM), convex suction side ending at B.
struct ProofCase {
    pressure: Arc,
    suction: Arc,
    centre: Flat,
    blisk: Blisk,
    slot: Slot,
}

/// A base position turned by `turned_rad` from the one that touches both ends of the pressure side's chord.
fn case(pressure_mm: f64, turned_rad: f64) -> ProofCase {
    let cutter = ring();
    let exterior = Flat::new(0.0, HALF_MM);
    let pressure = Arc::through(exterior, true, pressure_mm, 0.0);
    let bearing = libm::asin(HALF_MM / cutter.outer_radius_mm) + turned_rad;
    let centre = exterior - Vector2::new(libm::cos(bearing), libm::sin(bearing)) * cutter.outer_radius_mm;
    let below_mm = -HALF_MM - centre.y;
    let r_mm = cutter.inner_radius_mm;
    let interior = Flat::new(centre.x + libm::sqrt(r_mm * r_mm - below_mm * below_mm), -HALF_MM);
    let suction = Arc::through(interior, false, 70.0, 0.03);
    let slot = Slot {
        pressure: pressure.wall(pressure.radius_mm + ALLOWANCE_MM, -1.0),
        suction: suction.wall(suction.radius_mm - ALLOWANCE_MM, 1.0),
    };
    let blisk = Blisk {
        blades: 19,
        pressure: slot.pressure.clone(),
        suction: slot.suction.clone(),
        further_blades: Vec::new(),
        hub: Revolution { profile_mm: vec![[-40.0, HUB_MM], [40.0, HUB_MM]] },
        blank: Blank { radius_mm: BLANK_MM, faces_mm: [-20.0, 20.0] },
    };
    ProofCase { pressure, suction, centre, blisk, slot }
}

impl ProofCase {
    fn plan(&self) -> SlotPlan {
        let mut demands = roughing();
        demands.interior_contact = SHARE;
        plan(&self.blisk, &self.slot, &ring(), &demands).unwrap()
    }

    /// The centre when a circle that holds the suction arc touches it at a share of it.
    fn tangent_centre(&self, share: f64) -> Flat {
        let spoke = self.suction.at(share) - self.suction.centre;
        self.suction.at(share) - spoke * (ring().inner_radius_mm / self.suction.radius_mm)
    }

    /// B1: on the inner circle before and after.
    fn pivot(&self, share: f64) -> Flat {
        let r_mm = ring().inner_radius_mm;
        nearest(crossings(self.centre, r_mm, self.tangent_centre(share), r_mm), self.suction.at(1.0))
    }

    /// Lowest above the hub's offset on both arcs: where the torus about the outer circle's nearest place to the rotor's axis touches it, at
    /// the base position or at an end, for the centre moves one way. A ring that stands over the axis touches it with its flat bottom.
    fn lowest_mm(&self) -> f64 {
        let cutter = ring();
        let [rounding_mm, outer_mm] = [cutter.insert_radius_mm, cutter.outer_radius_mm];
        let reach_mm = HUB_MM + ALLOWANCE_MM + rounding_mm;
        let end = crossings(self.pressure.at(0.0), outer_mm, self.pressure.at(1.0), outer_mm);
        let centres = [self.centre, nearest(end, self.centre), self.tangent_centre(SHARE)];
        let tubes_mm = centres.map(|centre| (centre.x + outer_mm - rounding_mm).min(0.0));
        let lowest = tubes_mm.map(|tube_mm| libm::sqrt(reach_mm * reach_mm - tube_mm * tube_mm) - rounding_mm);
        lowest.into_iter().fold(0.0, f64::max)
    }

    /// By how much a level's ring is drawn in at the height of the tips.
    fn drawn_in_mm(&self, bottom_mm: f64) -> f64 {
        let cutter = ring();
        let below_mm = (cutter.insert_radius_mm - (TIP_MM + ALLOWANCE_MM - bottom_mm)).max(0.0);
        let rounding_mm = cutter.insert_radius_mm;
        rounding_mm - libm::sqrt(rounding_mm * rounding_mm - below_mm * below_mm)
    }
}

#[test]
fn axis_base_interior_pivot_and_levels_are_those_of_circles() {
    let case = case(100.0, -0.05);
    let plan = case.plan();
    let cutter = ring();
    let axis_rad = plan.blade_axis.direction.cross(&Vector::x()).norm();
    let tip_mm = (plan.blade_axis.tip - Point::new(TIP_MM, 0.0, HALF_MM)).norm();
    let foot_x_mm = libm::sqrt((HUB_MM + ALLOWANCE_MM) * (HUB_MM + ALLOWANCE_MM));
    let foot_mm = (plan.blade_axis.foot - Point::new(foot_x_mm, 0.0, HALF_MM)).norm();
    println!("axis {axis_rad:.1e} rad, PT1 {tip_mm:.1e} mm, foot {foot_mm:.1e} mm");
    assert!(axis_rad < 1e-9 && tip_mm < 1e-7 && foot_mm < 1e-7);

    let base_mm = (plan.base.centre - case.centre).norm();
    let interior_mm = (plan.base.interior - case.suction.at(1.0)).norm();
    let a_mm = (case.suction.at(1.0) - case.pressure.at(0.0)).norm();
    let [outer_mm, inner_mm] = [cutter.outer_radius_mm, cutter.inner_radius_mm];
    let cos = (outer_mm * outer_mm + a_mm * a_mm - inner_mm * inner_mm) / (2.0 * outer_mm * a_mm);
    let alpha_rad = (libm::cos(plan.base.alpha_rad) - cos).abs();
    println!("C {base_mm:.1e} mm, PT3 {interior_mm:.1e} mm, cos(alpha) {alpha_rad:.1e}");
    assert!(base_mm < 1e-6 && interior_mm < 1e-6 && alpha_rad < 1e-9);

    let share = (plan.interior.contact - SHARE).abs();
    let pivot_mm = (plan.interior.pivot - case.pivot(SHARE)).norm();
    println!("share of the contact {share:.1e}, B1 {pivot_mm:.1e} mm");
    // The circle that is 2 nm wider, and the pivot on the bisector of both centres.
    let lever = inner_mm / (case.tangent_centre(SHARE) - case.centre).norm();
    println!("2 nm by the lever of B1 is {:.1e} mm", lever * TOUCH_MM);
    assert!(share < 1e-6 && pivot_mm < 1.1 * lever * TOUCH_MM);

    // The blank's crest is under 0.2 mm of the ring here, where the search for the highest material ends a little beside it.
    let top_mm = plan.top_mm;
    assert!(top_mm <= BLANK_MM + 1e-9 && top_mm > BLANK_MM - 0.02, "{top_mm}");
    let lowest = case.lowest_mm();
    let bottom_mm = plan.path.levels.last().unwrap().height_mm - lowest;
    println!("highest material {:.1e} mm, lowest level {bottom_mm:.1e} mm", top_mm - BLANK_MM);
    let depth_mm = top_mm - cutter.insert_radius_mm - lowest;
    let steps = libm::ceil(depth_mm / 2.54);
    assert_eq!(plan.path.levels.len(), steps as usize + 1);
    let heights = plan.path.levels.iter().enumerate();
    let off = heights.map(|(k, level)| (level.height_mm - (lowest + depth_mm * (1.0 - k as f64 / steps))).abs());
    let level_mm = off.fold(0.0, f64::max);
    println!("{} levels {level_mm:.1e} mm", steps + 1.0);
    assert!(level_mm < 1e-6);
}

#[test]
fn turns_end_where_circles_touch() {
    let case = case(100.0, -0.05);
    let plan = case.plan();
    let cutter = ring();
    let [lead, trail] = [case.pressure.at(0.0), case.pressure.at(1.0)];
    let [outer_mm, inner_mm] = [cutter.outer_radius_mm, cutter.inner_radius_mm];
    let pivot = case.pivot(SHARE);
    let mut worst_mm = [0.0_f64; 2];
    for (level, [exterior, interior]) in plan.path.levels.iter().zip(&plan.stops) {
        assert_eq!(exterior.at.map(|at| at.0), Some(StopSurface::Pressure), "at {}", level.height_mm);
        let drawn_in_mm = case.drawn_in_mm(level.height_mm);
        let ends = crossings(lead, outer_mm, trail, outer_mm - drawn_in_mm);
        worst_mm[0] = worst_mm[0].max((level.exterior_end - nearest(ends, case.centre)).norm());
        let within_mm = inner_mm + drawn_in_mm - case.suction.radius_mm;
        let ends = crossings(pivot, inner_mm, case.suction.centre, within_mm);
        // The first level may be left where the line to the second one is clear.
        if drawn_in_mm == 0.0 {
            assert_eq!(interior.at.map(|at| at.0), Some(StopSurface::Suction), "at {}", level.height_mm);
            worst_mm[1] = worst_mm[1].max((level.interior_end - nearest(ends, case.tangent_centre(SHARE))).norm());
        }
    }
    assert!(
        case.drawn_in_mm(plan.path.levels[0].height_mm) > 0.1,
        "the first level is to meet the tip with its rounding"
    );
    // Turning by dt about A moves the trailing end by |AT| dt across the circle, the centre by R dt.
    let lever = cutter.outer_radius_mm / (trail - lead).norm();
    println!(
        "D {:.1e} mm, E {:.1e} mm; 2 nm by the lever of D is {:.1e} mm",
        worst_mm[0],
        worst_mm[1],
        lever * TOUCH_MM
    );
    assert!(worst_mm[0] < 1.1 * lever * TOUCH_MM && worst_mm[1] < 2e-5, "{worst_mm:?}");
}

#[test]
fn a_pressure_side_flatter_than_the_ring_is_touched_at_a_itself() {
    let case = case(200.0, -0.05);
    let plan = case.plan();
    let outward = case.pressure.centre - case.pressure.at(0.0);
    let exact = case.pressure.at(0.0) + outward * (ring().outer_radius_mm / case.pressure.radius_mm);
    let worst_mm = plan.path.levels.iter().skip(1).map(|level| (level.exterior_end - exact).norm()).fold(0.0, f64::max);
    // Near A, at a distance d, contact comes after  t0 + d c + touch / d,  c = (1/R - 1/rho) / 2: least t0 + 2 sqrt(c touch).
    let c = (1.0 / ring().outer_radius_mm - 1.0 / case.pressure.radius_mm) / 2.0;
    let expected_mm = 2.0 * libm::sqrt(c * TOUCH_MM) * ring().outer_radius_mm;
    println!("D {worst_mm:.1e} mm off the tangent; {expected_mm:.1e} mm follow from 2 nm of overlap");
    assert!(worst_mm < 1.1 * expected_mm);
}

#[test]
fn a_torus_over_a_cylinder_is_lowest_where_both_have_one_plane() {
    let cutter = ring();
    let floor_mm = HUB_MM + ALLOWANCE_MM;
    let hub = Patch::new([[-20.0, 20.0], [-0.6, 0.6]], [32, 128], move |z, angle| {
        let (sin, cos) = libm::sincos(angle);
        Point::new(floor_mm * sin, z, floor_mm * cos)
    });
    let (rounding_mm, mut worst_mm) = (cutter.insert_radius_mm, 0.0_f64);
    for k in 0..40 {
        // The outer circle's nearest place to the rotor's axis, from 0 to 20 mm beside it.
        let beside_mm = f64::from(k) / 2.0;
        let tube_mm = beside_mm + rounding_mm;
        let reach_mm = floor_mm + rounding_mm;
        let exact_mm = libm::sqrt(reach_mm * reach_mm - tube_mm * tube_mm) - rounding_mm;
        let centre = Flat::new(-(beside_mm + cutter.outer_radius_mm), f64::from(k % 7) - 3.0);
        let found_mm = lowest_mm(&cutter, centre, &hub).unwrap();
        worst_mm = worst_mm.max((found_mm - exact_mm).abs());
    }
    println!("lowest level {worst_mm:.1e} mm");
    assert!(worst_mm < 1e-6);
}
