//! The whole chain of repairs over the leading and over the trailing edge: points, program, simulated cut, deviation, as `chain` has it for one side.

use arcfeed_plan::vector::Vector;
use arcfeed_tests::{Scratch, run};

use super::chain::{Balls, Facets, check, places, step_mm};
use super::command::column;

/// Thickness of the blade, without what stands on it, from which on the surface is measured on dexels 0.1 mm apart.
const THICK_MM: f64 = 0.6;
/// Depth below the nominal surface from which on the balls are looked for: less than what is left on the other side of a sharp edge, whose balls lie deeper.
const DEEP_MM: f64 = 0.015;
/// Turn of the normal between neighbouring places from which on they lie on the rounding of the edge.
const ROUND_RAD: f64 = 0.2;

/// Range of v of the rounding of the edge, which is too small for dexels.
fn rounding(folder: &str) -> [f64; 2] {
    let table = std::fs::read_to_string(format!("{folder}/allowance.csv")).unwrap();
    let names = table.lines().nth(1).unwrap();
    let value = |line: &str, name: &str| column(names, line, name).parse::<f64>().unwrap();
    let normal = |line: &str| Vector::from(["nx", "ny", "nz"].map(|name| value(line, name)));
    let lines: Vec<&str> = table.lines().skip(2).collect();
    let pairs = lines.windows(2).filter(|pair| value(pair[0], "row") == value(pair[1], "row"));
    // The other edge lies at both ends of v.
    let near = pairs.filter(|pair| (0.25..0.75).contains(&value(pair[0], "v")));
    let round = near.filter(|pair| normal(pair[0]).angle(&normal(pair[1])) > ROUND_RAD);
    round.fold([1.0, 0.0], |range, pair| [range[0].min(value(pair[0], "v")), range[1].max(value(pair[1], "v"))])
}

#[test]
fn what_is_left_round_the_leading_edge_is_what_was_planned_and_the_old_surface() {
    check_chain("EDGE.toml", "repaired-edge.nc", 500, 40);
}

#[test]
fn what_is_left_round_the_trailing_edge_is_what_was_planned_and_the_old_surface() {
    // The blade is thin there: fewer rays end on it.
    check_chain("TRAILING.toml", "repaired-trailing-edge.nc", 300, 10);
}

/// Positions of A in a program, the smallest and the largest.
fn range_of_a(program: &str) -> [f64; 2] {
    let words = program.split('A').skip(1).filter_map(|rest| {
        let end = rest.find(|c: char| !"-.0123456789".contains(c)).unwrap_or(rest.len());
        rest[..end].parse::<f64>().ok()
    });
    words.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], a| [least.min(a), most.max(a)])
}

/// At least so many finished places and columns along a border are compared by rays.
fn check_chain(file: &str, program: &str, finished: usize, columns: usize) {
    let scratch = Scratch::new(&format!("repair-chain-{program}"));
    let folder = scratch.path("out");
    let planned = run(&["plan", "repair", &format!("examples/repaired-blade/{file}"), "-o", &folder]);
    println!("{}{}", String::from_utf8_lossy(&planned.stdout), String::from_utf8_lossy(&planned.stderr));
    assert!(planned.status.success());
    let [least, most] = range_of_a(&std::fs::read_to_string(format!("{folder}/{program}")).unwrap());
    println!("A from {least} to {most}");
    assert!(least >= -120.0 && most <= 30.0);

    println!("by the balls of the CL file, round the edge:");
    let balls = Balls::read(&format!("{folder}/repair.apt"));
    let by_balls = places(&folder, |row| {
        Some([row.stands_mm, row.stands_mm.min(balls.height_mm(&row.from, &row.along, -DEEP_MM))])
    });
    check(&by_balls, [1000, 500]);
    for border in [["norm", "transition"], ["transition", "repaired"]] {
        let step = step_mm(&by_balls, border, true, 40);
        assert!(step <= 0.01, "{border:?} {step}");
    }

    let surface = format!("{folder}/left.stl");
    let simulated = run(&["simulate", &format!("{folder}/job.toml"), "--surface", &surface]);
    println!("{}{}", String::from_utf8_lossy(&simulated.stdout), String::from_utf8_lossy(&simulated.stderr));
    assert!(simulated.status.success());
    let [before, after] = ["stock.stl", "left.stl"].map(|name| Facets::read(&format!("{folder}/{name}")));
    let nominal = Facets::read(&format!("{folder}/finished.stl"));
    let [first, last] = rounding(&folder);
    let simulated = places(&folder, |row| {
        // Off tip, root and the other edge.
        let is_inside = row.uv.iter().all(|at| (0.02..=0.98).contains(at)) && !(first..=last).contains(&row.uv[1]);
        // The other side of the finished blade, seen from inside.
        let inner = nominal.height_mm(&(row.from - THICK_MM * row.along), &-row.along);
        let is_thick = inner.is_none_or(|behind_mm| behind_mm > 0.0);
        let height = |facets: &Facets| facets.height_mm(&row.from, &row.along);
        let [before, after] = [&before, &after].map(height);
        before.zip(after).filter(|_| is_inside && is_thick).map(|(before, after)| [before, after])
    });
    println!("by rays on the simulated stock:");
    check(&simulated, [1000, finished]);
    for border in [["norm", "transition"], ["transition", "repaired"]] {
        let step = step_mm(&simulated, border, true, columns);
        assert!(step <= 0.01, "{border:?} {step}");
    }
    // The truth of the points: the weld, and what it stands on.
    let table = std::fs::read_to_string(format!("{folder}/allowance.csv")).unwrap();
    let names = table.lines().nth(1).unwrap();
    let repaired = table.lines().skip(2).filter(|line| column(names, line, "region") == "repaired");
    let highest = repaired.filter_map(|line| column(names, line, "along_mm").parse::<f64>().ok()).fold(0.0, f64::max);
    assert!((highest - 0.8).abs() < 0.03, "{highest}");
}
