//! The generator against an independent one's file, the surface through sections against the generator, and mirror images.

use arcfeed_plan::geometry::blade::{Sections, length_mm};
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::geometry::generator::{Hand, Rotor, RotorError};
use arcfeed_plan::vector::Point;

use crate::published_rotor::{ROTOR, farthest_mm, sections};

#[test]
fn the_generator_makes_the_rotor_of_another_program() {
    let (ours, theirs) = (ROTOR.sections(9, 81).unwrap(), sections());
    let pressure_mm = farthest_mm(&ours.pressure, &theirs.pressure);
    let suction_mm = farthest_mm(&ours.suction, &theirs.suction);
    println!("1458 points: at most {pressure_mm:.1e} mm off on the pressure, {suction_mm:.1e} mm on the suction side");
    // The file has six decimals.
    assert!(pressure_mm < 1e-6 && suction_mm < 1e-6);
}

/// Distance of a point from a face, by ever finer search about the place it should be at.
fn distance_mm(face: &Face, point: &Point, [mut u, mut v]: [f64; 2]) -> f64 {
    let mut least = f64::INFINITY;
    let mut step = 0.01;
    while step > 1e-8 {
        let around = (-3..=3).flat_map(|i| (-3..=3).map(move |j| [i, j]));
        let places = around.map(|[i, j]| [u + step * f64::from(i), v + step * f64::from(j)]);
        let found = places.map(|[u, v]| ((face.point(u, v) - point).norm(), [u, v]));
        let found = found.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        (least, [u, v]) = found;
        step *= 0.6;
    }
    least
}

#[test]
fn the_surface_between_its_sections_is_the_rotor() {
    // Every second section, so that the others lie between.
    let every = |side: &[Vec<Point>]| side.iter().step_by(2).cloned().collect::<Vec<_>>();
    let fine = ROTOR.sections(9, 161).unwrap();
    let coarse = ROTOR.sections(9, 81).unwrap();
    let faces = coarse.faces().unwrap();
    let sparse = Sections { pressure: every(&coarse.pressure), suction: every(&coarse.suction) }.faces().unwrap();
    for (name, faces, rows) in [("9 sections", &faces, 0..9), ("5 sections", &sparse, 0..9)] {
        for (side, face, points) in [("pressure", &faces[0], &fine.pressure), ("suction", &faces[1], &fine.suction)] {
            let (mut worst_mm, mut away_mm) = (0.0_f64, 0.0_f64);
            for row in rows.clone() {
                let whole_mm = length_mm(&points[row]);
                for at in 0..161 {
                    let u = length_mm(&points[row][..=at]) / whole_mm;
                    let off_mm = distance_mm(face, &points[row][at], [u, row as f64 / 8.0]);
                    worst_mm = worst_mm.max(off_mm);
                    if (4..157).contains(&at) {
                        away_mm = away_mm.max(off_mm);
                    }
                }
            }
            println!("{name}, {side}: {worst_mm:.4} mm off at most, {away_mm:.4} mm off its outermost points");
            assert!(worst_mm < 0.01, "{name}, {side}: {worst_mm}");
        }
    }
}

#[test]
fn a_left_rotor_is_the_mirror_image_of_a_right_one() {
    let left = Rotor { hand: Hand::Left, lean_deg: 5.0, ..ROTOR }.sections(3, 21).unwrap();
    let right = Rotor { lean_deg: 5.0, ..ROTOR }.sections(3, 21).unwrap();
    let mirrored = |side: &[Vec<Point>]| -> Vec<Vec<Point>> {
        side.iter().map(|points| points.iter().map(|p| Point::new(p.x, -p.y, p.z)).collect()).collect()
    };
    assert!(farthest_mm(&left.pressure, &mirrored(&right.pressure)) < 1e-12);
    assert!(farthest_mm(&left.suction, &mirrored(&right.suction)) < 1e-12);
}

#[test]
fn a_leaning_blade_is_moved_along_the_circumference_by_the_tangent_of_its_lean() {
    let [upright, leaning] = [0.0, 10.0].map(|lean_deg| Rotor { lean_deg, ..ROTOR }.sections(2, 5).unwrap());
    let angle = |blade: &Sections| libm::atan2(blade.pressure[1][2].y, blade.pressure[1][2].x);
    let moved_mm = (angle(&leaning) - angle(&upright)) * 98.6;
    assert!((moved_mm - 28.6 * libm::tan(10.0_f64.to_radians())).abs() < 1e-9, "{moved_mm}");
    assert!(farthest_mm(&upright.pressure[..1], &leaning.pressure[..1]) < 1e-12);
}

#[test]
fn an_edge_has_the_given_thickness_and_the_middle_stays() {
    let blunt = Rotor { edge_mm: 0.5, ..ROTOR }.sections(2, 801).unwrap();
    let sharp = ROTOR.sections(2, 801).unwrap();
    let thickness_mm = |blade: &Sections, at: usize| (blade.pressure[0][at] - blade.suction[0][at]).norm();
    // 0.25 mm and more from the trailing edge.
    let at = (0..801).rfind(|i| (sharp.pressure[0][*i] - sharp.pressure[0][800]).norm() > 0.26).unwrap();
    assert!(thickness_mm(&sharp, at) < 0.05 && (thickness_mm(&blunt, at) - 0.5).abs() < 1e-3);
    assert!(thickness_mm(&blunt, 800) < 1e-12);
    assert!((thickness_mm(&blunt, 400) - thickness_mm(&sharp, 400)).abs() < 1e-12);
}

#[test]
fn numbers_that_make_no_rotor_are_refused_by_name() {
    let refused = |rotor: Rotor| rotor.sections(2, 5).unwrap_err();
    assert_eq!(refused(Rotor { blades: 1, ..ROTOR }), RotorError::Blades(1));
    assert!(matches!(refused(Rotor { tip_radius_mm: 60.0, ..ROTOR }), RotorError::Radii { .. }));
    assert!(matches!(refused(Rotor { hub_radius_mm: f64::NAN, ..ROTOR }), RotorError::Radii { .. }));
    assert!(matches!(
        refused(Rotor { stagger_deg: [28.0, 90.0], ..ROTOR }),
        RotorError::Range { name: "stagger_deg", .. }
    ));
    assert!(matches!(refused(Rotor { camber_deg: [0.0, 3.0], ..ROTOR }), RotorError::Range { name: "camber_deg", .. }));
    assert!(matches!(refused(Rotor { edge_mm: 1.5, ..ROTOR }), RotorError::Edge { .. }));
}
