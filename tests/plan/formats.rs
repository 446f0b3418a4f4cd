//! One rotor in all formats, written by a script that shares nothing with the planner (tests/plan/formats): same geometry, same plan.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use arcfeed::part::PartFile;
use arcfeed_plan::cup_mill::plan::{AxisChoice, SlotPlan};
use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::geometry::flaws::flaws;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::vector::Point;
use arcfeed_tests::{Scratch, root, skip_loudly};

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
    std::fs::copy(root().join("tests/plan/formats/rotor.step"), folder.join("rotor.step")).expect("the file of STEP");
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
