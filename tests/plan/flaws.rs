//! Rotors that cannot be planned: every flaw is found on a rotor that was made to have it, with where and how much in closed form.

use arcfeed_plan::geometry::blade::Sections;
use arcfeed_plan::geometry::blisk::{Blank, Blisk};
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::geometry::flaws::{BladeSide, Flaw, flaws, hollowness_per_mm, nearest};
use arcfeed_plan::geometry::generator::Rotor;
use arcfeed_plan::vector::{Point, Vector};

use crate::published_rotor::{ROTOR, blisk, rotor};

/// The published allowance, 0.035 in.
const ALLOWANCE_MM: f64 = 0.889;

fn found(blisk: &Blisk) -> Vec<Flaw> {
    let found = flaws(blisk, ALLOWANCE_MM);
    found.iter().for_each(|flaw| println!("{flaw}"));
    found
}

#[test]
fn the_published_rotor_has_no_flaw() {
    let blisk = blisk();
    for (name, face) in [("pressure", &blisk.pressure), ("suction", &blisk.suction)] {
        let places = (0..=200).flat_map(|i| (0..=20).map(move |j| [f64::from(i) / 200.0, f64::from(j) / 20.0]));
        let hollow = |[u, v]: [f64; 2]| hollowness_per_mm(face, u, v);
        let worst = places.max_by(|a, b| hollow(*a).total_cmp(&hollow(*b))).unwrap();
        println!("{name}: least hollow radius {:.2} mm at {worst:?}", 1.0 / hollow(worst));
    }
    assert_eq!(found(&blisk), []);
}

#[test]
fn a_cylinders_inside_is_as_hollow_as_its_radius_says() {
    for (radius_mm, span_mm) in [(0.8, 5.0), (30.0, 20.0)] {
        let section = |z: f64| -> Vec<Point> {
            let at = |i: u32| libm::sincos(0.5 + f64::from(i) / 40.0);
            (0..=40).map(|i| Point::new(radius_mm * at(i).0, radius_mm * at(i).1, z)).collect()
        };
        let sections: Vec<Vec<Point>> = (0..5).map(|j| section(span_mm * f64::from(j) / 4.0)).collect();
        let middle = sections[2][20].coords;
        let inwards = Face::through(&sections, -Vector::new(middle.x, middle.y, 0.0)).unwrap();
        let outwards = Face::through(&sections, Vector::new(middle.x, middle.y, 0.0)).unwrap();
        for (u, v) in [(0.3, 0.2), (0.5, 0.5), (0.9, 0.7)] {
            assert!((hollowness_per_mm(&inwards, u, v) * radius_mm - 1.0).abs() < 1e-4);
            assert!(hollowness_per_mm(&outwards, u, v).abs() * radius_mm < 1e-4);
        }
    }
}

#[test]
fn a_groove_narrower_than_the_allowance_folds_its_offset() {
    // A plate with a groove of cosine shape in one side: f = -h (1 + cos(2 pi z / l)) / 2 has f'' = 2 pi^2 h / l^2 at its ground.
    let (depth_mm, length_mm) = (0.6, 3.0);
    let groove = |z: f64| -> f64 {
        let cos = libm::cos(core::f64::consts::TAU * z / length_mm);
        if z.abs() < length_mm / 2.0 { depth_mm * (1.0 + cos) / 2.0 } else { 0.0 }
    };
    let section = |x: f64, y: &dyn Fn(f64) -> f64| -> Vec<Point> {
        let z = |i: u32| -10.0 + f64::from(i) / 10.0;
        (0..=200).map(|i| Point::new(x, y(z(i)), z(i))).collect()
    };
    let radii = [70.0, 75.0, 80.0, 85.0, 90.0];
    let plate = Sections {
        pressure: radii.map(|x| section(x, &|z| 1.0 - groove(z))).to_vec(),
        suction: radii.map(|x| section(x, &|_| -1.0)).to_vec(),
    };
    let expected_mm = length_mm * length_mm / (2.0 * core::f64::consts::PI * core::f64::consts::PI * depth_mm);
    let found = found(&rotor(&plate));
    let [Flaw::Folded { side: BladeSide::Pressure, at: [u, _], radius_mm, .. }] = found[..] else {
        panic!("{found:?}")
    };
    println!("radius {radius_mm:.4} mm, in closed form {expected_mm:.4} mm");
    assert!((u - 0.5).abs() < 0.01 && (radius_mm / expected_mm - 1.0).abs() < 0.02);
    assert!(flaws(&rotor(&plate), radius_mm * 0.99).is_empty());
}

#[test]
fn blades_too_near_are_found_with_their_gap() {
    let crowded = Rotor { blades: 110, ..ROTOR };
    let blisk = Blisk { blades: 110, ..blisk() };
    let slot = blisk.slot();
    // Brute force on points of the generator.
    let fine = crowded.sections(9, 401).unwrap();
    let turn = nalgebra::Rotation3::from_axis_angle(&Vector::z_axis(), blisk.pitch_rad());
    let gaps = fine.pressure.iter().flatten().flat_map(|p| fine.suction[0].iter().map(move |s| (turn * s - p).norm()));
    let gap_mm = gaps.fold(f64::INFINITY, f64::min);
    let found = found(&blisk);
    let [Flaw::Near { gap_mm: ours_mm, needed_mm, at: [_, v] }] = found[..] else { panic!("{found:?}") };
    println!("{ours_mm:.4} mm, by brute force {gap_mm:.4} mm");
    assert!((ours_mm - gap_mm).abs() < 0.01 && needed_mm == 2.0 * ALLOWANCE_MM && v < 0.05);
    assert_eq!(nearest(&slot.pressure, &slot.suction).1, ours_mm);
}

#[test]
fn a_blade_that_ends_above_the_hub_is_found() {
    let mut blisk = blisk();
    blisk.hub.profile_mm.iter_mut().for_each(|place| place[1] -= 0.5);
    for flaw in found(&blisk) {
        assert!(matches!(flaw, Flaw::Floating { height_mm, .. } if (height_mm - 0.5).abs() < 1e-4));
    }
    assert_eq!(flaws(&blisk, ALLOWANCE_MM).len(), 2);
}

#[test]
fn a_blank_too_small_or_too_narrow_is_found() {
    let small = Blisk { blank: Blank { radius_mm: 98.0, faces_mm: [-15.0, 15.0] }, ..blisk() };
    for flaw in found(&small) {
        assert!(matches!(flaw, Flaw::AboveBlank { by_mm, at: [_, 1.0], .. } if (by_mm - 0.6).abs() < 0.001));
    }
    // The blade reaches 11.478 mm from its middle along the axis.
    let narrow = Blisk { blank: Blank { radius_mm: 100.0, faces_mm: [-11.0, 15.0] }, ..blisk() };
    let found = found(&narrow);
    assert!(!found.is_empty() && flaws(&small, ALLOWANCE_MM).len() == 2);
    for flaw in found {
        assert!(
            matches!(flaw, Flaw::BesideBlank { by_mm, at: [u, 0.0], .. } if (by_mm - 0.48).abs() < 0.02 && u < 0.05)
        );
    }
}

#[test]
fn sections_and_sides_that_cross_are_found() {
    let good = ROTOR.sections(9, 81).unwrap();
    let mut bent = good.clone();
    // The fifth section's trailing part lies on the cylinder of the fourth one's height and below.
    for side in [&mut bent.pressure, &mut bent.suction] {
        for at in 60..81 {
            let share = f64::from(at - 60) / 20.0 * 0.08;
            let point = side[4][at as usize];
            side[4][at as usize] = Point::new(point.x * (1.0 - share), point.y * (1.0 - share), point.z);
        }
    }
    let crossed = flaws(&rotor(&bent), 0.1);
    assert!(
        crossed.iter().any(|flaw| matches!(flaw, Flaw::Crossed { at: [1.0, _], back_mm, .. } if *back_mm > 1.0)),
        "{crossed:?}"
    );
    // Points of the suction side moved through the pressure side.
    let through = |side: &[Vec<Point>], by_mm: f64| -> Vec<Vec<Point>> {
        let moved = |(row, points): (usize, &Vec<Point>)| {
            let bump = |at: usize| libm::exp(-libm::pow((at as f64 - 40.0) / 8.0, 2.0));
            let across = (good.pressure[row][40] - good.suction[row][40]).normalize();
            points.iter().enumerate().map(|(at, point)| point + across * (by_mm * bump(at))).collect()
        };
        side.iter().enumerate().map(moved).collect()
    };
    let inside_out = Sections { pressure: good.pressure.clone(), suction: through(&good.suction, 4.0) };
    let thickness_mm = (good.pressure[8][40] - good.suction[8][40]).norm();
    let found = flaws(&rotor(&inside_out), 0.1);
    let by =
        found.iter().find_map(|flaw| if let Flaw::InsideOut { by_mm, at } = flaw { Some((*by_mm, *at)) } else { None });
    let (by_mm, [_, v]) = by.unwrap();
    println!("sides cross by {by_mm:.3} mm, expected {:.3} mm", 4.0 - thickness_mm);
    assert!((by_mm - (4.0 - thickness_mm)).abs() < 0.1 && v == 1.0);
}
