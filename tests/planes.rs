//! The circumference law in G18 and G19: the job of `tests/cases/table-5-4` with its axes permuted so that first axis,
//! second axis and normal of each plane keep their roles (G18 is ZX, its normal Y) wishes, sends and measures the same. So
//! does the job whose arcs are helices, for F, law and chip all count in the plane.

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

#[test]
fn on_a_helix_the_law_sends_what_it_sends_on_the_arc_and_the_chips_are_as_wanted() {
    // An inch down on each way there, an inch up on each way back: the path is a fifth to nearly a half longer than the arc.
    let ends = [("I3.2165", -28.5688), ("I4.0397", -27.5688), ("I3.0951", -28.6626), ("I3.854", -27.6626)];
    let program = ends.iter().fold(case("program.nc"), |program, (center, z)| {
        assert!(program.contains(center));
        program.replace(center, &format!("Z{z}{center}"))
    });
    let scratch = scratch("planes-helices", &program);
    let feeds = |blocks: Vec<Value>| -> Vec<[Value; 4]> {
        let of = |block: &Value| ["sent_feed", "feed_min", "feed_max", "reason"].map(|field| block[field].clone());
        blocks.iter().filter(|block| block["reason"] == "law").map(of).collect()
    };
    let adapted = objects("adapt", &scratch);
    assert_eq!(adapted.iter().filter(|block| block["kind"] == "helix").count(), 4);
    assert_eq!(feeds(adapted), feeds(objects("adapt", &self::scratch("planes-arcs", &case("program.nc")))));
    let report = objects("simulate", &scratch).remove(0);
    for movement in report["movements"].as_array().expect("a list") {
        let error = |bound: &str| movement["ipt"][bound].as_f64().expect("measured");
        let (least, most) = (error("error_ratio_min"), error("error_ratio_max"));
        println!("movement {}: {:.2} .. {:.2} % of the target off", movement["rule"], 100.0 * least, 100.0 * most);
        assert!(least > -0.02 && most < 0.005, "{movement}");
    }
}
