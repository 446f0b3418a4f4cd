//! The circumference law in G18 and G19: the job of `tests/cases/table-5-4` with its axes permuted so that first axis,
//! second axis and normal of each plane keep their roles (G18 is ZX, its normal Y) wishes, sends and measures the same.

use arcfeed_tests::{Scratch, in_plane, root, run};
use serde_json::Value;

const CASE: &str = "tests/cases/table-5-4";
/// G17 becomes, X Y Z I J K become.
const PLANES: [(&str, &str); 2] = [("G18", "ZXYKIJ"), ("G19", "YZXJKI")];

fn case(file: &str) -> String {
    std::fs::read_to_string(root().join(CASE).join(file)).expect("the case is there")
}

fn scratch(name: &str, program: &str) -> Scratch {
    let scratch = Scratch::new(name);
    scratch.write("program.nc", program);
    scratch.write("job.toml", case("job.toml"));
    scratch
}

fn objects(command: &str, scratch: &Scratch) -> Vec<Value> {
    let output = run(&[command, &scratch.path("job.toml"), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("JSON is text");
    text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect()
}

#[test]
fn in_every_plane_the_law_wishes_and_sends_the_same_to_the_last_digit() {
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
    let error = |bound: &str| in_g17["ipt_circumference"][bound].as_f64().expect("measured");
    assert!(error("error_ratio_min") > -0.02 && error("error_ratio_max") < 0.005, "{in_g17}");
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
