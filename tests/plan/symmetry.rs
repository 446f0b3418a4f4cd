//! Changes of the input that leave a plan unchanged, and changes that mirror it.

use std::sync::OnceLock;

use arcfeed_nc::modal::Turn;
use arcfeed_plan::cup_mill::plan::{AxisChoice, SlotPlan};
use arcfeed_plan::geometry::blade::Sections;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::vector::{Flat, Point, Vector};
use arcfeed_tests::of_full_set;
use nalgebra::Rotation3;

use crate::proof_cases::published_tool;
use crate::proof_published::{ROUGHING, ranked};
use crate::published_rotor;
use crate::twisted::{ROTORS, Twisted, ring, roughing};

/// Largest difference of equal plans, mm.
pub const SAME_MM: f64 = 1e-9;

/// Largest differences of two plans, the second one's places as `seen`: of places and heights, mm.
pub fn differences_mm(a: &SlotPlan, b: &SlotPlan, seen: impl Fn(Flat) -> Flat) -> [f64; 3] {
    let off = |p: Flat, q: Flat| (p - seen(q)).norm();
    let base =
        [off(a.path.base, b.path.base), off(a.path.exterior, b.path.exterior), off(a.path.interior, b.path.interior)];
    assert_eq!(a.path.levels.len(), b.path.levels.len());
    let levels = a.path.levels.iter().zip(&b.path.levels);
    let ends =
        levels.clone().flat_map(|(p, q)| [off(p.exterior_end, q.exterior_end), off(p.interior_end, q.interior_end)]);
    let heights = levels.map(|(p, q)| (p.height_mm - q.height_mm).abs());
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    [largest(&mut base.into_iter()), largest(&mut ends.into_iter()), largest(&mut heights.into_iter())]
}

/// Plan along the blade's axis from the better edge.
fn along_blade(rotor: &Twisted, turn_rad: f64) -> SlotPlan {
    let (blisk, slot) = rotor.slot(turn_rad);
    let (ring, roughing) = (ring(), roughing());
    Problem::new(&blisk, &slot, &ring, &roughing).unwrap().along(AxisChoice::Blade).unwrap().plan
}

/// The plans of the rotors as they are, made once for both tests.
fn plans() -> &'static [SlotPlan] {
    static PLANS: OnceLock<Vec<SlotPlan>> = OnceLock::new();
    PLANS.get_or_init(|| ROTORS.iter().map(|rotor| along_blade(rotor, 0.0)).collect())
}

#[test]
fn another_numbering_of_the_blades_changes_nothing() {
    for (rotor, first) in ROTORS.into_iter().zip(plans()) {
        let other = along_blade(&rotor, 5.0 * core::f64::consts::TAU / 19.0);
        let [places_mm, ends_mm, heights_mm] = differences_mm(first, &other, |place| place);
        println!("{}: A, B1, C {places_mm:.1e}, D, E {ends_mm:.1e}, heights {heights_mm:.1e} mm", rotor.name);
        assert!(places_mm < SAME_MM && ends_mm < SAME_MM && heights_mm < SAME_MM, "{}", rotor.name);
    }
}

#[test]
fn the_mirror_image_of_a_rotor_has_that_of_the_plan() {
    for (rotor, right) in ROTORS.into_iter().zip(plans()) {
        let left = along_blade(&Twisted { hand: -1.0, ..rotor }, 0.0);
        assert_ne!(right.path.outward == Turn::Cw, left.path.outward == Turn::Cw, "{}", rotor.name);
        let [places_mm, ends_mm, heights_mm] = differences_mm(right, &left, |place| Flat::new(-place.x, place.y));
        println!("{}: A, B1, C {places_mm:.1e}, D, E {ends_mm:.1e}, heights {heights_mm:.1e} mm", rotor.name);
        assert!(places_mm < SAME_MM && ends_mm < SAME_MM && heights_mm < SAME_MM, "{}", rotor.name);
    }
}

/// The rotor of a part with one thing changed that leaves its blades the same, and signs of the slot's x and y.
struct Variant {
    name: &'static str,
    change: fn(Sections) -> Sections,
    signs: [f64; 2],
}

pub fn moved(sections: &Sections, map: impl Fn(&Point) -> Point) -> Sections {
    let side = |side: &[Vec<Point>]| side.iter().map(|points| points.iter().map(&map).collect()).collect();
    Sections { pressure: side(&sections.pressure), suction: side(&sections.suction) }
}

fn reversed(mut sections: Sections) -> Sections {
    sections.pressure.iter_mut().chain(&mut sections.suction).for_each(|points| points.reverse());
    sections
}

fn turned(sections: Sections) -> Sections {
    let turn = Rotation3::from_axis_angle(&Vector::z_axis(), 7.0 * core::f64::consts::TAU / 19.0 + 0.1);
    moved(&sections, |point| turn * point)
}

/// The first one has another hand, another order of points and another first blade at once.
const VARIANTS: [Variant; 3] = [
    Variant {
        name: "mirrored in y, points reversed, turned by 7 pitches and 0.1 rad",
        change: |s| turned(reversed(moved(&s, |p| Point::new(p.x, -p.y, p.z)))),
        signs: [-1.0, 1.0],
    },
    Variant { name: "mirrored in z", change: |s| moved(&s, |p| Point::new(p.x, p.y, -p.z)), signs: [1.0, -1.0] },
    Variant {
        name: "upside down, points reversed",
        change: |s| reversed(moved(&s, |p| Point::new(p.x, -p.y, -p.z))),
        signs: [-1.0, -1.0],
    },
];

#[test]
fn the_best_plan_does_not_depend_on_the_order_of_points_the_first_blade_or_the_hand() {
    let tool = published_tool();
    let best = |sections: &Sections| {
        let blisk = published_rotor::rotor(sections);
        let slot = blisk.slot();
        Problem::new(&blisk, &slot, &tool, &ROUGHING).unwrap().best(|_| true).unwrap()
    };
    let first = &ranked()[0];
    for Variant { name, change, signs } in of_full_set(&VARIANTS[..], &VARIANTS[..1]) {
        let other = best(&change(published_rotor::sections()));
        let seen = |place: Flat| Flat::new(signs[0] * place.x, signs[1] * place.y);
        let [places_mm, ends_mm, heights_mm] = differences_mm(&first.plan, &other.plan, seen);
        println!("{name}: A, B1, C {places_mm:.1e}, D, E {ends_mm:.1e}, heights {heights_mm:.1e} mm");
        assert!(places_mm < SAME_MM && ends_mm < SAME_MM && heights_mm < SAME_MM, "{name}");
        assert!((first.share_ratio - other.share_ratio).abs() < 1e-9, "{name}");
    }
}
