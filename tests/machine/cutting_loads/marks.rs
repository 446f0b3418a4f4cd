//! Marks of the teeth on walls: feed marks and runout in closed form, prescribed vibration, and self-excited vibration.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use arcfeed_hil_sim::removal::envelope::CuttingSolid;
use arcfeed_hil_sim::removal::marks::marks;
use arcfeed_hil_sim::removal::tip_path::TipPath;
use arcfeed_hil_sim::removal::trail::BlockRef;
use arcfeed_milling::cutting::edge_engagement::{EdgeEngagement, slices};
use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, EndMill};
use arcfeed_milling::cutting::layer::Layer;
use arcfeed_milling::cutting::layers::Layers;
use arcfeed_milling::cutting::pose::ToolPose;
use arcfeed_tests::{Scratch, run};
use nalgebra::Vector2;
use serde_json::Value;

use crate::cutting_loads::slot_job::{PUBLISHED, Slot, number};

/// Rays stand 0.25 mm apart: with this feed a wall is seen at 47 places of a mark.
const ONE_TOOTH: Slot<'_> = Slot {
    diameter_mm: 10.0,
    teeth: 1,
    rev_per_min: 3000.0,
    feed_mm_per_tooth: 0.47,
    axial_depth_mm: 1.0,
    way_mm: 40.0,
    cutting: "cutting = [600, 200, 0]\nedge = [0, 0, 0]\n",
};

/// The walls that N4 made, which is the slot.
fn of_slot(report: &Value) -> &Value {
    let blocks = report["loads"]["marks"]["blocks"].as_array().expect("a list");
    blocks.iter().find(|block| block["n"] == 4).expect("the slot has walls")
}

#[test]
fn feed_leaves_the_cusps_in_closed_form() {
    let report = ONE_TOOTH.simulation_report("feed-marks");
    let marks = of_slot(&report);
    // Martellotti 1941: f^2 / 8 (R -+ f z / pi), the larger one where the tooth goes against the feed.
    let (feed_mm, radius_mm) = (ONE_TOOTH.feed_mm_per_tooth, 5.0);
    let height_mm = feed_mm * feed_mm / 8.0 / (radius_mm - feed_mm / PI);
    // The top lies between two places, 0.01 mm apart on a slope of half a feed over R; steps of 3 degrees put an edge 5e-5 mm off.
    let missed_mm = 0.005 * feed_mm / 2.0 / radius_mm;
    let found_mm = number(marks, "/max");
    println!("marks of {found_mm:.6} mm, by hand {height_mm:.6}");
    assert!((-missed_mm - 5e-5..5e-5).contains(&(found_mm - height_mm)));
    assert!(number(marks, "/min").abs() < 5e-5);
    let largest = &report["loads"]["marks"]["largest"];
    assert!(number(largest, "/y") < 0.0 && largest["n"] == 4, "{largest}");
    // A parabola's mean square is a fifth of its top's; of both walls.
    let rms_mm = feed_mm * feed_mm / 8.0 / radius_mm / libm::sqrt(5.0);
    let off = number(marks, "/rms") / rms_mm - 1.0;
    println!("root of the mean square off by {off:+.1e}");
    assert!(off.abs() < 0.02);
}

#[test]
fn the_longer_of_two_teeth_makes_both_walls() {
    let slot = Slot {
        teeth: 2,
        feed_mm_per_tooth: 0.235,
        cutting: "cutting = [600, 200, 0]\nedge = [0, 0, 0]\nrunout = { eccentricity = 0.02, direction = 0 }\n",
        ..ONE_TOOTH
    };
    let report = slot.simulation_report("runout-marks");
    let marks = of_slot(&report);
    let (least_mm, most_mm) = (number(marks, "/min"), number(marks, "/max"));
    // One tooth of 5.02 mm, once a turn; the other, 4.98 mm, stays 0.04 mm away.
    let top_mm = 0.47 * 0.47 / 8.0 / 5.02 - 0.02;
    println!("{least_mm:.6} to {most_mm:.6} mm, by hand -0.02 to {top_mm:.6}");
    // Two teeth a turn: Martellotti's term is twice as large as above, 3 %.
    assert!((least_mm + 0.02).abs() < 5e-5 && (most_mm - top_mm).abs() < 0.06 * 0.0055);
}

#[test]
fn a_tool_that_is_moved_sideways_leaves_that_on_both_walls() {
    const RADIUS_MM: f64 = 5.0;
    const FEED_MM: f64 = 0.02;
    const WAY_MM: f64 = 20.0;
    let bent_mm = |x_mm: f64| 0.03 * libm::sin(TAU * x_mm / 7.0);
    let mill = EndMill { diameter_mm: 2.0 * RADIUS_MM, corner_mm: 0.0, teeth: 2, helix_rad: 0.0, height_mm: 1.0 };
    let cutter = Cutter::end_mill(&mill, Pieces::Slices { rise_mm: 1.0 }).expect("a mill");
    let turned = CuttingSolid { slices: slices(&cutter), reach_mm: 1.0 };
    let blank = Layers::alike(&Layer::rectangle([-8.0, -8.0], [36.0, 16.0], 0.23), 0.0, 1.0, 1);
    let mut engagement = EdgeEngagement::new(cutter, blank.clone(), RADIUS_MM / 2.0).expect("layers as high as slices");
    let (mut tip_path, of) = (TipPath::default(), BlockRef { count: 7, sequence: None, rule: None, is_rapid: false });
    let stand = |step: u32| ToolPose {
        axis_mm: Vector2::new(f64::from(step) * FEED_MM / 60.0, 0.0),
        tip_mm: 0.0,
        turned_rad: f64::from(step) * PI / 60.0,
    };
    engagement.clear_at(&stand(0));
    for step in 0..(WAY_MM / FEED_MM * 60.0) as u32 {
        let stand = stand(step);
        engagement.cut(&engagement.poses(&stand), |_| Vector2::new(0.0, bent_mm(stand.axis_mm.x)));
        tip_path.move_to(&of, [stand.axis_mm.x, stand.axis_mm.y, stand.tip_mm]);
    }
    let found = marks(&blank, engagement.layers(), &tip_path, &turned);
    let beside = found.iter().filter(|mark| (1.0..WAY_MM - 1.0).contains(&mark.point_mm.x));
    let (mut count, mut worst_mm) = (0, 0.0_f64);
    for mark in beside.filter(|mark| libm::fabs(mark.point_mm.y) > RADIUS_MM * libm::sin(FRAC_PI_2 * 0.9)) {
        // Bent towards the wall it cuts too deep. The wall is square to the tool's way: (x - R sin a, y + R cos a).
        let side = mark.point_mm.y.signum();
        let lean_rad = |at_mm: f64| side * libm::atan(0.03 * TAU / 7.0 * libm::cos(TAU * at_mm / 7.0));
        let at_mm = (0..9).fold(mark.point_mm.x, |at_mm, _| mark.point_mm.x + RADIUS_MM * libm::sin(lean_rad(at_mm)));
        let expected_mm = RADIUS_MM * (1.0 - libm::cos(lean_rad(at_mm))) - bent_mm(at_mm) * side;
        (count, worst_mm) = (count + 1, worst_mm.max((mark.off_mm - expected_mm).abs()));
        assert_eq!(mark.block.count, 7);
    }
    println!("{count} places, off by {worst_mm:.2e} mm at most");
    // Cusps are f^2 / 8 R = 1e-5 mm high, more where the way bends; steps of 3 degrees put an edge 4e-6 mm off.
    assert!(count > 150 && worst_mm < 3e-5);
}

/// Flexible across the slot.
const ACROSS: Slot<'_> = Slot {
    cutting: "cutting = [600, 200, 0]\nedge = [0, 0, 0]\n\
        modes = [{ frequency = 922, damping = 0.011, stiffness = 1340.05, direction = [0, 1, 0] }]\n",
    ..PUBLISHED
};

#[test]
fn chatter_is_in_the_walls_and_a_steady_cut_is_not() {
    let marks = |slot: &Slot<'_>, name: &str| {
        let report = slot.simulation_report(name);
        let of_slot = of_slot(&report);
        (number(of_slot, "/max").max(-number(of_slot, "/min")), report["loads"]["vibration"].clone())
    };
    let (steady_mm, vibration) = marks(&ACROSS, "steady-marks");
    assert_eq!(vibration["unstable"], serde_json::json!([]));
    let floor_mm = number(&vibration, "/floor");
    let (chatter_mm, vibration) = marks(&Slot { axial_depth_mm: 0.6, ..ACROSS }, "chatter-marks");
    assert_eq!(vibration["unstable"][0]["verdict"], "chatter");
    let metric_mm = number(&vibration, "/metric_max");
    println!("steady {steady_mm:.6} mm; chatter {chatter_mm:.6} mm, from tooth to tooth {metric_mm:.6}");
    // Places that differ by M in the mean from tooth to tooth have an amplitude of about that.
    assert!(steady_mm < 0.1 * floor_mm && (0.5 * metric_mm..2.0 * metric_mm).contains(&chatter_mm));
}

#[test]
fn the_page_shows_where() {
    let scratch = Scratch::new("marks-page");
    let (job, program) = Slot { axial_depth_mm: 0.6, ..ACROSS }.texts();
    scratch.write("program.nc", program);
    let page = scratch.path("run.html");
    let output = run(&["simulate", &scratch.write("job.toml", job), "--report", &page]);
    assert!(output.status.success());
    let html = std::fs::read_to_string(page).expect("a page");
    let words = String::from_utf8(output.stdout).expect("text");
    assert!(words.contains("marks on walls, mm: before -0.0") && words.contains(" by N4 (chatter)"), "{words}");
    let parts =
        ["<h2>Marks on walls, seen along Z</h2>", "largest: -0.0", "<td>N4</td><td>chatter, ", "N4: chip load 0."];
    for part in parts {
        assert!(html.contains(part), "{part}");
    }
    assert!(html.contains("of the target, chatter</title>"));
}
