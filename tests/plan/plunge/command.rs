//! The command: the example's files, the program's and the CL data's places, refusals.

use std::process::Output;

use arcfeed_tests::{Scratch, run};

use super::executed::{assert_read_by_rs274, assert_streamed};

const PART: &str = "examples/impeller-13/PART.toml";
/// Largest distance of places of program and CL data: half a step each, and half a step of B at the blank's radius.
const PLACE_MM: f64 = 0.002;

fn plan(part: &str, more: &[&str]) -> Output {
    run(&[&["plan", "plunge", part], more].concat())
}

/// Words of a block: letter and number.
pub fn words(line: &str) -> Vec<(char, f64)> {
    let mut found = Vec::new();
    for (at, letter) in line.char_indices().filter(|(_, letter)| letter.is_ascii_alphabetic()) {
        let rest = &line[at + 1..];
        let end = rest.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(rest.len());
        if let Ok(number) = rest[..end].parse() {
            found.push((letter, number));
        }
    }
    found
}

/// Largest distance of places of a program, with their B, from those of CL data. The table turns the part about the rotor's
/// axis, which is Y.
fn apart_mm(places: &[[f64; 4]], cl: &[[f64; 6]]) -> f64 {
    let sense = {
        let angle = |at: usize| libm::atan2(cl[at][4], cl[at][3]);
        let other = (0..cl.len()).find(|at| (angle(*at) - angle(0)).abs() > 0.01).unwrap();
        let turned = (places[other][3] - places[0][3] + 180.0).rem_euclid(360.0) - 180.0;
        (turned * (angle(other) - angle(0))).signum()
    };
    let zero = places[0][3].to_radians() - sense * libm::atan2(cl[0][4], cl[0][3]);
    let mut off_mm = 0.0_f64;
    for ([x, y, z, b], [px, py, pz, ..]) in places.iter().zip(cl) {
        let (sin, cos) = libm::sincos(sense * (b.to_radians() - zero));
        // X towards growing angles, Y along the rotor's axis, Z along the tool.
        let back = [z * cos - x * sin, z * sin + x * cos, *y];
        off_mm = (0..3).map(|axis| (back[axis] - [px, py, pz][axis]).abs()).fold(off_mm, f64::max);
    }
    off_mm
}

#[test]
fn program_and_cl_data_of_the_example_are_the_same_path_with_standing_axes() {
    let scratch = Scratch::new("plunge-example");
    let folder = scratch.path("out");
    let output = plan(PART, &["-o", &folder]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(format!("{folder}/{name}")).unwrap();
    let cl: Vec<[f64; 6]> = read("plunges.apt")
        .lines()
        .filter_map(|line| line.strip_prefix("GOTO/"))
        .map(|rest| rest.split(',').map(|word| word.parse().unwrap()).collect::<Vec<f64>>().try_into().unwrap())
        .collect();

    // Places of the program, turned back by its B about the rotor's axis, which is Y: the table turns the part under a standing tool.
    let mut state = [0.0; 4];
    let mut places: Vec<[f64; 4]> = Vec::new();
    let (mut is_rapid, mut has_begun) = (true, false);
    for line in read("impeller-13.nc").lines().filter(|line| line.starts_with('N')) {
        let before = state;
        let block = words(line);
        for (letter, number) in block.iter().copied() {
            match letter {
                'G' if number == 0.0 || number == 1.0 => is_rapid = number == 0.0,
                'X' => state[0] = number,
                'Y' => state[1] = number,
                'Z' => state[2] = number,
                'B' => state[3] = number,
                _ => {}
            }
        }
        if before[3] != state[3] {
            assert!(is_rapid && before[2] == state[2] || !has_begun, "{line}");
        }
        let moves = block.iter().any(|(letter, _)| "XYZ".contains(*letter));
        if line.contains("G91") {
            break;
        }
        // The first rapid and the height after it are one place.
        if moves && (has_begun || line.contains("G43")) {
            has_begun = true;
            places.push(state);
        }
    }
    assert_eq!(places.len(), cl.len());
    let off_mm = apart_mm(&places, &cl);
    println!("{} places of program and CL data: {off_mm:.5} mm apart at most", cl.len());
    assert!(off_mm < PLACE_MM);

    let checked = run(&["check", &format!("{folder}/impeller-13.nc"), "--machine", "mitsui-seiki-hu80a-5x"]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
    let job = run(&["check", &format!("{folder}/job.toml")]);
    assert!(job.status.success(), "{}", String::from_utf8_lossy(&job.stderr));
    for name in ["stock.stl", "finished.stl", "report.html"] {
        assert!(std::fs::metadata(format!("{folder}/{name}")).unwrap().len() > 1000, "{name}");
    }
    assert_read_by_rs274(&folder, "impeller-13");
    assert_streamed(&folder, "impeller-13");
}

/// The report's comparison has the figures of both plans of the part, made by their own commands.
fn assert_compared(report: &str) {
    let object = |command: &str| -> serde_json::Value {
        let output = run(&["plan", command, "examples/blisk-19/PART.toml", "--json"]);
        serde_json::from_slice(&output.stdout).expect("one object")
    };
    let (plunge, cup) = (object("plunge"), object("cup-mill"));
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let (_, rows) = report.split_once(">Comparison<").expect("a section");
    let figures = |name: &str| -> Vec<f64> {
        let (_, row) = rows.split_once(name).expect("a row");
        row.split(['<', '>']).filter_map(|word| word.trim().parse().ok()).take(2).collect()
    };
    let near = |found: f64, expected: f64, digit: f64| (found - expected).abs() <= 0.51 * digit;
    let [plunging, ring, flank] = ["plunge mill", "cup mill", "ball-end mill"].map(figures);
    println!("min and cm3: plunge mill {plunging:?}, cup mill {ring:?}, flank milling {flank:?}");
    assert!(near(plunging[0], number(&plunge["passage_min"]), 0.1));
    assert!(near(ring[0], number(&cup["slot_min"]), 0.1));
    assert!(near(ring[1], number(&cup["removed"]["total_mm3"]) / 1e3, 0.01));
    assert!(near(flank[0], number(&cup["baseline_slot_min"]), 0.1) && flank[1] == plunging[1]);
}

#[test]
fn the_program_of_blisk_19_is_executed_by_the_simulated_control_and_read_by_another_interpreter() {
    let scratch = Scratch::new("plunge-blisk");
    let folder = scratch.path("out");
    let output = plan("examples/blisk-19/PART.toml", &["-o", &folder]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_compared(&std::fs::read_to_string(format!("{folder}/report.html")).unwrap());
    assert_read_by_rs274(&folder, "blisk-19");
    assert_streamed(&folder, "blisk-19");
}

#[test]
fn point_3_a_plan_that_cannot_be_made_names_its_place_and_writes_nothing() {
    let scratch = Scratch::new("plunge-refused");
    let text = std::fs::read_to_string(arcfeed_tests::root().join(PART)).unwrap();
    let sections = arcfeed_tests::root().join("examples/impeller-13/rotor-b.csv");
    let text = text.replace("rotor-b.csv", sections.to_str().unwrap());
    let folder = scratch.path("out");
    for (from, to, code, message) in [
        ("diameter = 12", "diameter = 17", 1, "the largest mill that passes everywhere has a diameter of"),
        ("[plunge]", "[plunges]", 1, "unknown field `plunges`"),
        (
            "corner_radius = 0.4",
            "corner_radius = 6",
            1,
            "corner_radius must be 0 or more, and below the mill's radius of 6.000 mm",
        ),
        ("cusp = 0.2", "cusp = 0.9", 1, "cusp must be less than the allowance and than the mill's radius"),
        ("corner_radius = 0.4", "core_radius = 5.5", 1, "the first plunge"),
        ("neck = [[5.4, 38]]", "neck = [[5.4, 10]]", 1, "the holder touches the"),
    ] {
        let part = scratch.write("PART.toml", text.replace(from, to));
        let output = plan(&part, &["-o", &folder]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        println!("{said}");
        assert_eq!(output.status.code(), Some(code), "{to}: {said}");
        assert!(said.contains(message), "{to}: {said}");
        assert!(!std::path::Path::new(&folder).exists(), "{to}");
    }
}
