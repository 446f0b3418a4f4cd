//! The whole chain of the example: points, program, simulated cut, deviation. The result is measured on the simulated stock by rays, with the table of
//! the plan as the claim; the old surface and the weld are those of `make_points.py`.

use std::collections::HashMap;

use arcfeed_plan::vector::{Point, Vector};
use arcfeed_tests::{Scratch, run};

use super::command::column;

/// `scallop` and `tolerance` of the part file.
const SCALLOP_MM: f64 = 0.01;
const TOLERANCE_MM: f64 = 0.005;
/// Edge of the cells among which triangles are sorted.
const CELL_MM: f64 = 1.0;
/// Range of heights in which the surface is looked for.
const REACH_MM: f64 = 1.5;

/// Triangles by the cells of their corners.
struct Facets(HashMap<[i32; 3], Vec<[Point; 3]>>);

fn cell(point: &Point) -> [i32; 3] {
    [point.x, point.y, point.z].map(|value| libm::floor(value / CELL_MM) as i32)
}

impl Facets {
    /// Binary STL: a header of 84 bytes, then 50 bytes a triangle.
    fn read(path: &str) -> Self {
        let bytes = std::fs::read(path).unwrap();
        let mut cells: HashMap<[i32; 3], Vec<[Point; 3]>> = HashMap::new();
        for facet in bytes[84..].chunks_exact(50) {
            let value = |at: usize| f64::from(f32::from_le_bytes(facet[at..at + 4].try_into().unwrap()));
            let corners = [12, 24, 36].map(|at| Point::new(value(at), value(at + 4), value(at + 8)));
            let mut at = corners.map(|corner| cell(&corner)).to_vec();
            at.sort_unstable();
            at.dedup();
            at.into_iter().for_each(|at| cells.entry(at).or_default().push(corners));
        }
        Facets(cells)
    }

    /// Height of the surface on the line through a point along a direction: the intersection nearest to the point from which the surface faces out.
    fn height_mm(&self, from: &Point, along: &Vector) -> Option<f64> {
        let [i, j, k] = cell(from);
        let mut least: Option<f64> = None;
        for (a, b, c) in (-2..=2).flat_map(|a| (-2..=2).flat_map(move |b| (-2..=2).map(move |c| (a, b, c)))) {
            for corners in self.0.get(&[i + a, j + b, k + c]).into_iter().flatten() {
                if let Some(at) = met(corners, from, along).filter(|at| at.abs() < REACH_MM) {
                    least = Some(least.map_or(at, |known| if at.abs() < known.abs() { at } else { known }));
                }
            }
        }
        least
    }
}

/// Place at which a line meets a triangle that faces along it (Moeller and Trumbore).
fn met([a, b, c]: &[Point; 3], from: &Point, along: &Vector) -> Option<f64> {
    let (one, other, off) = (b - a, c - a, from - a);
    let normal = one.cross(&other);
    let facing = normal.dot(along);
    if facing <= 0.0 {
        return None;
    }
    let across = along.cross(&off);
    let (share, rest) = (other.dot(&across) / facing, -one.dot(&across) / facing);
    let slack = 1e-9;
    let is_inside = share >= -slack && rest >= -slack && share + rest <= 1.0 + slack;
    is_inside.then(|| -normal.dot(&off) / facing)
}

/// Place of the lattice with what was planned, what stood before and what stands after.
struct Place {
    row: usize,
    column: usize,
    region: String,
    planned_mm: Option<f64>,
    before_mm: f64,
    after_mm: f64,
}

fn places(folder: &str) -> Vec<Place> {
    let [before, after] = ["stock.stl", "left.stl"].map(|name| Facets::read(&format!("{folder}/{name}")));
    let table = std::fs::read_to_string(format!("{folder}/allowance.csv")).unwrap();
    let names = table.lines().nth(1).unwrap();
    let mut found = Vec::new();
    for line in table.lines().skip(2) {
        let number = |name: &str| column(names, line, name).parse::<f64>();
        let value = |name: &str| number(name).unwrap();
        // Beside the borders of the side the lines meet its edges and the tip's face, and the blade is hardly thicker than the distance of dexel rays.
        let is_inside = (0.02..=0.98).contains(&value("u")) && (0.03..=0.95).contains(&value("v"));
        if !is_inside {
            continue;
        }
        let from = Point::new(value("x_mm"), value("y_mm"), value("z_mm"));
        let along = Vector::new(value("nx"), value("ny"), value("nz"));
        let [before_mm, after_mm] = [&before, &after].map(|facets| facets.height_mm(&from, &along));
        found.push(Place {
            row: value("row") as usize,
            column: value("column") as usize,
            region: column(names, line, "region").into(),
            planned_mm: number("left_mm").ok(),
            before_mm: before_mm.expect("the stock has a surface there"),
            after_mm: after_mm.expect("the result has a surface there"),
        });
    }
    found
}

#[test]
fn the_simulated_cut_leaves_what_was_planned_and_the_old_surface() {
    let scratch = Scratch::new("repair-chain");
    let folder = scratch.path("out");
    let planned = run(&["plan", "repair", "examples/repaired-blade/REPAIR.toml", "-o", &folder]);
    println!("{}{}", String::from_utf8_lossy(&planned.stdout), String::from_utf8_lossy(&planned.stderr));
    assert!(planned.status.success());
    let surface = format!("{folder}/left.stl");
    let simulated = run(&["simulate", &format!("{folder}/job.toml"), "--surface", &surface]);
    println!("{}{}", String::from_utf8_lossy(&simulated.stdout), String::from_utf8_lossy(&simulated.stderr));
    assert!(simulated.status.success());

    let places = places(&folder);
    let norm: Vec<f64> =
        places.iter().filter(|place| place.region == "norm").map(|place| place.before_mm - place.after_mm).collect();
    let taken = norm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    println!("{} places of the norm region: {:.2} um taken at most", norm.len(), 1000.0 * taken);
    let off: Vec<(f64, &Place)> = places
        .iter()
        .filter_map(|place| Some((place.after_mm - place.planned_mm?, place)))
        // Where the old surface itself lies below the plan there is nothing to take.
        .filter(|(off, place)| *off > 0.0 || place.before_mm > place.planned_mm.unwrap_or(0.0))
        .collect();
    let (low, high) = off.iter().fold((0.0_f64, 0.0_f64), |(low, high), (off, _)| (low.min(*off), high.max(*off)));
    println!("{} places to be finished: {:.2} to {:.2} um above the plan", off.len(), 1000.0 * low, 1000.0 * high);

    // Across c1: the last place of the norm region and the first of the transition on a column.
    let mut steps = 0.0_f64;
    for place in places.iter().filter(|place| place.region == "transition") {
        let below = places
            .iter()
            .find(|other| other.row + 1 == place.row && other.column == place.column && other.region == "norm");
        if let (Some(below), Some(planned_mm)) = (below, place.planned_mm) {
            // The plan itself falls by less than 0.001 mm over the first half millimetre of the transition.
            steps = steps.max((place.after_mm - below.after_mm).abs());
            assert!((planned_mm - 0.05).abs() < 0.003, "{planned_mm}");
        }
    }
    println!("step across the border of the norm region: {:.2} um at most", 1000.0 * steps);
    assert!(norm.len() > 500 && off.len() > 1000);
    assert!(taken < 0.001, "{taken}");
    assert!(low >= -TOLERANCE_MM && high <= SCALLOP_MM + TOLERANCE_MM, "{low} {high}");
    assert!(steps <= 0.01, "{steps}");
}
