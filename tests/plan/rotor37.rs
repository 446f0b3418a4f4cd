//! A rotor that was built: NASA's rotor 37, through curve files written from its table of coordinates (L. Reid, R. D. Moore, NASA TP-1337,
//! 1978, table IV).

use std::fmt::Write;

use arcfeed_plan::cup_mill::neighbours::NEARER_RATIO;
use arcfeed_plan::cup_mill::plan::AxisChoice;
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::geometry::blade::RotorAxis;
use arcfeed_plan::geometry::blisk::{Blank, Blisk};
use arcfeed_plan::geometry::curves::{self, Curves, Texts};
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::geometry::flaws::{flaws, nearest};
use arcfeed_plan::geometry::point_file::PointFileFrame;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::proof::verdict::{ProofCase, ProofResolution, prove};
use arcfeed_plan::vector::Point;

use crate::proof_cases::published_tool;
use crate::proof_published::{ALLOWANCE_MM, ROUGHING};

/// Place along the axis, radius, and the angles of both sides.
pub type Row = [f64; 4];

/// The 13 stream surfaces, 100 rows each.
pub fn surfaces() -> Option<Vec<Vec<Row>>> {
    let path = arcfeed_tests::shared_or_skip("data/nasa/rotor37_mm.csv", "plan rotor37")?;
    let text = std::fs::read_to_string(path).unwrap();
    let row = |line: &str| -> Row {
        let numbers: Vec<f64> = line.split(',').skip(2).map(|word| word.parse().unwrap()).collect();
        numbers.try_into().unwrap()
    };
    let rows: Vec<Row> = text.lines().skip(1).map(row).collect();
    Some(rows.chunks(100).map(<[Row]>::to_vec).collect())
}

/// Drawn in metres about x, as such files often are.
fn line(z_mm: f64, radius_mm: f64, angle: f64) -> String {
    let (sin, cos) = libm::sincos(angle);
    format!("{:.9}, {:.9}, {:.9}\n", z_mm / 1000.0, radius_mm * cos / 1000.0, radius_mm * sin / 1000.0)
}

/// Curve files of hub, shroud and profile.
pub fn curve_files(surfaces: &[Vec<Row>]) -> [String; 3] {
    // The gas path goes on beyond the blade.
    let path = |rows: &[Row]| -> String {
        let ends = |row: &Row, by_mm: f64| line(row[0] + by_mm, row[1], 0.3);
        let inner = rows.iter().map(|row| line(row[0], row[1], 0.3));
        let (first, last) = (&rows[0], &rows[rows.len() - 1]);
        std::iter::once(ends(first, -20.0)).chain(inner).chain([ends(last, 20.0)]).collect()
    };
    let mut profile = String::new();
    for (at, rows) in surfaces.iter().enumerate() {
        writeln!(profile, "# Profile {} at {:.2} %", at + 1, 100.0 * at as f64 / 12.0).unwrap();
        let there = rows.iter().map(|row| line(row[0], row[1], row[2]));
        let back = rows.iter().rev().skip(1).map(|row| line(row[0], row[1], row[3]));
        profile.extend(there.chain(back));
    }
    [path(&surfaces[0]), path(&surfaces[12]), profile]
}

fn read(surfaces: &[Vec<Row>]) -> Curves {
    let [hub, shroud, profile] = &curve_files(surfaces);
    curves::read(&Texts { hub, shroud, profile }, &PointFileFrame { axis: RotorAxis::X, unit_mm: 1000.0 }).unwrap()
}

/// The rotor in the blank of the plunge plans.
pub fn blisk(surfaces: &[Vec<Row>]) -> Blisk {
    let Curves { hub, blades, .. } = read(surfaces);
    let [pressure, suction] = blades[0].faces().unwrap();
    Blisk {
        blades: 36,
        pressure,
        suction,
        further_blades: Vec::new(),
        hub,
        blank: Blank { radius_mm: 253.0, faces_mm: [-5.0, 50.0] },
    }
}

#[test]
fn rotor_37_is_read_with_its_edges_sides_and_gaps() {
    let Some(surfaces) = surfaces() else { return };
    let Curves { hub, blades, .. } = read(&surfaces);
    for (at, rows) in surfaces.iter().enumerate() {
        let (leading, trailing) = (blades[0].pressure[at][0], blades[0].pressure[at][blades[0].pressure[at].len() - 1]);
        // The profile's ends may be the second-last rows: edges are round.
        let off_mm = |point: &Point, row: &Row| libm::hypot(point.z - row[0], libm::hypot(point.x, point.y) - row[1]);
        assert!(off_mm(&leading, &rows[0]) < 0.1 && off_mm(&trailing, &rows[99]) < 0.1, "surface {}", at + 1);
    }
    let [pressure, suction] = blades[0].faces().unwrap();
    let blisk = Blisk {
        blades: 36,
        pressure,
        suction,
        further_blades: Vec::new(),
        hub,
        blank: Blank { radius_mm: 253.0, faces_mm: [-5.0, 50.0] },
    };
    let slot = blisk.slot();
    let (at, gap_mm) = nearest(&slot.pressure, &slot.suction);
    let table_mm = table_gap_mm(&surfaces);
    println!("36 blades, least gap {gap_mm:.2} mm at {at:.3?}; between points of the table {table_mm:.2} mm");
    assert!(gap_mm <= table_mm && gap_mm > table_mm - 0.2);
    // A compressor's blade moves with its leading edge and its pressure side ahead: here to falling angles.
    assert_eq!(blisk.facing(), -1);
    let stagger = |row: usize| {
        let points = &blades[0].pressure[row];
        let (a, b) = (points[0], points[points.len() - 1]);
        let turn = libm::atan2(b.y, b.x) - libm::atan2(a.y, a.x);
        let radius_mm = (libm::hypot(a.x, a.y) + libm::hypot(b.x, b.y)) / 2.0;
        libm::atan2((radius_mm * turn).abs(), b.z - a.z).to_degrees()
    };
    println!("stagger {:.2} to {:.2} degrees", stagger(0), stagger(12));
    assert!((stagger(0) - 39.4).abs() < 0.5 && (stagger(12) - 60.1).abs() < 0.5);
    let found = flaws(&blisk, 0.889);
    found.iter().for_each(|flaw| println!("{flaw}"));
    assert_eq!(found, []);
}

#[test]
fn narrow_rings_pass_rotor_37_without_a_collision_with_any_blade() {
    let Some(surfaces) = surfaces() else { return };
    let Curves { hub, blades, .. } = read(&surfaces);
    let [pressure, suction] = blades[0].faces().unwrap();
    let blisk = Blisk {
        blades: 36,
        pressure,
        suction,
        further_blades: Vec::new(),
        hub,
        blank: Blank { radius_mm: 253.0, faces_mm: [-5.0, 50.0] },
    };
    let slot = blisk.slot();
    let middle_mm = (published_tool().outer_radius_mm + published_tool().inner_radius_mm) / 2.0;
    for width_mm in [8.0, 12.0] {
        // The blades are 75 mm high: the cup is as deep.
        let tool = CupMill {
            outer_radius_mm: middle_mm + width_mm / 2.0,
            inner_radius_mm: middle_mm - width_mm / 2.0,
            cavity_depth_mm: 90.0,
            height_mm: 110.0,
            ..published_tool()
        };
        let problem = Problem::new(&blisk, &slot, &tool, &ROUGHING).unwrap();
        let found = problem.along(AxisChoice::Blade).unwrap();
        let (path, to_slot, allowance_mm) = (&found.plan.path, found.plan.turn, ALLOWANCE_MM);
        let case = ProofCase { blisk: &blisk, tool: &tool, path, to_slot, allowance_mm, fixture: &[], earlier: &[] };
        let coarse = ProofResolution { grid: [2, 2], cell_mm: 2.0, ..ProofResolution::default() };
        let proof = prove(&case, &coarse).unwrap();
        for near in &proof.clearances {
            println!("{width_mm} mm: {:?} {:?} {:.3?} mm", near.part, near.obstacle, near.bounds_mm);
        }
        let share = found.share_ratio;
        println!("{width_mm} mm: {} levels take {:.1} %", path.levels.len(), 100.0 * share);
        assert!(proof.holds(allowance_mm, NEARER_RATIO * allowance_mm) && share > 0.3, "{width_mm}");
    }
}

/// Points of the table on one side of a blade that is turned about the rotor's axis.
pub fn side(surfaces: &[Vec<Row>], column: usize, turn: f64) -> Vec<Point> {
    let place = |row: &Row| {
        let (sin, cos) = libm::sincos(row[column] + turn);
        Point::new(row[1] * cos, row[1] * sin, row[0])
    };
    surfaces.iter().flatten().map(place).collect()
}

/// Least distance of the table's points on one blade and on the next.
fn table_gap_mm(surfaces: &[Vec<Row>]) -> f64 {
    let pitch = core::f64::consts::TAU / 36.0;
    let (one, next) = (side(surfaces, 2, 0.0), side(surfaces, 3, pitch));
    let gaps = one.iter().flat_map(|a| next.iter().map(move |b| (a - b).norm()));
    gaps.fold(f64::INFINITY, f64::min)
}

#[test]
fn the_faces_of_rotor_37_pass_through_its_table() {
    let Some(surfaces) = surfaces() else { return };
    let Curves { blades, .. } = read(&surfaces);
    let faces = blades[0].faces().unwrap();
    let (mut worst_mm, mut mean_mm) = (0.0_f64, 0.0);
    let rows = [2, 6, 10].map(|at| &surfaces[at]);
    for row in rows.iter().flat_map(|rows| rows.iter().skip(3).step_by(8)) {
        for angle in [row[2], row[3]] {
            let (sin, cos) = libm::sincos(angle);
            let point = Point::new(row[1] * cos, row[1] * sin, row[0]);
            let off_mm = faces.iter().map(|face| distance_mm(face, &point)).fold(f64::INFINITY, f64::min);
            worst_mm = worst_mm.max(off_mm);
            mean_mm += off_mm / 78.0;
        }
    }
    println!("78 points of the table: {worst_mm:.4} mm off the faces at most, {mean_mm:.5} mm in the mean");
    assert!(worst_mm < 0.01);
}

/// From a point to a face, by samples and then ever smaller steps.
fn distance_mm(face: &Face, point: &Point) -> f64 {
    let off = |[u, v]: [f64; 2]| (face.point(u, v) - point).norm();
    let samples = (0..=60).flat_map(|i| (0..=12).map(move |j| [f64::from(i) / 60.0, f64::from(j) / 12.0]));
    let mut best = samples.map(|at| (off(at), at)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    let mut step = 0.02;
    while step > 1e-7 {
        let [u, v] = best.1;
        let near = [[u + step, v], [u - step, v], [u, v + step], [u, v - step]];
        match near
            .map(|at| (off(at), at))
            .into_iter()
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|found| found.0 < best.0)
        {
            Some(better) => best = better,
            None => step /= 2.0,
        }
    }
    best.0
}
