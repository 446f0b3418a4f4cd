//! The whole chain of the example: points, program, simulated cut, deviation. The table of the plan is the claim; the old surface and the weld are those
//! of `make_points.py`. The result is measured twice: on the simulated stock by rays, and, up to the edges of the side, by the balls of the CL file.

use std::collections::HashMap;

use arcfeed_dexel::mesh::Mesh;
use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_plan::vector::{Point, Vector};
use arcfeed_tests::{Scratch, run};

use super::command::column;

/// `scallop` and `tolerance` of the part file.
const SCALLOP_MM: f64 = 0.01;
const TOLERANCE_MM: f64 = 0.005;
/// Radius of the ball-end mill of the part.
const BALL_MM: f64 = 2.5;
/// Edge of the cells among which triangles are sorted.
const CELL_MM: f64 = 1.0;
/// Range of heights in which the surface is looked for.
const REACH_MM: f64 = 1.5;

/// Triangles by the cells of their corners.
pub struct Facets(HashMap<[i32; 3], Vec<[Point; 3]>>);

fn cell(point: &Point) -> [i32; 3] {
    [point.x, point.y, point.z].map(|value| libm::floor(value / CELL_MM) as i32)
}

/// Corners of the triangles of a binary STL file: a header of 84 bytes, then 50 bytes a triangle.
fn triangles(path: &str) -> Vec<[Point; 3]> {
    let bytes = std::fs::read(path).unwrap();
    let triangle = |facet: &[u8]| {
        let value = |at: usize| f64::from(f32::from_le_bytes(facet[at..at + 4].try_into().unwrap()));
        [12, 24, 36].map(|at| Point::new(value(at), value(at + 4), value(at + 8)))
    };
    bytes[84..].chunks_exact(50).map(triangle).collect()
}

impl Facets {
    pub fn read(path: &str) -> Self {
        let mut cells: HashMap<[i32; 3], Vec<[Point; 3]>> = HashMap::new();
        for corners in triangles(path) {
            let mut at = corners.map(|corner| cell(&corner)).to_vec();
            at.sort_unstable();
            at.dedup();
            at.into_iter().for_each(|at| cells.entry(at).or_default().push(corners));
        }
        Facets(cells)
    }

    /// Height of the surface on the line through a point along a direction: the intersection nearest to the point from which the surface faces out.
    pub fn height_mm(&self, from: &Point, along: &Vector) -> Option<f64> {
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

/// The balls of a mill on its way: straight lines of their centres.
pub struct Balls(Vec<[Point; 2]>);

/// Tips and axes of the `GOTO` words of a CL file, which has the axis where it changes.
fn locations(path: &str) -> Vec<(Point, Vector)> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut axis = Vector::zeros();
    let mut location = |words: &str| {
        let values: Vec<f64> = words.split(',').map(|word| word.parse().unwrap()).collect();
        if let [i, j, k] = values[3..] {
            axis = Vector::new(i, j, k);
        }
        (Point::new(values[0], values[1], values[2]), axis)
    };
    text.lines().filter_map(|line| line.strip_prefix("GOTO/")).map(&mut location).collect()
}

impl Balls {
    pub fn read(path: &str) -> Self {
        let centres: Vec<Point> = locations(path).into_iter().map(|(tip, axis)| tip + BALL_MM * axis).collect();
        Balls(centres.windows(2).map(|ends| [ends[0], ends[1]]).collect())
    }

    /// Height on the line through a point along a direction at which the balls end, from `start_mm` on; infinite where none is met.
    pub fn height_mm(&self, from: &Point, along: &Vector, start_mm: f64) -> f64 {
        let reached: Vec<_> = self.0.iter().filter(|line| apart(line, from) < BALL_MM + 2.0 * REACH_MM).collect();
        let mut height = start_mm;
        while height < REACH_MM {
            let at = from + height * along;
            let gap = reached.iter().map(|line| apart(line, &at)).fold(f64::INFINITY, f64::min) - BALL_MM;
            if gap < 1e-7 {
                return height;
            }
            height += gap;
        }
        f64::INFINITY
    }
}

/// Distance of a point from a line between two points.
fn apart([a, b]: &[Point; 2], at: &Point) -> f64 {
    let (way, off) = (b - a, at - a);
    let ratio = off.dot(&way) / way.norm_squared();
    (off - way * if ratio.is_nan() { 0.0 } else { ratio.clamp(0.0, 1.0) }).norm()
}

/// Place of the lattice with what was planned, what stood before and what stands after.
pub struct Place {
    row: usize,
    column: usize,
    region: String,
    planned_mm: Option<f64>,
    before_mm: f64,
    after_mm: f64,
}

/// Line of the table: a place of the side, and the height of the old surface there.
pub struct Row {
    pub uv: [f64; 2],
    pub from: Point,
    pub along: Vector,
    pub stands_mm: f64,
}

/// Places of the table, before and after as `measured`; those without, and places in a hole of the measurement, are left out.
pub fn places(folder: &str, measured: impl Fn(&Row) -> Option<[f64; 2]>) -> Vec<Place> {
    let table = std::fs::read_to_string(format!("{folder}/allowance.csv")).unwrap();
    let names = table.lines().nth(1).unwrap();
    let place = |line: &str| {
        let number = |name: &str| column(names, line, name).parse::<f64>();
        let value = |name: &str| number(name).unwrap();
        let [before_mm, after_mm] = measured(&Row {
            uv: ["u", "v"].map(value),
            from: ["x_mm", "y_mm", "z_mm"].map(value).into(),
            along: ["nx", "ny", "nz"].map(value).into(),
            stands_mm: number("along_mm").ok()?,
        })?;
        Some(Place {
            row: value("row") as usize,
            column: value("column") as usize,
            region: column(names, line, "region").into(),
            planned_mm: number("left_mm").ok(),
            before_mm,
            after_mm,
        })
    };
    table.lines().skip(2).filter_map(place).collect()
}

/// Checks what was taken from the old surface, and how far the rest stands above the plan, on at least so many places of each.
pub fn check(places: &[Place], least: [usize; 2]) {
    let norm = places.iter().filter(|place| place.region == "norm");
    let (mut taken, mut count) = (f64::NEG_INFINITY, 0);
    for place in norm {
        (taken, count) = (taken.max(place.before_mm - place.after_mm), count + 1);
    }
    println!("{count} places of the norm region: {:.2} um taken at most", 1000.0 * taken);
    let off = places.iter().filter_map(|place| {
        let planned_mm = place.planned_mm?;
        // Where the old surface itself lies below the plan there is nothing to take.
        Some(place.after_mm - planned_mm).filter(|off| *off > 0.0 || place.before_mm > planned_mm)
    });
    let off: Vec<f64> = off.collect();
    let (low, high) = off.iter().fold((0.0_f64, 0.0_f64), |(low, high), off| (low.min(*off), high.max(*off)));
    println!("{} places to be finished: {:.2} to {:.2} um above the plan", off.len(), 1000.0 * low, 1000.0 * high);
    assert!(count > least[0] && off.len() > least[1]);
    assert!(taken < 0.001, "{taken}");
    assert!(low >= -TOLERANCE_MM && high <= SCALLOP_MM + TOLERANCE_MM, "{low} {high}");
}

/// The largest step across a border: from the last place below it to the first above it, half a millimetre apart, on every column; across a border all round,
/// also from above and from both sides. At least so many columns are compared.
pub fn step_mm(places: &[Place], [below, above]: [&str; 2], is_all_round: bool, least: usize) -> f64 {
    let (mut steps, mut count) = (0.0_f64, 0);
    for place in places.iter().filter(|place| place.region == above) {
        let is_beside = |other: &&Place| match is_all_round {
            true => other.row.abs_diff(place.row) + other.column.abs_diff(place.column) == 1,
            false => other.row + 1 == place.row && other.column == place.column,
        };
        for other in places.iter().filter(is_beside).filter(|other| other.region == below) {
            // The plan itself falls by less than 0.0015 mm in that half millimetre.
            steps = steps.max((place.after_mm - other.after_mm).abs());
            count += 1;
        }
    }
    println!("step from {below} to {above}: {:.2} um at most on {count} columns", 1000.0 * steps);
    assert!(count > least, "{count}");
    steps
}

/// Volumes that dexels lose on the approaches of the CL file, mm3: the only long moves towards the rotor's axis.
fn approaches_mm3(folder: &str) -> Vec<f64> {
    let corners = triangles(&format!("{folder}/stock.stl")).into_iter().map(|corners| corners.map(Into::into));
    let mut stock = Stock::new(&Mesh::from_corners(corners).unwrap(), 0.1, 1 << 30).unwrap();
    let tool = Tool::ball(BALL_MM, 6.0, 1e-3).unwrap();
    let mut taken = Vec::new();
    for pair in locations(&format!("{folder}/repair.apt")).windows(2) {
        let [from, to] = [&pair[0], &pair[1]].map(|(tip, axis)| Pose { tip_mm: (*tip).into(), axis: (*axis).into() });
        let removed = stock.cut(&tool, &Move::Straight { from, to }.sweeps(&tool, 0.01).unwrap()).unwrap();
        let falls_mm = pair[0].0.coords.xy().norm() - pair[1].0.coords.xy().norm();
        if falls_mm > 1.5 {
            taken.push(removed.mean_mm3());
        }
    }
    taken
}

/// Largest distance of the corners of a solid from the rotor's axis.
fn radius_mm(facets: &Facets) -> f64 {
    let corners = facets.0.values().flatten().flatten();
    corners.map(|corner| libm::hypot(corner.x, corner.y)).fold(0.0, f64::max)
}

#[test]
fn point_3_what_is_left_of_the_example_is_what_was_planned_and_the_old_surface() {
    let scratch = Scratch::new("repair-chain");
    let folder = scratch.path("out");
    let planned = run(&["plan", "repair", "examples/repaired-blade/REPAIR.toml", "-o", &folder]);
    println!("{}{}", String::from_utf8_lossy(&planned.stdout), String::from_utf8_lossy(&planned.stderr));
    assert!(planned.status.success());

    println!("by the balls of the CL file, up to the edges:");
    let balls = Balls::read(&format!("{folder}/repair.apt"));
    let by_balls = places(&folder, |row| {
        Some([row.stands_mm, row.stands_mm.min(balls.height_mm(&row.from, &row.along, -REACH_MM))])
    });
    check(&by_balls, [500, 1000]);

    let surface = format!("{folder}/left.stl");
    let simulated = run(&["simulate", &format!("{folder}/job.toml"), "--surface", &surface]);
    println!("{}{}", String::from_utf8_lossy(&simulated.stdout), String::from_utf8_lossy(&simulated.stderr));
    assert!(simulated.status.success());
    let [before, after] = ["stock.stl", "left.stl"].map(|name| Facets::read(&format!("{folder}/{name}")));
    let simulated = places(&folder, |row| {
        // Beside the borders of the side the lines meet its edges and the tip's face, and the blade is hardly thicker than the distance of dexel rays.
        let [u, v] = row.uv;
        let is_inside = (0.02..=0.98).contains(&u) && (0.03..=0.95).contains(&v);
        let height = |facets: &Facets| facets.height_mm(&row.from, &row.along).expect("a surface there");
        is_inside.then(|| [&before, &after].map(height))
    });
    println!("by rays on the simulated stock:");
    check(&simulated, [500, 1000]);
    for border in [["norm", "transition"], ["transition", "repaired"]] {
        let step = step_mm(&simulated, border, false, 40);
        assert!(step <= 0.01, "{border:?} {step}");
    }
    // Weld that leans over the tip's face stays: less than the tolerance of the finish is thick.
    let finished = Facets::read(&format!("{folder}/finished.stl"));
    let [over_before, over_after] = [&before, &after].map(|facets| radius_mm(facets) - radius_mm(&finished));
    println!("above the tip's face: {over_before:.4} mm before, {over_after:.4} mm after");
    assert!(over_after < 0.02 + TOLERANCE_MM, "{over_after}");

    // A layer is 0.25 mm deep, and the finish 0.28: an approach takes less than the cap of the ball that deep.
    let taken = approaches_mm3(&folder);
    let most_mm3 = taken.iter().copied().fold(0.0, f64::max);
    println!("{} approaches take {:.2} mm3, the most {most_mm3:.3}", taken.len(), taken.iter().sum::<f64>());
    let cap_mm3 = core::f64::consts::PI * 0.28 * 0.28 * (BALL_MM - 0.28 / 3.0);
    assert!(taken.len() > 100 && most_mm3 < cap_mm3 / 2.0, "{most_mm3} {cap_mm3}");
}
