//! The whole chain on the example rotor: `plan`, `check`, `adapt`, `simulate`, `stream`. What is cut is measured in the dexels of `simulate`, which know
//! neither the planner nor its proof.

use arcfeed_tests::{Scratch, number, object, root, run};
use serde_json::Value;

use crate::wheel::fast_part;

const PART: &str = "examples/blisk-19/PART.toml";
const MM_PER_INCH: f64 = 25.4;
/// The rays of `simulate` on the planned stock stand this far apart, mm.
const RAYS_MM: f64 = 0.5;

#[test]
fn the_example_rotor_is_planned_checked_simulated_and_streamed() {
    let scratch = Scratch::new("plan-chain");
    let part = scratch.write("PART.toml", fast_part());
    let folder = scratch.path("out");
    let plan = object(&["plan", "cup-mill", &part, "-o", &folder]);
    let levels = plan["levels"].as_array().expect("levels").len();
    assert!(plan["safe"] == true && plan["slots"] == 19, "{plan}");

    let program = format!("{folder}/blisk-19.nc");
    let counts = &object(&["check", &program, "--strict"])["counts"];
    // Two arcs a level, one on the first, three on the last.
    assert_eq!(counts["arcs"], 19 * 2 * levels, "{counts}");
    let machine = object(&["check", &program, "--machine", "mitsui-seiki-hu80a-5x"]);
    assert_eq!(machine["findings"], Value::Array(vec![]), "{machine}");

    let job = format!("{folder}/job.toml");
    let report = object(&["simulate", &job]);
    assert_eq!(report["alarms"], Value::Array(vec![]));
    let material = &report["material"];
    println!(
        "planned: {}; simulated: {} in3, deviation {}",
        plan["removed"], material["removal"], material["deviation"]
    );
    let text = std::fs::read_to_string(&program).expect("the program");
    let second = text.split("(SLOT 2 OF").nth(1).and_then(|rest| rest.split_once("\nN")).expect("a second slot").1;
    let second: i64 = second.split('G').next().and_then(|n| n.parse().ok()).expect("an N");
    // The stock has three quarters of a pitch on each side, which the neighbours' slots are cut from.
    let blocks = material["blocks"].as_array().expect("a list");
    let removed_mm3 = |is_of: &dyn Fn(i64) -> bool| {
        let of_slots = blocks.iter().filter(|block| block["n"].as_i64().is_some_and(is_of));
        of_slots.map(|block| number(block, "/removal/removed")).sum::<f64>() * MM_PER_INCH * MM_PER_INCH * MM_PER_INCH
    };
    let planned_mm3 = number(&plan, "/removed/total_mm3");
    let [first_mm3, others_mm3] = [removed_mm3(&|n| n < second), removed_mm3(&|n| n >= second)];
    println!("first slot {first_mm3:.0} mm3 of {planned_mm3:.0} planned, others {others_mm3:.0} in its stock");
    assert!((first_mm3 / planned_mm3 - 1.0).abs() < 0.02, "{first_mm3} of {planned_mm3}");
    assert!(others_mm3 > planned_mm3 && others_mm3 < 2.0 * planned_mm3, "{others_mm3}");
    assert_eq!(number(material, "/at_rapid"), 0.0);
    // The finished part is not cut into: what is left nowhere lies below it by more than a ray's width can hide on a wall.
    let lowest_mm = number(material, "/deviation/min") * MM_PER_INCH;
    assert!(lowest_mm > -0.1 * RAYS_MM, "{lowest_mm}");

    let streamed = object(&["stream", &job, "--port", "sim:"]);
    assert_eq!((&streamed["alarms"], &streamed["blocks_executed"]), (&report["alarms"], &report["blocks_executed"]));
}

#[test]
fn infeasible_plans_give_a_reason_and_write_nothing() {
    let scratch = Scratch::new("plan-refused");
    let text = std::fs::read_to_string(root().join(PART)).expect("the example");
    // One direction is enough here.
    let text = text.replace("[roughing]", "[roughing]\naxis = \"roomiest\"");
    let folder = scratch.path("out");
    let refused = |changes: &[(&str, &str)]| {
        let changed = changes.iter().fold(text.clone(), |text, (old, new)| {
            assert!(text.contains(old), "{old}");
            text.replace(old, new)
        });
        let part = scratch.write("PART.toml", changed);
        let output = run(&["plan", "cup-mill", &part, "-o", &folder]);
        assert_eq!(output.status.code(), Some(1));
        assert!(!std::path::Path::new(&folder).exists());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let wide = refused(&[("inner_radius = 4.43706", "inner_radius = 4.3")]);
    assert!(wide.contains("no ring of this width passes") && wide.contains("mm missing between"), "{wide}");
    let crowded = refused(&[("blades = 19", "blades = 100")]);
    assert!(crowded.contains("this rotor cannot be planned"), "{crowded}");
    let open = refused(&[("blades = 19", "blades = 2")]);
    assert!(open.contains("no slot for a ring"), "{open}");
    let shallow = refused(&[("cavity_depth = 1.5", "cavity_depth = 0.5")]);
    assert!(shallow.contains("the cup is 12.7 mm deep"), "{shallow}");
    let fixture = "[[fixture]]\nfrom = [\"70 mm\", \"-60 mm\", \"-60 mm\"]\nto = [\"140 mm\", \"60 mm\", \"-15 mm\"]\n\n[machine]";
    let fixed = refused(&[("[machine]", fixture)]);
    assert!(fixed.contains("touches the fixture") && fixed.contains("nothing is written"), "{fixed}");
    let unknown = refused(&[("insert_radius", "insert_radios")]);
    assert!(unknown.contains("PART.toml:") && unknown.contains("insert_radios"), "{unknown}");
}
