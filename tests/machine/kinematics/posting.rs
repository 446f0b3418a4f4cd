//! `arcfeed post` and `check --machine`: there and back in every mode, and what is refused.

use std::fmt::Write;

use arcfeed_tests::{Scratch, root, run};

use crate::kinematics::bench::{FILES, direction};

const STRATEGY_2: &str = "examples/five-axis/tournier-strategy-2.apt";
/// Largest effect of half a step of the axes, 0.001 mm and 0.001 degrees, at the tip of a tool 100 mm long on a part of that size, and
/// in i, j, k.
const TIP_MM: f64 = 0.01;
const DIRECTION: f64 = 2e-5;

fn machine_file(name: &str) -> String {
    root().join("host/adapt/machines").join(name).with_extension("toml").display().to_string()
}

/// Points on a spiral, leaning away from the pole; for the pallet machine about Y, as it tilts.
fn spiral(about_y: bool) -> String {
    let mut text = String::from("PARTNO/SPIRAL\nRAPID\n");
    for step in 0..60 {
        let turn = f64::from(step) * 9.0;
        let [x, y, z] = direction(25.0 + turn / 30.0, turn);
        let [i, j, k] = if about_y { [x, z, y] } else { [x, y, z] };
        let _infallible =
            writeln!(text, "GOTO/{:.5},{:.5},{:.5},{i:.6},{j:.6},{k:.6}", 40.0 * x, 40.0 * y, 20.0 + turn / 50.0);
        text.push_str(if step == 0 { "FEDRAT/300,MMPM\n" } else { "" });
    }
    text + "FINI\n"
}

/// The six numbers of each GOTO.
fn gotos(text: &str) -> Vec<[f64; 6]> {
    let numbers = |line: &str| -> [f64; 6] {
        let values: Vec<f64> = line.split(',').map(|number| number.trim().parse().expect("a number")).collect();
        values.try_into().expect("six numbers")
    };
    text.lines()
        .filter_map(|line| line.trim().strip_prefix("GOTO")?.trim_start().strip_prefix('/'))
        .map(numbers)
        .collect()
}

fn off(one: &[f64; 6], other: &[f64; 6], from: usize) -> f64 {
    (from..from + 3).map(|at| (one[at] - other[at]).abs()).fold(0.0, f64::max)
}

#[test]
fn every_mode_comes_back_to_its_points_on_every_machine() {
    let scratch = Scratch::new("kinematics-post");
    for name in FILES {
        let cl = spiral(name.starts_with("mitsui"));
        let (path, machine) = (scratch.write("spiral.apt", &cl), machine_file(name));
        for mode in ["tcp", "part-rotary", "machine"] {
            let [nc, back] = ["out.nc", "back.apt"].map(|file| scratch.path(file));
            let common = ["--machine", &machine, "--mode", mode, "--tool-length", "100", "--part-zero", "5,-7,30"];
            let forth = run(&[&["post", &path, "-o", &nc], &common[..]].concat());
            let said = String::from_utf8_lossy(&forth.stderr).into_owned();
            assert!(forth.status.success(), "{name} {mode}: {said}");
            let reversed = run(&[&["post", "--reverse", &nc, "-o", &back], &common[..]].concat());
            assert!(reversed.status.success(), "{}", String::from_utf8_lossy(&reversed.stderr));
            let (asked, found) = (gotos(&cl), gotos(&std::fs::read_to_string(&back).expect("written")));
            let nearest = |point: &[f64; 6]| {
                let close = found.iter().filter(|other| off(point, other, 0) < TIP_MM);
                close.map(|other| [off(point, other, 0), off(point, other, 3)]).min_by(|a, b| a[1].total_cmp(&b[1]))
            };
            let worst = asked.iter().map(|point| nearest(point).expect("the point is in the program"));
            let worst = worst.fold([0.0_f64; 2], |worst, off| [worst[0].max(off[0]), worst[1].max(off[1])]);
            println!(
                "{name} {mode}: {} points as {} blocks, back to {:.4} mm and {:.1e}",
                asked.len(),
                found.len(),
                worst[0],
                worst[1]
            );
            assert!(worst[1] < DIRECTION && found.len() >= asked.len());
        }
    }
}

#[test]
fn a_change_of_branch_leaves_the_part_or_the_program_is_refused() {
    let scratch = Scratch::new("kinematics-change");
    let path = scratch.write("spiral.apt", spiral(false));
    let text = std::fs::read_to_string(machine_file("mikron-ucp710")).expect("an example machine");
    let limited = scratch.write("limited.toml", text.replacen("resolution", "range = [-200, 200]\nresolution", 1));
    let common = ["--machine", &limited, "--tool-length", "100"];
    let checked = run(&[&["check", &path], &common[..]].concat());
    let said = String::from_utf8_lossy(&checked.stderr).into_owned();
    assert_eq!(checked.status.code(), Some(1));
    assert!(said.contains("because C comes to its end; instead: retract to ("), "{said}");
    for mode in ["tcp", "part-rotary"] {
        let refused = run(&[&["post", &path, "--mode", mode], &common[..]].concat());
        assert_eq!((refused.status.code(), refused.stdout.is_empty()), (Some(1), true));
    }
    let nc = scratch.path("out.nc");
    let written = run(&[&["post", &path, "--mode", "machine", "-o", &nc], &common[..]].concat());
    assert!(written.status.success(), "{}", String::from_utf8_lossy(&written.stderr));
    let program = std::fs::read_to_string(&nc).expect("written");
    let changes = said.matches("because C comes to its end").count();
    assert!(changes > 0 && program.matches("(RETRACT, REORIENT, RETURN)").count() == changes);
    // The control reads it, and C stays within its range.
    assert!(run(&["check", &nc]).status.success());
    let c_words = program.lines().filter_map(|line| line.split_once('C')?.1.split_once('A')?.0.parse::<f64>().ok());
    assert!(c_words.map(f64::abs).fold(0.0, f64::max) <= 200.0);
}

#[test]
fn a_repair_shortens_the_program_that_has_to_follow_the_race() {
    let machine = machine_file("mikron-ucp710");
    let blocks = |more: &[&str]| {
        let output =
            run(&[&["post", STRATEGY_2, "--machine", &machine, "--mode", "machine", "--tool-length", "100"], more]
                .concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).lines().filter(|line| line.contains("G93")).count()
    };
    let [raced, repaired, refused] = [blocks(&[]), blocks(&["--repair", "--ball-radius", "5"]), blocks(&["--repair"])];
    println!("strategy 2 in machine coordinates to 0.01 mm: {raced} moves, repaired {repaired}");
    assert!(raced > 5 * repaired && refused == raced);
}

#[test]
fn senseless_input_is_a_usage_error_or_a_file_error() {
    let scratch = Scratch::new("kinematics-wrong");
    let (machine, job) = (machine_file("mikron-ucp710"), "examples/ibr-slot/job.toml");
    let cl = scratch.write("one.apt", "GOTO/0,0,0,0,0,1\nCIRCLE/0,0,0\n");
    let arc = scratch.write("arc.nc", "G21G90\nG1X0Y0Z0A0C0F100.\nG2X1.Y1.R1.\n");
    for (arguments, code, said) in [
        (vec!["check", STRATEGY_2, "--machine", &machine, "--strict"], 2, "not for CL data"),
        (vec!["post", &cl, "--machine", &machine], 1, "one.apt:2: CIRCLE"),
        (vec!["post", STRATEGY_2, "--machine", job], 1, "job.toml"),
        (vec!["post", STRATEGY_2], 2, "--machine"),
        (vec!["post", "--reverse", &arc, "--machine", &machine], 1, "arc.nc:3: only straight moves"),
        (vec!["post", STRATEGY_2, "--machine", &machine, "--tolerance", "0"], 2, "above zero"),
        (vec!["check", STRATEGY_2, "--tool-length", "5"], 2, "--machine"),
    ] {
        let output = run(&arguments);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(code) && error.contains(said), "{arguments:?}: {error}");
    }
}
