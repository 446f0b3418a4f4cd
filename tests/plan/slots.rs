//! The slot between two blades, against the distances that an independent program printed, and for rotors of both hands.

use arcfeed_plan::geometry::blade::Sections;
use arcfeed_plan::geometry::generator::{Hand, Rotor};

use crate::published_rotor::{GAPS_MM, ROTOR, blisk, rotor};

/// A section of the unrolled cylinder: arc from zero angle, and place along the axis.
fn unrolled(face: &arcfeed_plan::geometry::face::Face, v: f64) -> Vec<[f64; 2]> {
    let points = (0..=400).map(|i| face.point(f64::from(i) / 400.0, v));
    points.map(|p| [libm::atan2(p.y, p.x) * libm::hypot(p.x, p.y), p.z]).collect()
}

#[test]
fn the_sides_of_a_slot_are_as_far_apart_as_that_program_says() {
    let slot = blisk().slot();
    for (span, gap_mm) in GAPS_MM {
        let (one, other) = (unrolled(&slot.pressure, span), unrolled(&slot.suction, span));
        let distances = one.iter().flat_map(|a| other.iter().map(move |b| libm::hypot(a[0] - b[0], a[1] - b[1])));
        let found_mm = distances.fold(f64::INFINITY, f64::min);
        println!("span {span}: {found_mm:.4} mm, printed {gap_mm:.4}");
        assert!((found_mm - gap_mm).abs() < 0.01, "span {span}: {found_mm} for {gap_mm}");
    }
}

#[test]
fn both_sides_of_a_slot_look_into_it_on_rotors_of_both_hands() {
    for hand in [Hand::Right, Hand::Left] {
        for stagger_deg in [[28.0, 42.0], [-28.0, -42.0]] {
            let made = Rotor { hand, stagger_deg, ..ROTOR };
            let blisk = rotor(&made.sections(9, 41).unwrap());
            let slot = blisk.slot();
            for u in [0.2, 0.5, 0.8] {
                for v in [0.0, 0.5, 1.0] {
                    let across = slot.suction.point(u, v) - slot.pressure.point(u, v);
                    assert!(across.dot(&slot.pressure.normal(u, v)) > 0.0, "{hand:?} {stagger_deg:?} {u} {v}");
                    assert!(across.dot(&slot.suction.normal(u, v)) < 0.0, "{hand:?} {stagger_deg:?} {u} {v}");
                }
            }
            let wanted = if hand == Hand::Right { 1 } else { -1 };
            assert_eq!(blisk.facing(), wanted, "{stagger_deg:?}");
        }
    }
}

#[test]
fn blades_are_the_first_one_turned() {
    let blisk = blisk();
    let blades: Vec<_> = blisk.blades().collect();
    assert_eq!(blades.len(), 19);
    let (first, fifth) = (blisk.pressure.point(0.3, 0.6), blades[5].pressure.point(0.3, 0.6));
    let angle = libm::atan2(fifth.y, fifth.x) - libm::atan2(first.y, first.x);
    assert!((angle - 5.0 * core::f64::consts::TAU / 19.0).abs() < 1e-12 && (first.z - fifth.z).abs() < 1e-12);
}

#[test]
fn the_suction_side_is_the_longer_one() {
    let sections = ROTOR.sections(9, 81).unwrap();
    let bulge_mm = sections.bulge_mm();
    assert!(bulge_mm > 1.0, "{bulge_mm}");
    assert!((Sections::swapped(sections).bulge_mm() + bulge_mm).abs() < 1e-12);
}
