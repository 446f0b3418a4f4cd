//! Repairs against programs of others: trimesh, libigl, opencamlib and Open3D of the Python Package Index.

use std::io::Write;
use std::process::Stdio;

use arcfeed_plan::finish::contact::Contact;
use arcfeed_plan::finish::mill::FinishMill;
use arcfeed_plan::geometry::surface::Surface;
use arcfeed_plan::repair::registration::fit;
use arcfeed_plan::repair::scan::NominalSurface;
use arcfeed_plan::vector::{Point, Vector};
use arcfeed_tests::python::python_with;
use arcfeed_tests::{root, skip_loudly};
use serde_json::{Value, json};

use super::nearest::curvature_per_mm;
use super::registration::{settings, sheet_foot};
use super::surfaces::{Plain, Sheet};
use crate::plunge::table::rows;

/// Answer of the script; `None`, loudly, without the packages.
fn answer(test: &str, modules: &str, question: &str, numbers: &Value) -> Option<Value> {
    let Some(mut script) = python_with(modules) else {
        skip_loudly(
            test,
            &format!(
                "no Python with {modules} (`cargo xtask test` installs them where there are wheels for this Python)"
            ),
        );
        return None;
    };
    script.arg(root().join("tests/plan/repair/peers.py")).arg(question);
    let mut child = script.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("Python starts");
    child.stdin.take().expect("an input").write_all(numbers.to_string().as_bytes()).expect("the script reads");
    let output = child.wait_with_output().expect("Python ends");
    assert!(output.status.success(), "{question}");
    Some(serde_json::from_slice(&output.stdout).expect("JSON"))
}

fn numbers(answer: &Value) -> Vec<f64> {
    answer.as_array().expect("a list").iter().map(|value| value.as_f64().expect("a number")).collect()
}

/// Corners and triangles of a surface over its ranges, and the largest distance of the triangles from it.
fn mesh(surface: &impl Surface, count: usize) -> (Vec<[f64; 3]>, Vec<[usize; 3]>, f64) {
    let place = |i: usize, j: usize| {
        let share = |k: usize, [from, to]: [f64; 2]| from + (to - from) * k as f64 / count as f64;
        let [u, v] = surface.ranges();
        [share(i, u), share(j, v)]
    };
    let at = |i: usize, j: usize| surface.jet(place(i, j)).point;
    let index = |i: usize, j: usize| i * (count + 1) + j;
    let (mut corners, mut faces, mut chord_mm) = (Vec::new(), Vec::new(), 0.0_f64);
    for i in 0..=count {
        for j in 0..=count {
            corners.push(<[f64; 3]>::from(at(i, j)));
            if i < count && j < count {
                faces.extend([
                    [index(i, j), index(i + 1, j), index(i, j + 1)],
                    [index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)],
                ]);
                let sides = [at(i, j) - at(i + 1, j + 1), at(i + 1, j) - at(i, j + 1)].map(|side| side.norm_squared());
                // An arc over the longest side.
                chord_mm = chord_mm.max(sides[0].max(sides[1]) * curvature_per_mm(surface, place(i, j)) / 8.0);
            }
        }
    }
    (corners, faces, chord_mm)
}

/// Points up to 2 mm off the sheet on either side.
fn about_the_sheet(seed: u64) -> Vec<Point> {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut point = || {
        let (on, normal) = Sheet.point_and_normal([0.1 + 0.8 * random.f64(), 0.1 + 0.8 * random.f64()]);
        on + normal * (4.0 * random.f64() - 2.0)
    };
    (0..500).map(|_| point()).collect()
}

/// Distances from the sheet's mesh by a question to the script, and the depth of the mesh's chords.
fn by_mesh(test: &str, modules: &str, question: &str, points: &[Point]) -> Option<(Vec<f64>, f64)> {
    let (vertices, faces, chord_mm) = mesh(&Sheet, 120);
    let points: Vec<[f64; 3]> = points.iter().map(|point| (*point).into()).collect();
    let given = json!({ "vertices": vertices, "faces": faces, "points": points });
    Some((numbers(&answer(test, modules, question, &given)?), chord_mm))
}

/// Point 8 of the method's list: trimesh.
#[test]
fn point_8_nearest_points_are_those_of_trimesh_to_the_chords_of_its_mesh() {
    let name = "point_8_nearest_points_are_those_of_trimesh_to_the_chords_of_its_mesh";
    let points = about_the_sheet(8);
    let Some((found, chord_mm)) = by_mesh(name, "numpy, trimesh, rtree, scipy", "nearest", &points) else { return };
    let off = points
        .iter()
        .zip(found)
        .map(|(point, by_mesh_mm)| ((sheet_foot(point).point - point).norm() - by_mesh_mm).abs());
    let worst_mm = off.fold(0.0, f64::max);
    println!("500 distances: {worst_mm:.1e} mm off those from the mesh, whose chords are {chord_mm:.1e} mm deep");
    assert!(worst_mm <= chord_mm && chord_mm < 0.01, "{worst_mm} {chord_mm}");
}

/// Point 8 of the method's list: libigl.
#[test]
fn point_8_heights_have_the_signs_and_values_of_libigl() {
    let name = "point_8_heights_have_the_signs_and_values_of_libigl";
    let points = about_the_sheet(10);
    let Some((found, chord_mm)) = by_mesh(name, "numpy, igl", "signed", &points) else { return };
    let heights = NominalSurface::new(Sheet).heights(&points, 0.0);
    assert_eq!(heights.len(), found.len());
    // The triangles run as u x v does, against which the sheet faces.
    let off = heights.iter().zip(&found).map(|(sample, by_mesh_mm)| (sample.height_mm + by_mesh_mm).abs());
    let worst_mm = off.fold(0.0, f64::max);
    let below = heights.iter().filter(|sample| sample.height_mm < 0.0).count();
    println!("500 heights, {below} of them below: {worst_mm:.1e} mm off, chords {chord_mm:.1e} mm deep");
    assert!(worst_mm <= chord_mm && (200..300).contains(&below), "{worst_mm} {below}");
}

/// Point 8 of the method's list: opencamlib, an upright ball on a blade that lies.
#[test]
fn point_8_balls_on_a_lying_blade_are_where_opencamlib_drops_them() {
    let radius_mm = 4.0;
    let mill = FinishMill {
        radius_mm,
        corner_radius_mm: radius_mm,
        length_mm: 20.0,
        neck_mm: Vec::new(),
        holder_mm: Vec::new(),
        teeth: 2,
    };
    let blade = Plain::Cylinder(30.0);
    // The cylinder's axis along y, its top upwards.
    let lying = |point: Vector| Vector::new(-point.y, point.z * 10.0, point.x - 30.0);
    let (vertices, faces, chord_mm) = mesh(&blade, 200);
    let vertices: Vec<[f64; 3]> = vertices.iter().map(|corner| lying(Vector::from(*corner)).into()).collect();
    let mut random = fastrand::Rng::with_seed(9);
    let tips: Vec<Point> = (0..300)
        .map(|_| {
            let angle = 1.2 * random.f64() - 0.6;
            let jet = blade.jet([angle, 0.8 * random.f64() - 0.4]);
            let normal = Vector::new(jet.point.x, jet.point.y, 0.0).normalize();
            let contact = Contact {
                point: Point::from(lying(jet.point.coords)),
                normal: Vector::new(-normal.y, 0.0, normal.x),
                feed: Vector::y(),
            };
            mill.at(&contact, Vector::z()).tip
        })
        .collect();
    let places: Vec<[f64; 2]> = tips.iter().map(|tip| [tip.x, tip.y]).collect();
    let name = "point_8_balls_on_a_lying_blade_are_where_opencamlib_drops_them";
    let question = json!({ "vertices": vertices, "faces": faces, "points": places, "radius": radius_mm });
    let Some(answer) = answer(name, "numpy, opencamlib", "drops", &question) else { return };
    let off = tips.iter().zip(numbers(&answer)).map(|(tip, dropped_mm)| (tip.z - dropped_mm).abs());
    let worst_mm = off.fold(0.0, f64::max);
    // A ball beside the top sinks by more than the chord's depth.
    let most_mm = 1.3 * chord_mm;
    println!("300 balls: {worst_mm:.1e} mm off, chords {chord_mm:.1e} mm deep");
    assert!(worst_mm <= most_mm && chord_mm < 0.01, "{worst_mm} {chord_mm}");
}

/// Point 8 of the method's list: Open3D, the same points and weights.
#[test]
fn point_8_where_registration_ends_the_point_to_plane_step_of_open3d_is_none() {
    let name = "point_8_where_registration_ends_the_point_to_plane_step_of_open3d_is_none";
    let points: Vec<Point> = rows(include_str!("data/feng_registration_points.csv"))
        .iter()
        .filter(|row| row.word("case") == "g7")
        .map(|row| Point::from(row.numbers(["x_mm", "y_mm", "z_mm"])))
        .collect();
    let found = fit(&points, &settings([true; 6]), sheet_foot).unwrap();
    let step = |points: &[Point]| {
        let feet: Vec<_> = points.iter().map(sheet_foot).collect();
        let lists = |of: &dyn Fn(usize) -> [f64; 3]| (0..points.len()).map(of).collect::<Vec<_>>();
        let question = json!({
            "points": lists(&|k| points[k].into()),
            "feet": lists(&|k| feet[k].point.into()),
            "normals": lists(&|k| feet[k].normal.into()),
        });
        let answer = answer(name, "numpy, open3d", "step", &question)?;
        let rows: Vec<Vec<f64>> = answer.as_array().expect("rows").iter().map(numbers).collect();
        let moved = |point: &Point| {
            let row = |k: usize| (0..3).map(|j| rows[k][j] * point[j]).sum::<f64>() + rows[k][3];
            (Point::new(row(0), row(1), row(2)) - point).norm()
        };
        Some(points.iter().map(moved).fold(0.0, f64::max))
    };
    let moved: Vec<Point> = points.iter().map(|point| found.motion.moved(point)).collect();
    let Some([before_mm, after_mm]) = step(&points).zip(step(&moved)).map(<[f64; 2]>::from) else { return };
    println!("step of Open3D: {before_mm:.4} mm before the registration, {after_mm:.1e} mm behind it");
    assert!(before_mm > 0.01 && after_mm < 1e-6, "{before_mm} {after_mm}");
}
