//! A pocket with the contour law on LinuxCNC: the feed of the edge on inside arcs, from the positions alone.

use std::fs;

use arcfeed_tests::root;

use super::machine::Machine;
use super::run::{Run, Sample};

/// Contour radius of the corners and the tool's radius, mm.
const CONTOUR_MM: f64 = 8.0;
const TOOL_MM: f64 = 5.0;
/// Feed of the edge that the job asks for, mm/min: 0.1 mm, 4 teeth, 8000 rev/min.
const EDGE_MM_PER_MIN: f64 = 3_200.0;

/// Feed of the edge at a corner: that of the centre on its circle, times contour radius over centre radius.
fn edge_feeds(samples: &[Sample], center: [f64; 2]) -> Vec<f64> {
    let radius = CONTOUR_MM - TOOL_MM;
    let is_on_arc = |sample: &Sample| {
        let [x, y, _] = sample.position_mm;
        let (dx, dy) = (x - center[0], y - center[1]);
        dx > 1e-3 && dy < -1e-3 && (libm::hypot(dx, dy) - radius).abs() < 1e-3
    };
    let on_arc: Vec<&Sample> = samples.iter().filter(|sample| is_on_arc(sample)).collect();
    let angle = |sample: &Sample| libm::atan2(sample.position_mm[1] - center[1], sample.position_mm[0] - center[0]);
    on_arc
        .windows(2)
        .map(|pair| (angle(pair[1]) - angle(pair[0])) / (pair[1].time_s - pair[0].time_s) * CONTOUR_MM * 60.0)
        .collect()
}

#[test]
fn the_edge_keeps_its_feed_on_inside_arcs_on_linuxcnc() {
    let Some(machine) = Machine::or_skip("linuxcnc-pocket") else { return };
    for file in ["pocket.nc", "job-contour.toml"] {
        fs::copy(root().join("examples/pocket").join(file), machine.path(file)).expect("the example");
    }
    let text = fs::read_to_string(machine.path("job-contour.toml")).expect("the job");
    for mode in ["rewrite-only", "safe-base"] {
        let job = machine.path("job.toml");
        fs::write(&job, format!("{text}\n[override]\nmode = \"{mode}\"\n")).expect("a file");
        machine.adapt(&job);
        let ran = machine.run(&Run::whole(mode == "safe-base"));
        let feeds = edge_feeds(&ran.samples, [42.0, -17.0]);
        let (least, most) =
            feeds.iter().fold((f64::MAX, 0.0_f64), |(least, most), feed| (least.min(*feed), most.max(*feed)));
        println!(
            "{mode}: edge feed in the first corner {least:.1} to {most:.1} mm/min of {EDGE_MM_PER_MIN}, {} samples",
            feeds.len()
        );
        let figures = machine.measure(&job, &ran.samples, 1.0);
        println!("{mode}: {}, path {} mm", figures["chip_load"], figures["path_error"]);
        assert!(feeds.len() > 100 && (0.98 * EDGE_MM_PER_MIN..=1.005 * EDGE_MM_PER_MIN).contains(&most), "{mode}");
        assert!(figures["chip_load"]["error_ratio_max_all"].as_f64().expect("a figure") <= 0.005, "{mode}: {figures}");
    }
}
