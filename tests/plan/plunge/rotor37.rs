//! Plunge plans of NASA's rotor 37: the workpiece after them in dexels, and their program on the simulated control.

use arcfeed_plan::cup_mill::side::edges;
use arcfeed_plan::output::plunge_nc::{PlungeFeeds, plunging_min};
use arcfeed_plan::plunge::line::Fit;
use arcfeed_plan::plunge::machinability::SideMeasures;
use arcfeed_plan::plunge::mill::PlungeMill;
use arcfeed_plan::plunge::passage::PlungeRequirements;
use arcfeed_plan::plunge::proof;
use arcfeed_tests::{Scratch, of_full_set, run};

use super::executed::assert_streamed;
use super::stock::{Planned, check};
use crate::rotor37::{Row, blisk, curve_files, side, surfaces};

/// Radius of a mill, allowance, and cusp, mm: the plans of docs/plunge.md.
type Mill = [f64; 3];
const MILLS: [Mill; 4] = [[4.0, 0.5, 0.4], [4.0, 0.4, 0.1], [3.0, 0.4, 0.1], [2.0, 0.4, 0.1]];

fn planned(surfaces: &[Vec<Row>], [radius_mm, allowance_mm, cusp_mm]: Mill) -> Planned {
    let mill = PlungeMill {
        radius_mm,
        corner_radius_mm: 0.4,
        core_radius_mm: 0.0,
        width_max_mm: radius_mm,
        length_mm: 90.0,
        neck_mm: Vec::new(),
        holder_mm: vec![[20.0, 60.0]],
        teeth: 3,
    };
    let needs = PlungeRequirements { allowance_mm, cusp_mm, fit: Fit::Gap, clearance_mm: 5.0, relief_mm: 0.2 };
    Planned::of(blisk(surfaces), mill, needs)
}

/// Part file of the same plan, with the curve files beside it.
fn write_part(scratch: &Scratch, surfaces: &[Vec<Row>], [radius_mm, allowance_mm, cusp_mm]: Mill) -> String {
    let [hub, shroud, profile] = curve_files(surfaces);
    for (name, text) in [("hub.curve", hub), ("shroud.curve", shroud), ("profile.curve", profile)] {
        scratch.write(name, text);
    }
    let diameter_mm = 2.0 * radius_mm;
    scratch.write(
        "PART.toml",
        format!(
            r#"units = "mm"
name = "rotor-37"

[geometry]
curves = {{ hub = "hub.curve", shroud = "shroud.curve", profile = "profile.curve", blades = 36, axis = "x", units = "m" }}

[blank]
radius = 253.0
from = -5.0
to = 50.0

[roughing]
allowance = {allowance_mm}
rev_per_min = 2000
feed_per_tooth = 0.04
approach_feed = 2000

[plunge]
diameter = {diameter_mm}
corner_radius = 0.4
teeth = 3
length = 90.0
holder = [[20.0, 60.0]]
cusp = {cusp_mm}

[machine]
preset = "mitsui-seiki-hu80a-5x"
"#
        ),
    )
}

/// Holds the axes of a plan to the points of the published table, and its clearances to the proof.
fn check_axes(planned: &Planned, surfaces: &[Vec<Row>], [radius_mm, allowance_mm, _]: Mill) {
    let (blisk, plan, needed_mm) = (&planned.blisk, &planned.plan, radius_mm + allowance_mm);
    let proof = proof::prove(blisk, &planned.mill, &plan.plunges, allowance_mm, &[]);
    // Points of the table itself, not of the faces.
    let pitch_rad = core::f64::consts::TAU / 36.0;
    let blades = [0.0, pitch_rad].map(|turn| [side(surfaces, 2, turn), side(surfaces, 3, turn)].concat()).concat();
    let places =
        plan.plunges.iter().flat_map(|plunge| (0..8).map(move |k| plunge.tip + plunge.axis * (9.0 * f64::from(k))));
    let near_mm = places.map(|place| blades.iter().map(|at| (at - place).norm()).fold(f64::INFINITY, f64::min));
    let near_mm = near_mm.fold(f64::INFINITY, f64::min);
    let (planes, plunges) = (plan.planes.len(), plan.plunges.len());
    let lift_mm = plan.plunges.iter().map(|plunge| plunge.lift_mm).fold(0.0, f64::max);
    println!(
        "{planes} planes, {plunges} plunges, lift up to {lift_mm:.2} mm; axes {near_mm:.4} mm from the table's points"
    );
    let feeds = PlungeFeeds { plunge_mm_per_min: 240.0, approach_mm_per_min: 2000.0 };
    println!("{:.1} min a passage at 240 mm/min", plunging_min(&plan.plunges, &feeds));
    for face in [&blisk.pressure, &blisk.suction] {
        let SideMeasures { twist_rad, bend_rad, sag_mm, depth_mm, .. } = SideMeasures::new(face, edges(face));
        let [twist_deg, bend_deg] = [twist_rad, bend_rad].map(|[by_curvature, _]| by_curvature.to_degrees());
        println!("twist {twist_deg:.1}, bend {bend_deg:.1} degrees, sag {sag_mm:.2}, depth {depth_mm:.1} mm");
    }
    assert!(proof.holds(), "{proof:?}");
    assert!(near_mm > needed_mm - 0.01 && plan.planes.iter().all(|plane| plane.step_ratio <= 1.0));
}

#[test]
fn a_plunge_mill_bores_out_a_passage_of_rotor_37_and_the_dexels_have_allowance_no_pillar_and_the_volume_of_points() {
    let Some(surfaces) = surfaces() else { return };
    for mill in of_full_set(&MILLS[..], &MILLS[..1]) {
        println!("mill of {} mm, allowance and cusp {:?}", 2.0 * mill[0], &mill[1..]);
        let planned = planned(&surfaces, *mill);
        check_axes(&planned, &surfaces, *mill);
        check(&planned);
    }
    // The programs of impeller-13 and blisk-19 are streamed in every run (`command`).
    if of_full_set(true, false) {
        stream(&surfaces);
    }
}

/// Plans by the command, and streams the program to the simulated control.
fn stream(surfaces: &[Vec<Row>]) {
    let scratch = Scratch::new("plunge-rotor-37");
    let (part, folder) = (write_part(&scratch, surfaces, MILLS[0]), scratch.path("out"));
    let output = run(&["plan", "plunge", &part, "-o", &folder]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_streamed(&folder, "rotor-37");
}
