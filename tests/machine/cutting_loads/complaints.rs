//! Errors in `[cutting]` are reported with their place in the job.

use arcfeed_tests::{Scratch, run};

use crate::cutting_loads::slot_job::{assert_refused, ran};

const JOB: &str = "units = \"mm\"\nprogram = \"program.nc\"\n\
    [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 30\n\
    [workpiece]\nblock = { from = [-10, -10, -12], to = [50, 10, 0] }\nstep = 1\n\
    [cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 4\n\
    [spindle]\nrev_per_min = 3000\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n";

#[test]
fn every_mistake_has_a_place_and_says_what_to_do() {
    let mistakes = [
        (
            "[workpiece]\nblock = { from = [-10, -10, -12], to = [50, 10, 0] }\nstep = 1\n",
            "",
            ":8:1: [cutting] needs a [workpiece]",
        ),
        ("\"Ti-6Al-4V\"", "\"Ti\"", ":12:12: no coefficients are known of `Ti`; write one of \"Ti-6Al-4V\", "),
        ("radial = 0.4\n", "", ":11:1: give `radial` and `axial`"),
        ("radial = 0.4", "radial = -1", ":13:10: radial must be a number, 0 or more"),
        ("material = \"Ti-6Al-4V\"", "kc11 = 2000", ":11:1: give the coefficients as one of material"),
        ("material = \"Ti-6Al-4V\"", "kc11 = 2000\nmc = 1", ":13:6: mc must be 0 to less than 1"),
        (
            "material = \"Ti-6Al-4V\"",
            "cutting = [1, 1, 1]\nedge = [0, 0, 0]",
            ":14:10: `cutting` and `edge` have radial and axial values",
        ),
        ("axial_depth = 4", "axial_depth = 31", ":15:15: axial_depth must be at most the tool's height"),
        ("axial_depth = 4", "axial_depth = 4\nlayers = 0", ":16:10: layers must be 1 to 100"),
        ("axial_depth = 4", "axial_depth = 4\nhelix = 90", ":16:9: helix is that of an end-mill"),
        ("axial_depth = 4", "axial_depth = 4\npitch = [90, 90, 90]", ":11:1: 4 teeth need one value each, not 3"),
        ("axial_depth = 4", "axial_depth = 0.0001", ":11:1: "),
    ];
    assert_refused("wrong", JOB, &mistakes);
}

#[test]
fn rapids_remove_material_without_chips() {
    let program =
        "%\nG21G17G90G94\nN1G0X-20.Y0.\nN2G0Z5.\nN3G1Z-4.F2000.\nN4G1X-18.F600.\nN5G0X60.\nN6G1X-18.F3000.\nN7M30\n%\n";
    let (code, report, complaints) = ran("rapid", JOB, program);
    let report: serde_json::Value = serde_json::from_str(&report).expect("one object");
    assert!(code == Some(0) && complaints.contains("N5: "), "{complaints}");
    assert_eq!(report["loads"]["blocks"].as_array().map(Vec::len), Some(0), "{}", report["loads"]);
}

#[test]
fn the_page_shows_the_loads_of_both_runs() {
    let scratch = Scratch::new("loads-page");
    scratch
        .write("program.nc", "%\nG21G17G90G94\nN1G0X0.Y0.\nN2G0Z5.\nN3G1Z-4.F400.\nN4G1X10.F600.\nN5G0Z5.\nN6M30\n%\n");
    let (job, page) = (scratch.write("job.toml", JOB), scratch.path("page.html"));
    let output = run(&["simulate", &job, "--report", &page]);
    let (words, page) = (String::from_utf8_lossy(&output.stdout), std::fs::read_to_string(&page).expect("a page"));
    for expected in
        ["<h2>Chips and forces</h2>", "largest bending force, N", "mean power in the cut, kW", "force, N, before"]
    {
        assert!(page.contains(expected), "{expected}");
    }
    assert!(words.contains("edges in the workpiece") && words.contains("torque, N m"), "{words}");
}
