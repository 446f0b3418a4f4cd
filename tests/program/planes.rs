//! The circumference law in G18 and G19: the job of `tests/cases/table-5-4` with its axes permuted so that first axis,
//! second axis and normal of each plane keep their roles (G18 is ZX, its normal Y) demands, sends and measures the same. So
//! does the job whose arcs are helices, for F, law and chip all count in the plane.

use arcfeed_tests::{Scratch, in_plane, root, run};
use serde_json::Value;

const CASE: &str = "tests/cases/table-5-4";
/// G17 becomes, X Y Z I J K become.
const PLANES: [(&str, &str); 2] = [("G18", "ZXYKIJ"), ("G19", "YZXJKI")];

/// The tool's axis in a plane.
fn axis(program: &str) -> &'static str {
    if program.contains("G18") {
        "y"
    } else if program.contains("G19") {
        "x"
    } else {
        "z"
    }
}

fn case(file: &str) -> String {
    std::fs::read_to_string(root().join(CASE).join(file)).expect("the case is there")
}

fn scratch(name: &str, program: &str) -> Scratch {
    let scratch = Scratch::new(name);
    scratch.write("program.nc", program);
    let axis = format!("[tool]\naxis = \"{}\"\n", axis(program));
    scratch.write("job.toml", case("job.toml").replace("[tool]\n", &axis));
    scratch
}

fn objects(command: &str, scratch: &Scratch) -> Vec<Value> {
    let output = run(&[command, &scratch.path("job.toml"), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("JSON is text");
    text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect()
}

#[test]
fn in_every_plane_the_law_demands_and_sends_the_same_to_the_last_digit() {
    let in_g17 = objects("adapt", &scratch("planes-adapt-G17", &case("program.nc")));
    let governed = in_g17.iter().filter(|block| block["reason"] == "law").count();
    assert_eq!((governed, in_g17.len()), (4, 6));
    for (plane, letters) in PLANES {
        let program = in_plane(&case("program.nc"), plane, letters);
        assert!(program.contains(&format!("{plane}G90")) && program != case("program.nc"), "{program}");
        assert_eq!(objects("adapt", &scratch(&format!("planes-adapt-{plane}"), &program)), in_g17, "{plane}");
    }
}

#[test]
fn the_machine_measures_the_same_chips_in_every_plane() {
    let measured = |name: &str, program: &str| {
        let mut report = objects("simulate", &scratch(name, program)).remove(0);
        report["real_time_factor"] = Value::Null;
        report
    };
    let in_g17 = measured("planes-sim-G17", &case("program.nc"));
    let error = |bound: &str| in_g17["chip_load"][bound].as_f64().expect("measured");
    // Thin are only the arcs' ends, as in `main_job`.
    assert!(error("error_ratio_max_all") < 0.005, "{in_g17}");
    assert!(error("samples_thin") < 0.06 * error("samples"), "{in_g17}");
    for (plane, letters) in PLANES {
        assert_eq!(
            measured(&format!("planes-sim-{plane}"), &in_plane(&case("program.nc"), plane, letters)),
            in_g17,
            "{plane}"
        );
    }
}

#[test]
fn taken_for_an_xz_plane_g18_would_turn_the_other_way_round() {
    let blocks = objects("adapt", &scratch("planes-mirrored", &in_plane(&case("program.nc"), "G18", "XZYIKJ")));
    let arcs: Vec<&Value> = blocks.iter().filter(|block| block["kind"] == "arc").collect();
    let in_g17 = objects("adapt", &scratch("planes-not-mirrored", &case("program.nc")));
    let same = arcs.iter().filter(|arc| in_g17.contains(arc)).count();
    assert_eq!((arcs.len(), same), (4, 0), "{arcs:?}");
}

#[test]
fn helices_and_arcs_about_a_line_across_the_tools_axis_keep_their_feed() {
    // An inch down on each way there, an inch up on each way back.
    let ends = [("I3.2165", -28.5688), ("I4.0397", -27.5688), ("I3.0951", -28.6626), ("I3.854", -27.6626)];
    let helices = ends.iter().fold(case("program.nc"), |program, (center, z)| {
        assert!(program.contains(center));
        program.replace(center, &format!("Z{z}{center}"))
    });
    let scratch = scratch("planes-helices", &helices);
    let in_g18 = self::scratch("planes-roll-in", &in_plane(&case("program.nc"), "G18", "ZXYKIJ"));
    in_g18.write("job.toml", case("job.toml"));
    for blocks in [objects("adapt", &scratch), objects("adapt", &in_g18)] {
        assert_eq!(blocks.iter().filter(|block| block["reason"] == "axial").count(), 4, "{blocks:?}");
        assert!(
            blocks.iter().all(|block| block["feed_min"].is_null() && block["sent_feed"] == block["programmed_feed"])
        );
    }
}
