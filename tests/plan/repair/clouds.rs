//! Points that a planner must not use as they are, each with the sentence that says what to do. All of them are made from those of the examples.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use arcfeed_tests::{Scratch, root, run};

const EXAMPLE: &str = "examples/repaired-blade";

/// Named point of a table.
type Named = (String, [f64; 3]);

fn points(file: &str) -> Vec<Named> {
    let table = std::fs::read_to_string(root().join(EXAMPLE).join(file)).unwrap();
    let point = |line: &str| {
        let words: Vec<&str> = line.split(',').collect();
        (words[0].to_owned(), [1, 2, 3].map(|k: usize| words[k].parse().unwrap()))
    };
    table.lines().skip(2).map(point).collect()
}

/// Refusal of a repair of these points; `changes` are those of the repair file.
fn refusal(points: &[Named], changes: &[(&str, &str)]) -> String {
    static NUMBER: AtomicUsize = AtomicUsize::new(0);
    let scratch = Scratch::new(&format!("repair-clouds-{}", NUMBER.fetch_add(1, Ordering::Relaxed)));
    let line = |(name, [x, y, z]): &Named| format!("{name},{x:.5},{y:.5},{z:.5}\n");
    let table: String = points.iter().map(line).collect();
    scratch.write("points.csv", format!("side,x_mm,y_mm,z_mm\n{table}"));
    let text = std::fs::read_to_string(root().join(EXAMPLE).join("REPAIR.toml")).unwrap();
    let part = root().join("examples/finish-blisk/PART.toml").display().to_string();
    let mut text = text.replace("../finish-blisk/PART.toml", &part);
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let (file, folder) = (scratch.write("REPAIR.toml", text), scratch.path("out"));
    let output = run(&["plan", "repair", &file, "-o", &folder]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    println!("{}", said.lines().last().unwrap_or_default());
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(!Path::new(&folder).exists(), "{said}");
    said
}

fn check(points: &[Named], changes: &[(&str, &str)], wanted: &[&str]) {
    let said = refusal(points, changes);
    assert!(wanted.iter().all(|words| said.contains(words)), "{said}");
}

fn moved(points: &[Named], to: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<Named> {
    points.iter().map(|(name, point)| (name.clone(), to(*point))).collect()
}

fn without(points: &[Named], middle: [f64; 3], radius_mm: f64) -> Vec<Named> {
    let is_off = |(_, at): &&Named| (0..3).map(|k| (at[k] - middle[k]).powi(2)).sum::<f64>() > radius_mm * radius_mm;
    points.iter().filter(is_off).cloned().collect()
}

#[test]
fn clouds_of_something_else_are_refused_with_what_fits() {
    let good = points("points.csv");
    check(&moved(&good, |p| p.map(|c| c / 25.4)), &[], &["fit as inches read as millimetres", "set `units`"]);
    check(&moved(&good, |p| p.map(|c| c / 1000.0)), &[], &["fit as metres read as millimetres", "set `units`"]);
    check(&moved(&good, |[x, y, z]| [x, -y, z]), &[], &["mirror image in y fits", "`hand`"]);
    let (sin, cos) = libm::sincos(core::f64::consts::TAU / 19.0);
    let turned = moved(&good, |[x, y, z]| [x * cos - y * sin, x * sin + y * cos, z]);
    check(&turned, &[], &["fit blade 2", "set `blade`"]);
    check(
        &moved(&good, |[x, y, z]| [x + 30.0, y + 9.0, z - 20.0]),
        &[],
        &["21.4 mm off the blade", "give them in the part's frame"],
    );
}

#[test]
fn clouds_that_lack_something_are_refused_with_what_to_measure() {
    let good = points("points.csv");
    let pressure: Vec<Named> = good.iter().filter(|(name, _)| name == "PS").cloned().collect();
    let suction = ("\"pressure\"", "\"suction\"");
    check(&pressure, &[suction], &["0 of 3328 points lie on the suction side", "measure that side, or set `side`"]);
    let free = ("free = []", "free = [\"x\", \"y\", \"z\", \"omega_x\", \"omega_y\", \"omega_z\"]");
    check(&pressure, &[free], &["do not determine `x`", "measure both edges and the hub", "leaving it out of `free`"]);
    check(&good[..50], &[], &["50 of 50 points lie on the pressure side, and 100 at least are needed"]);
    // 3 mm about a place of the transition, and about one of the weld.
    let middles = [1800, 3000].map(|k: usize| pressure[k].1);
    for middle in middles {
        check(
            &without(&good, middle, 3.0),
            &[],
            &["lie in holes of the measurement, first about (", "measure there, or raise `hole`"],
        );
    }
    let old: Vec<Named> = good.iter().filter(|(_, [x, y, _])| libm::hypot(*x, *y) < 82.0).cloned().collect();
    check(&old, &[], &["nothing is repaired on this side; measure the weld, or reduce `threshold`"]);
}

#[test]
fn a_fifth_of_outliers_is_refused_as_such() {
    let mut random = fastrand::Rng::with_seed(5);
    for (file, side) in [("points.csv", "\"pressure\""), ("edge.csv", "\"leading\"")] {
        let mut cloud = points(file);
        for (_, point) in &mut cloud {
            if random.f64() < 0.2 {
                let direction = [0; 3].map(|_| 2.0 * random.f64() - 1.0);
                let length = libm::sqrt(direction.iter().map(|c| c * c).sum::<f64>());
                let off_mm = 0.3 + 2.7 * random.f64();
                (0..3).for_each(|k| point[k] += direction[k] / length * off_mm);
            }
        }
        let wanted = [
            "% of the points are outliers",
            "outside of the heights of their neighbours",
            "take them out, or measure anew",
        ];
        check(&cloud, &[("\"pressure\"", side)], &wanted);
    }
}

#[test]
fn weld_in_front_of_an_edge_is_not_planned_on_one_side_alone() {
    for (file, edge) in [("edge.csv", "leading"), ("trailing.csv", "trailing")] {
        for side in ["pressure", "suction"] {
            let said = refusal(&points(file), &[("\"pressure\"", &format!("\"{side}\""))]);
            let place = format!("mm in front of the {edge} edge at (");
            let remedy =
                format!("`side = \"{side}\"` plans nothing there: set `side` in [nominal] to \"{edge}\", or take off");
            assert!(said.contains(&place) && said.contains(&remedy), "{said}");
            // The weld is made 0.8 mm high.
            let amount = said.split("weld stands ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
            assert!((amount.parse::<f64>().unwrap() - 0.8).abs() < 0.05, "{said}");
        }
    }
    check(
        &points("edge.csv"),
        &[("\"pressure\"", "\"trailing\"")],
        &["the weld over this edge reaches the other edge at (", "0.8", "take off"],
    );
}
