//! Jobs of a few lines, and what `simulate --json` says of their loads.

use std::f64::consts::TAU;

use arcfeed_tests::{Scratch, run};
use serde_json::Value;

/// A mill in a block, its tool table and `[cutting]` to be filled in.
#[derive(Clone, Copy, Debug)]
pub struct Slot<'a> {
    pub diameter_mm: f64,
    pub teeth: usize,
    pub rev_per_min: f64,
    pub feed_mm_per_tooth: f64,
    pub axial_depth_mm: f64,
    pub way_mm: f64,
    /// Lines of `[cutting]` but the axial depth.
    pub cutting: &'a str,
}

/// Set A of the published benchmarks, at 5000 rev/min: a slot of 0.409 mm is at its limit. So large that its teeth go in circles, as
/// those of the theory do. The mode is not included.
pub const PUBLISHED: Slot<'_> = Slot {
    diameter_mm: 100.0,
    teeth: 2,
    rev_per_min: 5000.0,
    feed_mm_per_tooth: 0.02,
    axial_depth_mm: 0.3,
    way_mm: 4.0,
    cutting: "cutting = [600, 200, 0]\nedge = [0, 0, 0]\n",
};

impl Slot<'_> {
    /// Along X in the middle of a block, from a plunge.
    pub fn simulation_report(&self, name: &str) -> Value {
        let (job, program) = self.texts();
        simulation_report(name, &job, &program)
    }

    /// Texts of its job and its program.
    pub fn texts(&self) -> (String, String) {
        let Slot { diameter_mm, teeth, rev_per_min, axial_depth_mm, way_mm, .. } = *self;
        let feed = self.feed_mm_per_tooth * teeth as f64 * rev_per_min;
        let beside_mm = diameter_mm / 2.0 + 2.0;
        let job = format!(
            "units = \"mm\"\nprogram = \"program.nc\"\n\
             [tool]\nkind = \"end-mill\"\ndiameter = {diameter_mm}\nteeth = {teeth}\nheight = {axial_depth_mm}\n\
             [workpiece]\nblock = {{ from = [{0}, {0}, -9], to = [{1}, {beside_mm}, 0] }}\nstep = 0.25\n\
             [cutting]\naxial_depth = {axial_depth_mm}\n{2}\
             [spindle]\nrev_per_min = {rev_per_min}\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n",
            -beside_mm,
            beside_mm + way_mm,
            self.cutting
        );
        // A plunge that ends without a dwell of a turn leaves a step in the wall where it ended.
        let program = format!(
            "%\nG21G17G90G94\nN1G0X.013Y.021\nN2G0Z5.\nN3G1Z-{axial_depth_mm:.3}F400.\nG4P100\nN4G1X{:.3}F{feed:.3}\nN5G0Z5.\n\
             N6G1X0.F9000.\nN7M30\n%\n",
            way_mm + 0.013
        );
        (job, program)
    }
}

/// Report of a job.
#[track_caller]
pub fn simulation_report(name: &str, job: &str, program: &str) -> Value {
    let (code, report, complaints) = ran(name, job, program);
    assert_eq!((code, complaints.as_str()), (Some(0), ""));
    serde_json::from_str(&report).expect("one object")
}

/// Exit code, standard output and what went wrong.
pub fn ran(name: &str, job: &str, program: &str) -> (Option<i32>, String, String) {
    let scratch = Scratch::new(&format!("loads-{name}"));
    scratch.write("program.nc", program);
    let output = run(&["simulate", &scratch.write("job.toml", job), "--json"]);
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// Loads of a block.
#[track_caller]
pub fn block(report: &Value, n: i64) -> &Value {
    let blocks = report["loads"]["blocks"].as_array().expect("a list");
    &blocks.iter().find(|block| block["n"].as_i64() == Some(n)).expect("the block")["load"]
}

/// A number in it.
#[track_caller]
pub fn number(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {pointer} in {value}"))
}

/// A figure is what it is by hand, but for a relative tolerance.
#[track_caller]
pub fn assert_near(name: &str, found: f64, expected: f64, tolerance: f64) {
    let off = found / expected - 1.0;
    println!("{name}: {found:.5}, by hand {expected:.5}: {off:+.1e}");
    assert!(off.abs() <= tolerance, "{name}");
}

/// A job with one text in place of another is refused, with these words.
pub fn assert_refused(name: &str, job: &str, mistakes: &[(&str, &str, &str)]) {
    for (index, (from, to, expected)) in mistakes.iter().enumerate() {
        assert!(job.contains(from), "{from} in {job}");
        let (code, _, words) = ran(&format!("{name}-{index}"), &job.replacen(from, to, 1), "%\nG21\nM30\n%\n");
        println!("{}", words.trim_end());
        assert!(code == Some(1) && words.contains(expected), "{expected}: {words}");
    }
}

/// Five frequencies that a report has of the workpiece are those of a square steel plate of 100 x 2 mm, by thin-plate theory (Ritz).
pub fn assert_plate(clamped: &str, report: &Value) {
    let table = include_str!("../fe/plate_cfff.csv");
    let row = table.lines().find(|line| line.starts_with("1,Ritz,")).expect("a square plate");
    // omega a^2 sqrt(rho h / D) = lambda.
    let (edge_mm, thickness_mm, nu) = (100.0, 2.0, 0.3);
    let bending = 210e3 * thickness_mm * thickness_mm / (12.0 * (1.0 - nu * nu));
    let scale = edge_mm * edge_mm * libm::sqrt(7850e-12 / bending);
    let lambdas = row.split(',').skip(2).map(|field| field.parse::<f64>().expect("a number"));
    for (mode, lambda) in lambdas.enumerate() {
        let found_hz = number(report, &format!("/loads/vibration/workpiece_hz/{mode}"));
        let off = found_hz / (lambda / scale / TAU) - 1.0;
        println!("{clamped} {mode}: {found_hz:.2} Hz, {off:+.2e}");
        assert!(off.abs() < 0.01);
    }
}
