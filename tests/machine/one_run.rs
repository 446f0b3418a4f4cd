//! Where nothing changes a program, `simulate` makes one run of it: the figures are those of two runs, which the tables of a trace need.

use arcfeed_tests::{Scratch, object};
use serde_json::Value;

/// Programs; each has a move that A or X makes slower on the machine: after other cuts, as the only one, as the first block, before a slow one.
const PROGRAMS: [&str; 4] = [
    "G0X-12.Y0.Z5.\nG1Z-2.F200.\nX10.F400.\nG3X20.Y10.I0.J10.\nG1Y20.F900.\nX15.A9.F6000.\nG0Z5.\n",
    "G0X-12.Y0.Z5.\nG1X15.A30.F9000.\nG0Z6.\n",
    "G1X300.F21200.\nG0Z6.\n",
    "G1X100.F26000.\nX101.\nX200.F15000.\nG0Z6.\n",
];

/// Rules that govern the arc.
const INSIDE: &str = "[[cut]]\nmoves = \"arcs\"\ndirection = \"ccw\"\nside = \"inside\"\nradial_depth = 1.0\n";
/// A machine with slow axes.
const MACHINE: &str = "[machine]\npreset = \"mikron-ucp710\"\n";

/// A job under this law, with these rules or this machine.
fn job(law: &str, rest: &str, mode: &str) -> String {
    format!(
        "units = \"mm\"\nprogram = \"p.nc\"\n[tool]\nkind = \"end-mill\"\ndiameter = 8\nteeth = 3\nheight = 20\n\
         [spindle]\nrev_per_min = 3000\n[limits]\nmax_feed = 9000\n[law]\nkind = \"{law}\"\nfeed_per_tooth = 0.05\n[override]\nmode = \"{mode}\"\n\
         [workpiece]\nstep = 0.5\nblock = {{ from = [-10, -10, -10], to = [30, 30, 0] }}\n\
         [cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 2\n{rest}"
    )
}

/// Report without the figure that depends on the computer.
fn report(arguments: &[&str]) -> Value {
    let mut report = object(&[&["simulate"], arguments].concat());
    report.as_object_mut().expect("an object").remove("real_time_factor").expect("it is there");
    report
}

#[test]
fn one_run_has_the_figures_of_two() {
    let scratch = Scratch::new("one-run");
    let mut unchanged = 0;
    let cases = [("programmed", ""), ("programmed", MACHINE), ("contour", INSIDE)];
    for (program, (law, rest)) in PROGRAMS.iter().flat_map(|program| cases.map(|case| (program, case))) {
        scratch.write("p.nc", format!("%\nO1\nG21G17G90G94\nT1M6\nS3000M3\n{program}M30\n%\n"));
        for mode in ["safe-base", "override-only", "rewrite-only"] {
            let path = scratch.write("job.toml", job(law, rest, mode));
            let two = report(&[&path, "--trace", &scratch.path("run.csv")]);
            assert_eq!(report(&[&path]), two, "{program:?}, {law}, {rest:?}, {mode}");
            let is_same = two["cycle_time_s"] == two["baseline_cycle_time_s"];
            println!("{program:?}, {law}, {rest:?}, {mode}: the same run {is_same}");
            unchanged += usize::from(is_same);
        }
    }
    assert!((1..36).contains(&unchanged), "{unchanged}");
}
