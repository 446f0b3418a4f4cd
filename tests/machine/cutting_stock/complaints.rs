//! Errors in a workpiece are reported with their place in the job.

use crate::cutting_stock::scratch_job::{MILL, SLOT, ScratchJob};

#[test]
fn every_mistake_has_a_place_and_says_what_to_do() {
    let cases = [
        ("height = 30\n", "", ":12:1: a workpiece needs [tool] height"),
        (
            "height = 30\n",
            "height = 30\ncorner_radius = 6\n",
            ":8:17: corner_radius of an end-mill must be 0 (flat) to half",
        ),
        ("to = [50, 10, 0]", "to = [50, 10, -12]", ":14:9: `from` must be below `to`"),
        ("step = 0.25\n", "step = -1\n", ":15:8: step must be a positive length"),
        ("step = 0.25\n", "step = 0.25\nmemory_mib = 0\n", ":16:14: memory_mib must be 1 or more"),
        ("step = 0.25\n", "step = 0.25\nindexed = true\n", ":16:11: indexed = true needs a [machine]"),
        ("step = 0.25\n", "step = 0.1\nmemory_mib = 1\n", ":13:1: the stock takes"),
        ("step = 0.25\n", "step = 0.25\nstl = \"no.stl\"\n", ":13:1: give the workpiece as one of block"),
        ("step = 0.25\n", "step = 0.25\ntarget = \"no.stl\"\n", ":16:10: "),
        ("block = { from = [-10, -10, -12], to = [50, 10, 0] }", "stl = \"job.toml\"", "job.toml: no STL can be read"),
        ("from = [-10, -10, -12]", "from = [-10, \"1 furlong\", -12]", ":14:24: `1 furlong` is no length"),
        (
            "block = { from = [-10, -10, -12], to = [50, 10, 0] }",
            "round = { from = [0,0,0], to = [0,0,0], radius = 5 }",
            ":14:9: `from` and `to`",
        ),
        (
            "block = { from = [-10, -10, -12], to = [50, 10, 0] }",
            "round = { from = [0,0,0], to = [0,0,5], radius = 5, bore = 5 }",
            ":14:60: bore, a radius, must be less",
        ),
    ];
    for (index, (from, to, expected)) in cases.into_iter().enumerate() {
        assert!(MILL.contains(from), "{from}");
        let job = ScratchJob::new(&format!("wrong-{index}"), &MILL.replace(from, to), SLOT);
        let (code, words) = job.failed(&[]);
        println!("{}", words.trim_end());
        assert!(code == Some(1) && words.contains(expected), "{expected}: {words}");
    }
}

#[test]
fn bars_tubes_and_meshes_are_cut_as_blocks_are() {
    let blank = "block = { from = [-10, -10, -12], to = [50, 10, 0] }";
    let slot = ScratchJob::new("as-block", MILL, SLOT);
    let whole = slot.run(&["--surface", &slot.scratch.path("blank.stl")]).material("/removal/removed");
    for (name, round, section_mm2) in [
        ("bar", "round = { from = [-10, 0, -30], to = [50, 0, -30], radius = 20 }", 400.0 * std::f64::consts::PI),
        (
            "tube",
            "round = { from = [0, 0, -30], to = [0, 0, 0], radius = 20, bore = 15 }",
            175.0 * std::f64::consts::PI,
        ),
    ] {
        let output = ScratchJob::new(name, &MILL.replace(blank, round), SLOT).run(&[]);
        let length_mm = if name == "bar" { 60.0 } else { 30.0 };
        let all_cm3 = output.material("/removal/removed") + output.material("/left");
        let off = all_cm3 / (section_mm2 * length_mm / 1e3) - 1.0;
        println!("{name}: {all_cm3} cm3, off by {off:+.1e}");
        assert!(off.abs() < 5e-3, "{name}");
    }
    let again =
        ScratchJob::new("as-mesh", &MILL.replace(blank, "stl = \"blank.stl\""), "%\nG21G90G94\nG1Z5.F100.\nM30\n%\n");
    std::fs::copy(slot.scratch.path("blank.stl"), again.scratch.path("blank.stl")).expect("a copy");
    let left = again.run(&[]).material("/left");
    assert!((left + whole - 14.4).abs() < 2e-3 * 14.4, "{left} {whole}");
}
