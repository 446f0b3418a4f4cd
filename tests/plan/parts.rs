//! Twenty rotors, from easy to impossible: what the planner says of each, and what searches and samples say that share nothing with
//! planner and proof but the blades' surfaces and the tool's shape. The table is that of docs/plan-parts.md; `UPDATE_GOLDEN=1` writes it.

use arcfeed_plan::cup_mill::infeasibility::Infeasible;
use arcfeed_plan::cup_mill::plan::{SlotPlan, plan};
use arcfeed_plan::cutter::{CupMill, ToolPart};
use arcfeed_plan::geometry::blisk::{Blank, Blisk, Revolution};
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::geometry::generator::Rotor;
use arcfeed_plan::proof::clearance::{Obstacle, clearance};
use arcfeed_plan::proof::earlier::Earlier;
use arcfeed_plan::proof::floor::Floor;
use arcfeed_plan::proof::remaining::SlotWalls;
use arcfeed_plan::proof::removal::{Stock, removed};
use arcfeed_plan::proof::verdict::{ProofCase, bodies};
use arcfeed_plan::vector::{Flat, Point, Vector};
use nalgebra::Rotation3;

use crate::proof_cases::{GAP_MM, poses, published_tool};
use crate::proof_published::{ALLOWANCE_MM, ROUGHING};
use crate::published_rotor::ROTOR;

/// Fraction of a side that belongs to its round edges.
const ROUND_RATIO: f64 = 0.03;

/// Largest distance of the proof's triangles from the blades.
const CHORD_MM: f64 = 0.01;

fn tool(outer_radius_mm: f64, width_mm: f64) -> CupMill {
    CupMill { outer_radius_mm, inner_radius_mm: outer_radius_mm - width_mm, ..published_tool() }
}

fn blisk(rotor: &Rotor) -> Blisk {
    let [pressure, suction] = rotor.sections(9, 81).expect("a rotor").faces().expect("faces");
    let reach_mm = rotor.chord_mm[0].max(rotor.chord_mm[1]) / 2.0 + 2.0;
    let hub = Revolution { profile_mm: [-reach_mm - 5.0, reach_mm + 5.0].map(|z| [z, rotor.hub_radius_mm]).to_vec() };
    let blank = Blank { radius_mm: rotor.tip_radius_mm + 1.4, faces_mm: [-reach_mm, reach_mm] };
    Blisk { blades: rotor.blades, pressure, suction, further_blades: Vec::new(), hub, blank }
}

/// Names, rotors and tools.
fn parts() -> Vec<(&'static str, Rotor, CupMill)> {
    let published = || tool(128.576, 15.874);
    let rotor = |change: fn(&mut Rotor)| {
        let mut rotor = ROTOR;
        change(&mut rotor);
        rotor
    };
    vec![
        ("the published one", ROTOR, published()),
        ("no twist", rotor(|r| r.stagger_deg = [35.0, 35.0]), published()),
        ("twist 21 deg", rotor(|r| r.stagger_deg = [28.0, 49.0]), published()),
        ("twist 28 deg", rotor(|r| r.stagger_deg = [28.0, 56.0]), published()),
        ("thin blades", rotor(|r| r.thickness_ratio = [0.06, 0.035]), published()),
        ("thick blades", rotor(|r| r.thickness_ratio = [0.14, 0.08]), published()),
        ("13 blades", rotor(|r| r.blades = 13), published()),
        ("16 blades", rotor(|r| r.blades = 16), published()),
        ("22 blades", rotor(|r| r.blades = 22), published()),
        ("25 blades", rotor(|r| r.blades = 25), published()),
        ("chord 20", rotor(|r| r.chord_mm = [20.0, 20.0]), published()),
        ("chord 32", rotor(|r| r.chord_mm = [32.0, 32.0]), published()),
        ("chord 40", rotor(|r| r.chord_mm = [40.0, 40.0]), published()),
        ("lean 10 deg", rotor(|r| r.lean_deg = 10.0), published()),
        ("lean -10 deg", rotor(|r| r.lean_deg = -10.0), published()),
        ("hub radius 82", rotor(|r| r.hub_radius_mm = 82.0), published()),
        ("hub radius 55", rotor(|r| r.hub_radius_mm = 55.0), published()),
        ("ring 10 wide", ROTOR, tool(128.576, 10.0)),
        ("ring 20 wide", ROTOR, tool(128.576, 20.0)),
        ("ring of radius 60", ROTOR, tool(60.0, 15.874)),
    ]
}

/// Points of the finished faces about a slot, slot frame: both blades and others beside them.
fn surface(blisk: &Blisk, turn: &Rotation3<f64>) -> Vec<Point> {
    let grid = |face: &Face| -> Vec<Point> {
        let at = |k: u32, count: u32| f64::from(k) / f64::from(count);
        (0..=80).flat_map(|i| (0..=40).map(move |j| [at(i, 80), at(j, 40)])).map(|[u, v]| face.point(u, v)).collect()
    };
    let blades = (-2..=2).map(|k| blisk.blade(k));
    let points = blades.flat_map(|blade| [grid(&blade.pressure), grid(&blade.suction)].concat());
    points.map(|point| turn * point).collect()
}

/// The least distance of the ring from points, over poses half a millimetre apart. Far points are excluded by squares.
fn sampled_mm(plan: &SlotPlan, tool: &CupMill, points: &[Point]) -> f64 {
    let near = |radius_mm: f64, by_mm: f64| (radius_mm + by_mm) * (radius_mm + by_mm);
    let (within, without) = (near(tool.inner_radius_mm, -3.0), near(tool.outer_radius_mm, 3.0));
    let mut least_mm = f64::INFINITY;
    for pose in plan.path.steps().iter().flat_map(|step| poses(step, 0.5)) {
        for point in points.iter().filter(|point| point.z > pose.z - 3.0) {
            let square = (point.xy() - pose.xy()).norm_squared();
            if (within..without).contains(&square) {
                least_mm = least_mm.min(tool.distance_of_mm(ToolPart::Ring, libm::sqrt(square), point.z - pose.z));
            }
        }
    }
    least_mm
}

/// Proven clearances of the ring from the finished blades.
pub fn proven_mm(blisk: &Blisk, plan: &SlotPlan, tool: &CupMill) -> [f64; 2] {
    let case = ProofCase {
        blisk,
        tool,
        path: &plan.path,
        to_slot: plan.turn,
        allowance_mm: ALLOWANCE_MM,
        fixture: &[],
        earlier: &[],
    };
    let bodies = bodies(&case, CHORD_MM);
    let blades = bodies.iter().find(|body| body.obstacle == Obstacle::Blades).expect("blades");
    clearance(tool, ToolPart::Ring, &plan.path.steps(), blades, GAP_MM).bounds_mm
}

/// The most room that a ring has anywhere: over directions of the tool and places of its axis, by a search that tries steps of a half, in
/// four dimensions, from many starts. The sides count between their round edges, where they are above the hub, all with the allowance.
struct Room {
    pressure: Vec<Point>,
    suction: Vec<Point>,
    radii_mm: [f64; 2],
    about: Vector,
}

impl Room {
    fn new(blisk: &Blisk, tool: &CupMill) -> Self {
        let slot = blisk.slot();
        let grid = |face: &Face| -> Vec<Point> {
            let at = |k: u32| f64::from(k) / 16.0;
            let places =
                (0..=16).flat_map(|i| (0..=16).map(move |j| [ROUND_RATIO + (1.0 - 2.0 * ROUND_RATIO) * at(i), at(j)]));
            let points = places.map(|[u, v]| face.offset(u, v, ALLOWANCE_MM));
            points.filter(|point| blisk.hub.height_mm(point) >= ALLOWANCE_MM).collect()
        };
        let (pressure, suction) = (grid(&slot.pressure), grid(&slot.suction));
        let sum = pressure.iter().chain(&suction).map(|point| point.coords).sum::<Vector>();
        let radii_mm = [tool.outer_radius_mm, tool.inner_radius_mm];
        Room { pressure, suction, radii_mm, about: Vector::new(sum.x, sum.y, 0.0).normalize() }
    }

    /// Room for a tool leaned about the slot's middle and tilted along the rotor's axis, its axis seen along itself at a place.
    fn at_mm(&self, [lean, tilt, x, y]: [f64; 4]) -> f64 {
        let aside = Vector::z().cross(&self.about);
        let axis = (self.about + aside * lean + Vector::z() * tilt).normalize();
        let across = Vector::z().cross(&axis).normalize();
        let up = axis.cross(&across);
        let seen = |point: &Point| Flat::new(point.coords.dot(&across), point.coords.dot(&up));
        let off = |point: &Point| (seen(point) - Flat::new(x, y)).norm();
        let nearest = self.pressure.iter().map(off).fold(f64::INFINITY, f64::min);
        let farthest = self.suction.iter().map(off).fold(0.0, f64::max);
        (nearest - self.radii_mm[0]).min(self.radii_mm[1] - farthest)
    }

    fn most_mm(&self) -> f64 {
        let middle_mm = (self.radii_mm[0] + self.radii_mm[1]) / 2.0;
        // All about the slot, the cup on either side of the ring.
        let starts = (0..24).map(|k| {
            let (sin, cos) = libm::sincos(core::f64::consts::TAU * f64::from(k) / 24.0);
            [0.0, 0.0, middle_mm * cos, middle_mm * sin]
        });
        starts.map(|start| self.climbed_mm(start)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn climbed_mm(&self, start: [f64; 4]) -> f64 {
        let mut random = fastrand::Rng::with_seed(7);
        let (mut at, mut best_mm, mut scale) = (start, self.at_mm(start), 1.0);
        while scale > 1e-4 {
            let before_mm = best_mm;
            for _ in 0..40 {
                let step = [0.1, 0.1, 8.0, 8.0].map(|most| most * scale * (2.0 * random.f64() - 1.0));
                let place: [f64; 4] = core::array::from_fn(|k| at[k] + step[k]);
                let room_mm = self.at_mm(place);
                if room_mm > best_mm && place[0].abs() < 0.6 && place[1].abs() < 0.6 {
                    (at, best_mm) = (place, room_mm);
                }
            }
            if best_mm <= before_mm {
                scale /= 2.0;
            }
        }
        best_mm
    }
}

/// Removed part of the slot, percent. Every level removes something.
fn taken_percent(blisk: &Blisk, plan: &SlotPlan, tool: &CupMill) -> f64 {
    let walls = SlotWalls::new(&blisk.slot(), &blisk.hub, ALLOWANCE_MM, plan.turn).expect("walls");
    let stock = Stock { blank: &blisk.blank, to_slot: plan.turn, earlier: Earlier::none() };
    let floor = Floor::new(tool, &plan.path.steps());
    let removed = removed(&floor, plan.path.levels.len(), &stock, &walls, 1.0);
    assert!(removed.by_level_mm3.iter().all(|volume_mm3| *volume_mm3 > 0.0), "{:?}", removed.by_level_mm3);
    100.0 * removed.share_ratio()
}

/// A row of the table.
fn row(name: &str, rotor: &Rotor, tool: &CupMill) -> String {
    let blisk = blisk(rotor);
    let room_mm = Room::new(&blisk, tool).most_mm();
    let plan = match plan(&blisk, &blisk.slot(), tool, &ROUGHING) {
        Ok(plan) => plan,
        Err(Infeasible::TooNarrow { missing_mm, .. }) => {
            assert!(room_mm < 0.0, "{name}: a ring has {room_mm} mm of room");
            return format!("| {name} | too narrow | {room_mm:.2} | | | | {missing_mm:.1} mm missing |");
        }
        Err(why) => return format!("| {name} | not this way | {room_mm:.2} | | | | {why} |"),
    };
    let sampled_mm = sampled_mm(&plan, tool, &surface(&blisk, &plan.turn));
    let [low_mm, high_mm] = proven_mm(&blisk, &plan, tool);
    assert!(room_mm > 0.0, "{name}: no ring passes, {room_mm} mm");
    assert!(low_mm > 0.0 && sampled_mm >= low_mm, "{name}: sampled {sampled_mm}, proven {low_mm} mm");
    // Samples of the surface lie 0.4 mm apart.
    assert!(sampled_mm < high_mm + 0.1, "{name}: sampled {sampled_mm}, found {high_mm} mm");
    format!(
        "| {name} | planned | {room_mm:.2} | {sampled_mm:.3} | {low_mm:.3} | {:.0} | {} levels |",
        taken_percent(&blisk, &plan, tool),
        plan.path.levels.len()
    )
}

#[test]
fn twenty_rotors_from_easy_to_impossible() {
    let file = arcfeed_tests::root().join("docs/plan-parts.md");
    let page = std::fs::read_to_string(&file).expect("the page");
    let rows: Vec<String> = parts().iter().map(|(name, rotor, tool)| row(name, rotor, tool) + "\n").collect();
    rows.iter().for_each(|row| print!("{row}"));
    let (before, table) = page.split_once("|---|---|---|---|---|---|---|\n").expect("a table");
    let behind = &table[table.find("\n\n").expect("its end") + 1..];
    let made = format!("{before}|---|---|---|---|---|---|---|\n{}{behind}", rows.concat());
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&file, &made).expect("it can be written");
    }
    assert_eq!(
        std::fs::read_to_string(&file).expect("the page"),
        made,
        "run with UPDATE_GOLDEN=1 and read the difference"
    );
    assert_eq!(rows.len(), 20);
}
