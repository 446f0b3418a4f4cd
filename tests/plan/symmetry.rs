//! Changes of the input that leave a plan unchanged, and changes that mirror it.

use arcfeed_nc::modal::Turn;
use arcfeed_plan::cup_mill::plan::{SlotPlan, plan};
use arcfeed_plan::vector::Flat;

use crate::twisted::{ROTORS, Twisted, ring, roughing};

/// Largest differences of two plans, the second one's places as `seen`: of places and heights, mm.
fn differences_mm(a: &SlotPlan, b: &SlotPlan, seen: impl Fn(Flat) -> Flat) -> [f64; 3] {
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

#[test]
fn another_numbering_of_the_blades_changes_nothing() {
    for rotor in ROTORS {
        let first = rotor.plan();
        let pitch_rad = core::f64::consts::TAU / 19.0;
        let (blisk, slot) = rotor.slot(5.0 * pitch_rad);
        let other = plan(&blisk, &slot, &ring(), &roughing()).unwrap();
        let [places_mm, ends_mm, heights_mm] = differences_mm(&first, &other, |place| place);
        println!("{}: A, B1, C {places_mm:.1e}, D, E {ends_mm:.1e}, heights {heights_mm:.1e} mm", rotor.name);
        assert!(places_mm < 1e-4 && ends_mm < 1e-4 && heights_mm < 1e-6, "{}", rotor.name);
    }
}

#[test]
fn the_mirror_image_of_a_rotor_has_that_of_the_plan() {
    for rotor in ROTORS {
        let right = rotor.plan();
        let left = Twisted { hand: -1.0, ..rotor }.plan();
        assert_ne!(right.path.outward == Turn::Cw, left.path.outward == Turn::Cw, "{}", rotor.name);
        let [places_mm, ends_mm, heights_mm] = differences_mm(&right, &left, |place| Flat::new(-place.x, place.y));
        println!("{}: A, B1, C {places_mm:.1e}, D, E {ends_mm:.1e}, heights {heights_mm:.1e} mm", rotor.name);
        assert!(places_mm < 1e-4 && ends_mm < 1e-4 && heights_mm < 1e-6, "{}", rotor.name);
    }
}
