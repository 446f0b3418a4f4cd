//! One rotor in all formats, written by a script that shares nothing with the planner (tests/plan/formats): same geometry, same plan.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use arcfeed::part::PartFile;
use arcfeed_plan::cup_mill::plan::{AxisChoice, SlotPlan};
use arcfeed_plan::geometry::blisk::{Blade, Blisk};
use arcfeed_plan::geometry::flaws::flaws;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::vector::{Flat, Point, Vector};
use arcfeed_tests::{Scratch, root, skip_loudly};
use nalgebra::Rotation3;

/// Largest difference of two plans, and of two surfaces, mm.
const PLAN_MM: f64 = 0.01;

/// Part but for its geometry. The blank is higher than the blades: where a level grazes the tips, its turn ends at a touching circle, and
/// a micrometre of the surface is a twentieth of a millimetre along the path.
const PART: &str = r#"units = "mm"
[blank]
radius = 103
from = -14
to = 14
[cutter]
outer_radius = 125.8
inner_radius = 116.8
insert_radius = 0.762
active_teeth = 10
cavity_depth = 38.1
height = 50.8
[roughing]
allowance = 0.889
axial_depth_max = 2.54
axis = "blade"
rev_per_min = 100
feed_per_tooth = 0.1
[geometry]
"#;

/// Folder with the rotor's files, or `None` where no Python is.
pub fn folder() -> Option<PathBuf> {
    static FOLDER: OnceLock<Option<Scratch>> = OnceLock::new();
    let written = FOLDER.get_or_init(|| {
        let folder = Scratch::new("plan-formats");
        let script = root().join("tests/plan/formats/rotor_formats.py");
        let mut python = Command::new("python3");
        let ran = python.env("PYTHONDONTWRITEBYTECODE", "1").arg(script).arg(folder.path(".")).status();
        match ran {
            Ok(status) => {
                assert!(status.success(), "rotor_formats.py failed");
                Some(folder)
            }
            Err(_) => {
                skip_loudly("plan formats", "no Python");
                None
            }
        }
    });
    written.as_ref().map(|folder| PathBuf::from(folder.path("")))
}

/// Rotor of a geometry in the folder.
fn rotor(folder: &Path, geometry: &str) -> PartFile {
    PartFile::parse(&folder.join("PART.toml"), &format!("{PART}{geometry}\n")).unwrap_or_else(|error| panic!("{error}"))
}

fn plan(part: &PartFile) -> SlotPlan {
    let slot = part.blisk.slot();
    let problem = Problem::new(&part.blisk, &slot, &part.cutter, &part.roughing).expect("a problem");
    problem.along(AxisChoice::Blade).expect("a plan").plan
}

/// Places that make up a path, slot frame.
fn places(plan: &SlotPlan) -> Vec<Point> {
    let flat = [plan.path.exterior, plan.path.interior, plan.path.base];
    let levels = plan.path.levels.iter().flat_map(|level| {
        [level.exterior_end, level.interior_end].map(|end| Point::new(end.x, end.y, level.height_mm))
    });
    let tips = [plan.blade_axis.tip, plan.blade_axis.foot];
    flat.iter().map(|at| Point::new(at.x, at.y, 0.0)).chain(levels).chain(tips).collect()
}

/// Largest distance of the surfaces of two rotors: from points of one to the nearest of the other's along its normal.
fn apart_mm(one: &Blisk, other: &Blisk) -> f64 {
    let faces = [(&one.pressure, &other.pressure), (&one.suction, &other.suction)];
    let each = faces.into_iter().flat_map(|(from, to)| {
        let at = |i: i32, j: i32| [f64::from(i) / 40.0, f64::from(j) / 16.0];
        let places = (0..=40).flat_map(move |i| (0..=16).map(move |j| at(i, j)));
        places.map(move |[u, v]| {
            let point = from.point(u, v);
            // Newton's steps for the foot of the perpendicular.
            let [mut s, mut t] = [u, v];
            for _ in 0..30 {
                let jet = to.jet(s, t);
                let off = point - jet.point;
                let [e, f, g] = [jet.u.dot(&jet.u), jet.u.dot(&jet.v), jet.v.dot(&jet.v)];
                let [a, b] = [off.dot(&jet.u), off.dot(&jet.v)];
                let det = e * g - f * f;
                s = (s + (a * g - b * f) / det).clamp(0.0, 1.0);
                t = (t + (e * b - f * a) / det).clamp(0.0, 1.0);
            }
            (point - to.point(s, t)).norm()
        })
    });
    each.fold(0.0, f64::max)
}

#[test]
fn the_same_rotor_in_every_format_gives_the_same_plan() {
    let Some(folder) = folder() else { return };
    let formats = [
        ("points", "sections = { file = \"table.csv\", blades = 19, hub = \"hub.curve\" }"),
        ("polar, mm, degrees", "sections = { file = \"polar.csv\", blades = 19, hub = \"hub.curve\" }"),
        ("polar, inches, radians", "sections = { file = \"polar-inch.txt\", blades = 19, hub = \"hub.curve\" }"),
        (
            "TurboGrid's curves",
            "curves = { hub = \"hub.curve\", shroud = \"shroud.curve\", profile = \"profile.curve\", blades = 19 }",
        ),
        ("binary STL", "stl = { blade = \"blade.stl\", hub = \"hub.stl\", blades = 19 }"),
        ("ASCII STL", "stl = { blade = \"blade-ascii.stl\", hub = \"hub.curve\", tip_radius = 98.6, blades = 19 }"),
        (
            "STEP",
            "step = { file = \"rotor.step\", blade = [\"red\"], hub_faces = [\"HUB\"], tip_radius = 98.6, blades = 19 }",
        ),
    ];
    let parts = formats.map(|(name, geometry)| (name, rotor(&folder, geometry)));
    let truth = plan(&parts[0].1);
    for (name, part) in &parts {
        assert_eq!(flaws(&part.blisk, part.roughing.allowance_mm), [], "{name}");
        let planned = plan(part);
        let (ours, theirs) = (places(&planned), places(&truth));
        assert_eq!(ours.len(), theirs.len(), "{name}");
        let off_mm = ours.iter().zip(&theirs).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        let surface_mm = apart_mm(&part.blisk, &parts[0].1.blisk).max(apart_mm(&parts[0].1.blisk, &part.blisk));
        println!(
            "{name}: surfaces {surface_mm:.5} mm apart at most, plans {off_mm:.5} mm, {} levels",
            planned.path.levels.len()
        );
        assert!(off_mm < PLAN_MM && surface_mm < PLAN_MM, "{name}");
    }
}

#[test]
fn splitters_of_stl_and_step_are_the_turned_copies_that_the_files_have() {
    let Some(folder) = folder() else { return };
    for (name, geometry) in [
        ("STL", "stl = { blade = \"blade.stl\", splitter = \"splitter.stl\", hub = \"hub.stl\", blades = 9 }"),
        (
            "STEP",
            "step = { file = \"with-splitter.step\", blade = [\"red\"], splitter = [\"green\"], hub_faces = [\"HUB\"], \
             tip_radius = 98.6, blades = 9 }",
        ),
    ] {
        let part = rotor(&folder, geometry);
        let [splitter] = part.blisk.further_blades.as_slice() else { panic!("{name}: no splitter") };
        let back = Rotation3::from_axis_angle(&Vector::z_axis(), -core::f64::consts::PI / 9.0);
        let Blade { pressure, suction } = splitter.turned(&back);
        let turned = Blisk { pressure, suction, ..part.blisk.clone() };
        let surface_mm = apart_mm(&turned, &part.blisk).max(apart_mm(&part.blisk, &turned));
        println!("{name}: splitter {surface_mm:.6} mm from the main blade's copy at most");
        assert!(surface_mm < PLAN_MM, "{name}");
    }
}

/// Distance of a point from the filleted rotor in closed form, mm: a quarter of a circle of 2 mm between each section's outline and the hub.
fn off_fillet_mm(point: &Point) -> f64 {
    const FILLET_MM: f64 = 2.0;
    let mixed = |root: f64, tip: f64, share: f64| root + (tip - root) * share;
    let radius_mm = libm::hypot(point.x, point.y);
    let hub_mm = 70.0 + 0.03 * point.z;
    let share = (radius_mm - hub_mm) / (98.6 - hub_mm);
    let height_mm = 28.6 * share;
    let (sin, cos) = libm::sincos(mixed(28.0, 42.0, share).to_radians());
    let around_mm = libm::atan2(point.y, point.x) * radius_mm;
    let seen = Flat::new(point.z * cos + around_mm * sin, point.z * sin - around_mm * cos);
    let outline = |k: i32| {
        let (sin, cos) = libm::sincos(core::f64::consts::TAU * f64::from(k) / 8000.0);
        let thickness_mm = mixed(3.2, 2.2, share) / 2.0;
        Flat::new(12.0 * cos, mixed(1.4, 1.0, share) * sin * sin + thickness_mm * sin)
    };
    let beside = |k: i32| {
        let (from, to) = (outline(k), outline(k + 1));
        let along = to - from;
        let part = ((seen - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (seen - from - along * part).norm()
    };
    let off_mm = (0..8000).map(beside).fold(f64::INFINITY, f64::min);
    if height_mm < FILLET_MM {
        (libm::hypot(FILLET_MM - off_mm, FILLET_MM - height_mm) - FILLET_MM).abs()
    } else {
        off_mm
    }
}

#[test]
fn a_fillet_at_the_root_belongs_to_the_finished_surface() {
    let Some(folder) = folder() else { return };
    let part = rotor(&folder, "stl = { blade = \"filleted.stl\", hub = \"hub.stl\", blades = 19 }");
    assert_eq!(flaws(&part.blisk, part.roughing.allowance_mm), []);
    let places = (0..=40).flat_map(|i| (0..=40).map(move |j| [f64::from(i) / 40.0, f64::from(j) / 40.0]));
    let of_faces = |[u, v]: [f64; 2]| [&part.blisk.pressure, &part.blisk.suction].map(|face| face.point(u, v));
    let worst_mm = places.flat_map(of_faces).map(|point| off_fillet_mm(&point)).fold(0.0, f64::max);
    println!("{worst_mm:.4} mm off the blade with its fillet at most");
    assert!(worst_mm < 0.015);
}
