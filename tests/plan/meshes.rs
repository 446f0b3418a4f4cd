//! Meshes: closed, outwards, within their tolerance, and as large as closed forms say.

use std::collections::HashMap;

use arcfeed_plan::geometry::blisk::Revolution;
use arcfeed_plan::geometry::mesh::{self, Sector, Triangle};
use arcfeed_plan::vector::Point;

use crate::published_rotor::{blisk, sections};

const SECTOR: Sector = Sector { angles_rad: [-0.4, 0.5], faces_mm: [-15.0, 15.0], inner_radius_mm: 60.0 };

/// Edges that are not passed once in each direction.
fn open_edges(triangles: &[Triangle]) -> usize {
    let key = |p: &Point| [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
    let mut balance: HashMap<[[u64; 3]; 2], i32> = HashMap::new();
    for [a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (from, to) = (key(from), key(to));
            let (edge, sense) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
            *balance.entry(edge).or_default() += sense;
        }
    }
    balance.values().filter(|balance| **balance != 0).count()
}

#[test]
fn a_face_is_met_within_the_tolerance() {
    let blisk = blisk();
    for tolerance_mm in [0.1, 0.02] {
        for face in [&blisk.pressure, &blisk.suction] {
            let triangles = mesh::face(face, tolerance_mm);
            // Every point of the face lies within the tolerance of a triangle: looked at from the face, so that no
            // parameter of the mesh is used.
            let mut worst_mm = 0.0_f64;
            for i in 0..40 {
                for j in 0..20 {
                    let point = face.point((f64::from(i) + 0.37) / 40.0, (f64::from(j) + 0.53) / 20.0);
                    let off_mm = triangles.iter().map(|t| distance_mm(&point, t)).fold(f64::INFINITY, f64::min);
                    worst_mm = worst_mm.max(off_mm);
                }
            }
            println!("{tolerance_mm} mm: {} triangles, at most {worst_mm:.4} mm off", triangles.len());
            assert!(worst_mm < tolerance_mm, "{worst_mm}");
            let outward = |t: &Triangle| (t[1] - t[0]).cross(&(t[2] - t[0])).dot(&face.normal(0.5, 0.5)) > 0.0;
            assert!(triangles.iter().filter(|t| outward(t)).count() * 10 > triangles.len() * 9);
        }
    }
}

/// From a point to the triangle's nearest point.
fn distance_mm(point: &Point, [a, b, c]: &Triangle) -> f64 {
    let normal = (b - a).cross(&(c - a));
    let inside = [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (*q - *p).cross(&(point - *p)).dot(&normal) >= 0.0);
    if inside {
        return ((point - a).dot(&normal) / normal.norm()).abs();
    }
    let beside = |(p, q): (&Point, &Point)| {
        let along = q - p;
        let share = ((point - p).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (point - (p + along * share)).norm()
    };
    [(a, b), (b, c), (c, a)].map(beside).into_iter().fold(f64::INFINITY, f64::min)
}

#[test]
fn a_blade_is_a_closed_solid_as_large_as_its_profiles() {
    let blisk = blisk();
    let triangles = mesh::blade(&blisk.blade(0), 0.0, 0.01);
    assert_eq!(open_edges(&triangles), 0);
    let volume_mm3 = mesh::volume_mm3(&triangles);
    // The other program's sections, unrolled: areas by the shoelace formula, linear in the thickness and so in the span.
    let areas = sections();
    let area_mm2 = |row: usize| {
        let ring: Vec<Point> = areas.pressure[row].iter().chain(areas.suction[row].iter().rev()).copied().collect();
        let flat = |p: &Point| [libm::atan2(p.y, p.x) * libm::hypot(p.x, p.y), p.z];
        let next = ring.iter().cycle().skip(1);
        let pieces = ring.iter().zip(next).map(|(a, b)| (flat(a), flat(b)));
        pieces.map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>().abs() / 2.0
    };
    let expected_mm3 = 28.6 / 6.0 * (area_mm2(0) + 4.0 * area_mm2(4) + area_mm2(8));
    println!("a blade: {} triangles, {volume_mm3:.2} mm3; profiles {expected_mm3:.2} mm3", triangles.len());
    assert!((volume_mm3 / expected_mm3 - 1.0).abs() < 0.002);
}

#[test]
fn the_blanks_sector_has_its_volume() {
    let triangles = mesh::blank(&blisk(), &SECTOR, 0.001);
    assert_eq!(open_edges(&triangles), 0);
    let expected_mm3 = 0.9 / 2.0 * (100.0 * 100.0 - 60.0 * 60.0) * 30.0;
    let found_mm3 = mesh::volume_mm3(&triangles);
    println!("blank: {} triangles, {:.1e} of its volume off", triangles.len(), found_mm3 / expected_mm3 - 1.0);
    assert!((found_mm3 / expected_mm3 - 1.0).abs() < 1e-4);
}

#[test]
fn a_cone_is_revolved_with_its_volume_and_ends_where_the_sector_does() {
    let cone = Revolution { profile_mm: vec![[-10.0, 70.0], [10.0, 80.0]] };
    let triangles = mesh::revolved(&cone, &SECTOR, 0.001);
    assert_eq!(open_edges(&triangles), 0);
    let frustum = 20.0 / 3.0 * (70.0 * 70.0 + 70.0 * 80.0 + 80.0 * 80.0) + 5.0 * (70.0 * 70.0 + 80.0 * 80.0);
    let expected_mm3 = 0.45 * (frustum - 30.0 * 60.0 * 60.0);
    assert!((mesh::volume_mm3(&triangles) / expected_mm3 - 1.0).abs() < 1e-4);
    assert!(triangles.iter().flatten().all(|point| point.z.abs() < 15.0 + 1e-12));
}

#[test]
fn the_finished_part_is_closed() {
    let blisk = blisk();
    let triangles = mesh::finished(&blisk, &SECTOR, [0, 1], 0.02);
    assert_eq!(open_edges(&triangles), 0);
    println!("finished: {} triangles, {:.0} mm3", triangles.len(), mesh::volume_mm3(&triangles));
    let lowest_mm = triangles.iter().flatten().map(|p| libm::hypot(p.x, p.y)).fold(f64::INFINITY, f64::min);
    assert!((lowest_mm - 60.0).abs() < 1e-9);
}
