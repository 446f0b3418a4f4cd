//! Arcs by R of both signs, full circles and helices in G17, G18 and G19, both senses, from the text to the axes: through
//! `check`, `adapt` and `simulate`, against ends, angles and times worked out by hand.
//!
//! Each move starts from rest and ends in a dwell, so that its time has a closed form: with L the arc in the plane, F the
//! feed and s the path over the arc, L/F + s F/a (the tool runs at s F).

use std::f64::consts::FRAC_PI_2;

use arcfeed::adapt::adapt;
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_control::Control;
use arcfeed_control::dynamics::Dynamics;
use arcfeed_nc::block::Reading;
use arcfeed_nc::modal::Plane;
use arcfeed_tests::{Scratch, run};
use arcfeed_units::{Micros, Nm};
use serde_json::Value;

const TICK: Micros = Micros::from_ms(1);
const DWELL_S: f64 = 0.1;
/// mm/s: F600, and 1500 rev/min with 4 teeth of 0.1 mm.
const FEED: f64 = 10.0;
const TOOL_RADIUS: f64 = 5.0;
/// An end mill inside every counter-clockwise arc: the centre runs at F q/(q + r).
const JOB: &str = "units = \"mm\"\nprogram = \"p.nc\"\n[tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\n\
    [spindle]\nrev_per_min = 1500\nset_by = \"operator\"\n[limits]\nmax_feed = \"90000 mm\"\nmax_raise = 100\n[law]\nkind = \"contour\"\nfeed_per_tooth = 0.1\n\
    [[cut]]\nmoves = \"arcs\"\ndirection = \"ccw\"\nside = \"inside\"\nradial_depth = 1.0\n\
    [control]\npreset = \"fanuc-16i\"\n";

/// A move: its words; where it ends (X, Y, Z), about what it turns and on which radius (in the plane), by how many
/// quarters (counter-clockwise positive), how far it moves across the plane.
type Move = (&'static str, [f64; 3], [f64; 2], f64, i32, f64);

const MOVES: [(Plane, &[Move]); 3] = [
    (
        Plane::Xy,
        &[
            ("G17G3X20.Y20.R20.", [20.0, 20.0, 0.0], [0.0, 20.0], 20.0, 1, 0.0),
            ("G3X0Y0R-20.", [0.0, 0.0, 0.0], [0.0, 20.0], 20.0, 3, 0.0),
            ("G2X15.Y15.R15.", [15.0, 15.0, 0.0], [15.0, 0.0], 15.0, -1, 0.0),
            ("G2X0Y0R-15.I99.", [0.0, 0.0, 0.0], [15.0, 0.0], 15.0, -3, 0.0),
            ("G3I20.", [0.0, 0.0, 0.0], [20.0, 0.0], 20.0, 4, 0.0),
            ("G2J-45.", [0.0, 0.0, 0.0], [0.0, -45.0], 45.0, -4, 0.0),
            ("G3X-40.Z-10.I-20.", [-40.0, 0.0, -10.0], [-20.0, 0.0], 20.0, 2, -10.0),
            ("G2I15.Z0.", [-40.0, 0.0, 0.0], [-25.0, 0.0], 15.0, -4, 10.0),
        ],
    ),
    (
        // First axis Z, second X.
        Plane::Zx,
        &[
            ("G18G3X-20.Z20.R20.", [-20.0, 0.0, 20.0], [0.0, -20.0], 20.0, 1, 0.0),
            ("G2X-40.Z0R-20.", [-40.0, 0.0, 0.0], [20.0, -40.0], 20.0, -3, 0.0),
            ("G2K15.Y8.", [-40.0, 8.0, 0.0], [15.0, -40.0], 15.0, -4, 8.0),
            ("G3Z-40.K-20.Y0.", [-40.0, 0.0, -40.0], [-20.0, -40.0], 20.0, 2, -8.0),
        ],
    ),
    (
        Plane::Yz,
        &[
            ("G19G3Y20.Z-20.R20.", [-40.0, 20.0, -20.0], [0.0, -20.0], 20.0, 1, 0.0),
            ("G2Y0Z-40.R-20.", [-40.0, 0.0, -40.0], [20.0, -40.0], 20.0, -3, 0.0),
            ("G3J5.", [-40.0, 0.0, -40.0], [5.0, -40.0], 5.0, 4, 0.0),
            ("G2Y30.J15.X-30.", [-30.0, 30.0, -40.0], [15.0, -40.0], 15.0, -2, 10.0),
            ("G3Y-15.Z5.R45.X-40.", [-40.0, -15.0, 5.0], [-15.0, -40.0], 45.0, 1, -10.0),
        ],
    ),
];

fn moves() -> impl Iterator<Item = (Plane, &'static Move)> {
    MOVES.iter().flat_map(|(plane, moves)| moves.iter().map(|one| (*plane, one)))
}

fn program() -> String {
    let blocks: String = moves()
        .enumerate()
        .map(|(at, (_, (words, ..)))| format!("N{}{words}\nG4X{DWELL_S}\n", 10 * (at + 1)))
        .collect();
    format!("%\nO1\nG21G90G94F600.\nG92X0Y0\n{blocks}M30\n%\n")
}

fn job(scratch: &Scratch) -> String {
    scratch.write("p.nc", program());
    scratch.write("job.toml", JOB)
}

/// Length of the arc in its plane, mm; path over arc; the feed as adapted, mm/s: only arcs across the tool's axis are governed.
fn worked_out(plane: Plane, (_, _, _, radius, quarters, rise): &Move) -> (f64, f64, f64) {
    let length = radius * FRAC_PI_2 * f64::from(quarters.abs());
    let is_governed = *quarters > 0 && plane == Plane::Xy && *rise == 0.0;
    let governed = if is_governed { radius / (radius + TOOL_RADIUS) } else { 1.0 };
    (length, libm::hypot(length, *rise) / length, FEED * governed)
}

/// From rest to rest, with its dwell, s.
fn time_s(plane: Plane, one: &Move, feed: f64) -> f64 {
    let (length, stretch, _) = worked_out(plane, one);
    length / feed + stretch * feed / Dynamics::default().acceleration_mm_per_s2 + DWELL_S
}

#[test]
fn check_takes_them_all_and_counts_the_helices() {
    let scratch = Scratch::new("helices-check");
    job(&scratch);
    let output = run(&["check", "--json", "--strict", &scratch.path("p.nc")]);
    let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let helices = moves().filter(|(_, one)| one.5 != 0.0).count();
    assert_eq!(report["errors"], Value::Array(vec![]));
    assert_eq!((&report["counts"]["arcs"], &report["counts"]["helices"]), (&17.into(), &helices.into()));
}

#[test]
fn adapt_writes_the_feed_worked_out_for_each_arc_and_helix() {
    let scratch = Scratch::new("helices-adapt");
    let output = run(&["adapt", &job(&scratch), "--json"]);
    let text = String::from_utf8(output.stdout).expect("JSON is text");
    let blocks: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(blocks.len(), moves().count());
    for (block, (plane, one)) in blocks.iter().zip(moves()) {
        let (_, _, feed) = worked_out(plane, one);
        let (wanted, sent) = (feed * 60.0, block["sent_feed"].as_f64().expect("a feed"));
        // F has one decimal and is rounded to the thin side.
        assert!(sent <= wanted && sent > wanted - 0.101, "{}: F{sent}, not {wanted}", one.0);
        assert_eq!(block["kind"], if one.5 == 0.0 { "arc" } else { "helix" }, "{}", one.0);
        assert_eq!(block["direction"], if one.4 > 0 { "ccw" } else { "cw" }, "{}", one.0);
    }
}

#[test]
fn simulate_takes_the_time_of_the_closed_form_before_and_after() {
    let scratch = Scratch::new("helices-simulate");
    let output = run(&["simulate", &job(&scratch), "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).expect("one object");
    let before: f64 = moves().map(|(plane, one)| time_s(plane, one, FEED)).sum();
    let after: f64 = moves().map(|(plane, one)| time_s(plane, one, worked_out(plane, one).2)).sum();
    for (field, wanted) in [("baseline_cycle_time_s", before), ("cycle_time_s", after)] {
        let found = report[field].as_f64().expect("a time");
        println!("{field}: {found:.3} s, worked out {wanted:.3} s");
        // Two ticks for each move: one until it is taken up, one for what is left of its last.
        assert!((found - wanted).abs() <= 2.0 * TICK.to_s() * moves().count() as f64, "{found} s, not {wanted} s");
    }
}

#[test]
fn over_a_line_the_same_blocks_run() {
    let scratch = Scratch::new("helices-stream");
    let output = run(&["stream", &job(&scratch), "--port", "sim:", "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).expect("one object");
    let wanted: f64 = moves().map(|(plane, one)| time_s(plane, one, worked_out(plane, one).2)).sum();
    let found = report["cycle_time_s"].as_f64().expect("a time");
    assert_eq!((&report["blocks_executed"], &report["alarms"]), (&report["blocks_sent"], &Value::Array(vec![])));
    assert!((found - wanted).abs() <= 2.0 * TICK.to_s() * moves().count() as f64, "{found} s, not {wanted} s");
}

/// The axes at each tick of each block, from the first with it in work to the first at rest behind it.
fn executed() -> Vec<Vec<[f64; 3]>> {
    let scratch = Scratch::new("helices-axes");
    let file = JobFile::load(job(&scratch).as_ref()).expect("a sound job");
    let program = Program::load(&file.program, file.job.unit, Reading::Strict).expect("a program");
    let mut control = Control::from_memory(control_settings(&file), &adapt(&program, &file.job).text);
    let (mut now, mut last, mut blocks) = (Micros(0), None, Vec::<Vec<[f64; 3]>>::new());
    while !control.is_over() {
        let from = control.position().linear.map(Nm::to_mm);
        now = now.after(TICK);
        control.step(now, TICK, 100);
        let active = control.active().map(|(count, _)| count);
        if active.is_some() && active != last {
            blocks.push(vec![from]);
        }
        if (active.is_some() || last.is_some())
            && let Some(block) = blocks.last_mut()
        {
            block.push(control.position().linear.map(Nm::to_mm));
        }
        last = active;
    }
    blocks
}

#[test]
fn the_axes_run_on_the_circles_in_their_sense_evenly_across_and_end_where_programmed() {
    let blocks = executed();
    assert_eq!(blocks.len(), moves().count());
    for (points, (plane, one)) in blocks.iter().zip(moves()) {
        let (words, end, center, radius, quarters, rise) = *one;
        let (first, second, normal) = plane.axes();
        assert_eq!(*points.last().expect("points"), end, "{words}");
        let from_center = |point: &[f64; 3]| [point[first] - center[0], point[second] - center[1]];
        let turn = f64::from(quarters) * FRAC_PI_2;
        let mut turned = 0.0;
        for pair in points.windows(2) {
            let ([x, y], [to_x, to_y]) = (from_center(&pair[0]), from_center(&pair[1]));
            assert!((libm::hypot(to_x, to_y) - radius).abs() < 3e-6, "{words}: {:?} is off the circle", pair[1]);
            turned += libm::atan2(x * to_y - y * to_x, x * to_x + y * to_y);
            let across = pair[1][normal] - points[0][normal];
            assert!((across - rise * turned / turn).abs() < 1e-5, "{words}: {across} mm across after {turned} rad");
        }
        assert!((turned - turn).abs() < 1e-6, "{words}: {turned} rad, not {turn}");
    }
}

#[test]
fn the_arc_in_its_plane_is_run_at_the_feed_and_no_acceleration_along_the_path_is_exceeded() {
    let dt = TICK.to_s();
    let limit = Dynamics::default().acceleration_mm_per_s2;
    for (points, (plane, one)) in executed().iter().zip(moves()) {
        let (first, second, _) = plane.axes();
        let (_, stretch, feed) = worked_out(plane, one);
        let path = |pair: &[[f64; 3]]| {
            let [x, y, z] = [0, 1, 2].map(|axis| pair[1][axis] - pair[0][axis]);
            libm::hypot(libm::hypot(x, y), z) / dt
        };
        let in_plane =
            |pair: &[[f64; 3]]| libm::hypot(pair[1][first] - pair[0][first], pair[1][second] - pair[0][second]) / dt;
        let middle = &points[points.len() / 2..points.len() / 2 + 2];
        assert!((in_plane(middle) / feed - 1.0).abs() < 1e-3, "{}: {} mm/s in the plane", one.0, in_plane(middle));
        assert!((path(middle) / (feed * stretch) - 1.0).abs() < 1e-3, "{}: {} mm/s", one.0, path(middle));
        let speeds: Vec<f64> = points.windows(2).map(path).collect();
        // Positions are whole nanometres: a millionth of a millimetre in a millisecond, twice.
        let steepest = speeds.windows(2).map(|pair| (pair[1] - pair[0]).abs() / dt).fold(0.0, f64::max);
        assert!(steepest <= limit * 1.01, "{}: {steepest} mm/s2", one.0);
    }
}
