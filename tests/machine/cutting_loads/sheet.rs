//! A flexible wall or blade from an STL file: the same results as the equal block, its frequencies against plate theory and its formula, and
//! what is wrong with such a table.

use std::fs;

use arcfeed_blades::blade::Blade;
use arcfeed_dexel::files::write_stl;
use arcfeed_dexel::mesh::Mesh;
use arcfeed_fe::body::Body;
use arcfeed_fe::material::STEEL;
use arcfeed_tests::Scratch;

use crate::cutting_loads::slot_job::{assert_plate, assert_refused, number, simulation_report};
use crate::fe::surfaces::{TWISTED, closed, hollow};

/// A surface as a file in a folder of its own, in other units than millimetres.
fn filed(name: &str, surface: &Mesh, mm: f64) -> (Scratch, String) {
    let scratch = Scratch::new(&format!("loads-stl-{name}"));
    let scaled = surface.corners_mm().map(|corners| corners.map(|corner| corner.map(|along| along / mm)));
    let mut bytes = Vec::new();
    write_stl(&Mesh::from_corners(scaled).expect("a closed surface"), &mut bytes).expect("bytes take it");
    let path = scratch.path("wall.stl");
    fs::write(&path, bytes).expect("a file");
    (scratch, path)
}

fn block(lowest_mm: [f64; 3], highest_mm: [f64; 3]) -> Mesh {
    closed([6, 2, 5], |part| [0, 1, 2].map(|k: usize| lowest_mm[k] + part[k] * (highest_mm[k] - lowest_mm[k])))
}

/// A wall along X in front of the XZ plane, with 2 mm of stock on it; `held` is the flexible part, `rest` is the content of `[workpiece]`.
fn job(held: &str, rest: &str) -> String {
    format!(
        "units = \"mm\"\nprogram = \"program.nc\"\n\
         [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 2\nheight = 8\n\
         [workpiece]\nblock = {{ from = [0, -3, -8], to = [60, 2, 0] }}\nstep = 0.25\n{rest}\
         [workpiece.flexible]\n{held}\nmaterial = \"structural steel\"\nmodes = 5\ndamping = 0.7\n\
         [cutting]\naxial_depth = 8\ncutting = [0.1, 0, 0]\nedge = [0, 0.0625, 0]\n\
         [spindle]\nrev_per_min = 3000\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n"
    )
}

#[test]
fn a_strip_from_a_file_is_cut_as_the_block_that_it_is() {
    let program = "%\nG21G17G90G94\nN1G0X-8.Y5.\nN2G0Z5.\nN3G1Z-8.F2000.\nN4G1X68.F960.\nN5G0Z5.\nN6M30\n%\n";
    let (_kept, path) = filed("strip", &block([0.0, -3.0, -8.0], [60.0, 0.0, 0.0]), 1.0);
    let cells = "cells = [12, 1, 2], clamped = \"x-\" }";
    let of_file = simulation_report(
        "strip-file",
        &job(&format!("stl = {{ file = \"{path}\", thickness = \"y\", {cells}"), ""),
        program,
    );
    let of_block = simulation_report(
        "strip-block",
        &job(&format!("block = {{ from = [0, -3, -8], to = [60, 0, 0], {cells}"), ""),
        program,
    );
    for field in
        ["load/force_max_n", "load/torque_mean_n_m", "load/chip_mean/0", "marks/max", "vibration/workpiece_hz/4"]
    {
        let [file, block] = [&of_file, &of_block].map(|report| number(report, &format!("/loads/{field}")));
        println!("{field}: {file} {block}");
        assert!((file / block - 1.0).abs() < 1e-9, "{field}");
    }
}

#[test]
fn a_plate_from_a_file_has_the_frequencies_of_the_table() {
    for (thickness, clamped, highest_mm, cells, unit) in [
        ("y", "z-", [100.0, 2.0, 100.0], "[12, 1, 16]", "mm"),
        ("y", "x+", [100.0, 2.0, 100.0], "[16, 1, 12]", "inch"),
        ("x", "y-", [2.0, 100.0, 100.0], "[1, 16, 12]", "mm"),
    ] {
        let plate = block([0.0, 0.0, -100.0], [highest_mm[0], highest_mm[1], 0.0]);
        let (_kept, path) = filed(&format!("plate-{clamped}"), &plate, if unit == "mm" { 1.0 } else { 25.4 });
        let held = format!(
            "stl = {{ file = \"{path}\", thickness = \"{thickness}\", cells = {cells}, clamped = \"{clamped}\" }}"
        );
        let job = job(&held, &format!("stl_units = \"{unit}\"\n"));
        let report = simulation_report(
            &format!("plate-file-{clamped}"),
            &job,
            "%\nG21G17G90G94\nN1G0X-80.Y0.\nN2G1Z5.F2000.\nN3M30\n%\n",
        );
        assert_plate(clamped, &report);
    }
}

#[test]
fn a_blade_from_a_file_has_the_frequencies_of_its_formula() {
    let mesh = TWISTED.mesh([12, 1, 10], 0.2).expect("a blade");
    let foot = Blade::foot(&mesh);
    let truths_hz = Body::new(mesh, &STEEL).modes(&foot, 5).expect("five modes").frequencies_hz();
    let surface = closed([96, 2, 128], |[s, n, height]| TWISTED.point_mm([s - 0.5, n - 0.5, height]));
    let (_kept, path) = filed("blade", &surface, 1.0);
    let held = format!("stl = {{ file = \"{path}\", thickness = \"y\", cells = [12, 1, 10], clamped = \"z-\" }}");
    let job = job(&held, "").replace("from = [0, -3, -8], to = [60, 2, 0]", "from = [-16, -10, 0], to = [16, 20, 40]");
    let report = simulation_report("blade-file", &job, "%\nG21G17G90G94\nN1G0X-80.Y0.\nN2G1Z45.F2000.\nN3M30\n%\n");
    for (mode, truth_hz) in truths_hz.iter().enumerate() {
        let found_hz = number(&report, &format!("/loads/vibration/workpiece_hz/{mode}"));
        println!("{mode}: {found_hz:.2} Hz, {:+.1e}", found_hz / truth_hz - 1.0);
        assert!((found_hz / truth_hz - 1.0).abs() < 1e-3);
    }
}

#[test]
fn every_mistake_has_a_place_and_says_what_to_do() {
    let (kept, path) = filed("wrong", &block([0.0, -3.0, -8.0], [60.0, 0.0, 0.0]), 1.0);
    let text = "solid open\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid open\n";
    let open = kept.write("open.stl", text);
    let tube = hollow(&block([0.0, -3.0, -8.0], [60.0, 0.0, 0.0]), &block([1.0, -2.0, -7.0], [59.0, -1.0, -1.0]));
    let (_tube, tube) = filed("tube", &tube, 1.0);
    let (_far, far) = filed("far", &block([0.0, 3.0, -8.0], [60.0, 6.0, 0.0]), 1.0);
    let (path, open, tube, far) = (path.as_str(), open.as_str(), tube.as_str(), far.as_str());
    let good =
        job(&format!("stl = {{ clamped = \"x-\", cells = [12, 1, 2], thickness = \"y\", file = \"{path}\" }}"), "");
    let mistakes = [
        (path, "none.stl", "none.stl: No such file"),
        (path, open, ":12:69: "),
        (path, open, "open.stl: the mesh is open: 3 edges have no triangle on their other side"),
        (path, tube, "a line through the thickness meets the body 2 times: it is no wall or blade along Y"),
        (path, far, ":11:1: the flexible part has nothing in common with the workpiece"),
        ("thickness = \"y\"", "thickness = \"u\"", ":12:57: no such axis; write \"x\", \"y\" or \"z\""),
        (
            "thickness = \"y\"",
            "thickness = \"x\"",
            ":12:57: a wall or a blade is held at a face square to another axis",
        ),
        ("\"x-\"", "\"left\"", ":12:19: no such face; write \"x-\", "),
        ("[12, 1, 2]", "[12, 0, 2]", ":12:33: cells along X, Y and Z: 1 or more each"),
        ("[12, 1, 2]", "[200, 1, 11]", ":12:33: cells along X, Y and Z: 1 or more each"),
        (
            "stl = ",
            "block = { from = [0, -3, -8], to = [60, 0, 0], cells = [12, 1, 2], clamped = \"x-\" }\nstl = ",
            ":11:1: give the flexible part as one of block",
        ),
        ("[workpiece.flexible]\nstl", "[workpiece.flexible]\n# stl", ":11:1: give the flexible part as one of block"),
        ("thickness = \"y\", ", "", ":12:7: missing field `thickness`"),
    ];
    assert_refused("sheet", &good, &mistakes);
}
