//! `arcfeed check PROGRAM.nc --machine`: what is wrong with programs whose axes were worked out by hand.

use std::fmt::Write;

use arcfeed_tests::{Scratch, root, run};
use serde_json::Value;

/// The UCP710: A -120 to 30, C endless, X +-355, Y +-275, Z 0 to 700, 5400 deg/min, 20 m/min; zero where A and C cross.
const MIKRON: &str = "mikron-ucp710";
const HEAD: &str = "%\nG21G90G94G17\nG0X0Y0Z300.A-30.C0\n";

/// Line, kind and message of each finding.
fn findings(scratch: &Scratch, lines: &str, more: &[&str]) -> Vec<(u64, String, String)> {
    let program = scratch.write("program.nc", format!("{HEAD}{lines}M30\n%\n"));
    let machine = if more.contains(&"--machine") { vec![] } else { vec!["--machine", MIKRON] };
    let output = run(&[&["check", &program, "--json"], &machine[..], more].concat());
    let report: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)));
    let text = |value: &Value| value.as_str().expect("text").to_owned();
    let list = report["findings"].as_array().expect("a list").iter();
    let found: Vec<_> = list
        .map(|entry| (entry["line"].as_u64().expect("a line"), text(&entry["kind"]), text(&entry["message"])))
        .collect();
    let has_errors = found.iter().any(|(_, kind, _)| ["unreachable", "over-limit", "branch-change"].contains(&&**kind));
    assert_eq!(output.status.code(), Some(i32::from(has_errors)), "{found:?}");
    found
}

/// Asserts line, kind and beginning of the message of all findings.
fn assert_found(found: &[(u64, String, String)], expected: &[(u64, &str, &str)]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for ((line, kind, message), (at, what, begins)) in found.iter().zip(expected) {
        assert_eq!((line, kind.as_str()), (at, *what), "{message}");
        assert!(message.starts_with(begins), "{message}");
    }
}

#[test]
fn ranges_count_in_the_machines_coordinates_whoever_coordinates_the_axes() {
    let scratch = Scratch::new("programs-ranges");
    let with = |lines: &str| findings(&scratch, lines, &[]);
    assert_found(&with("G1X354.Y-274.A-119.C9000.F100.\n"), &[]);
    assert_found(
        &with("G1X356.A-121.F100.\nX357.Y276.\n"),
        &[
            (4, "over-limit", "X would"),
            (4, "over-limit", "A would leave its range; take"),
            (5, "over-limit", "Y would"),
        ],
    );
    // Work offset and tool length of the control: X 200 + 200, Z 250 + 500.
    let settings =
        scratch.write("settings.toml", "unit = \"mm\"\n[work]\n\"G55\" = { X = 200.0 }\n[length]\n1 = 500.0\n");
    let lines = "G54G1X200.F100.\nG55X200.\nG43H1Z250.\n";
    let expected = [(5, "over-limit", "X would"), (6, "over-limit", "Z would")];
    assert_found(&findings(&scratch, lines, &["--settings", &settings]), &expected);
    // A at -90 lays Y of the part along Z: 650 and a tool of 100 mm are 750.
    let lines = "G43.4H1\nG1X0Y0Z0A-90.F100.\nY590.\nY650.\n";
    assert_found(&findings(&scratch, lines, &["--tool-length", "100"]), &[(7, "over-limit", "Z would")]);
    // At radius 360 from C both ends lie inside, Y in the middle of the turn at -360.
    let lines = "G43.4H1\nG0A0X250.Y-250.Z100.\nG1Z101.C90.F10.\n";
    assert_found(&with(lines), &[(6, "over-limit", "Y would")]);
    assert_found(&with("G1B5.F100.\nB6.\n"), &[(4, "unreachable", "the machine has no axis B")]);
}

#[test]
fn poles_changes_of_branch_and_races_are_reported_at_their_place() {
    let scratch = Scratch::new("programs-branches");
    let with = |lines: &str| findings(&scratch, lines, &[]);
    // From A -20 to A 20 with C half a turn on: the same direction, by way of the pole, 20 degrees off.
    let jump = "G1A-20.X1.F1.\nA20.C180.X2.\n";
    let expected = [
        (5, "pole", "on the move here the tool axis comes to lie along C"),
        (5, "branch-change", "in this cut the rotary axes go"),
    ];
    assert_found(&with(jump), &expected);
    assert!(with(jump)[1].2.contains("(0.000, -20.000) to (180.000, 20.000)"), "{:?}", with(jump));
    assert_found(&with(&jump.replace("\nA20", "\nG0A20")), &[(5, "pole", "on the move")]);
    // Through the pole with C at rest, and a whole turn of C at a tilt, are no changes; standing in the pole is no passage.
    assert_found(&with("G1A-2.X1.F100.\nA2.X2.\nX3.\n"), &[(5, "pole", "on the move")]);
    assert_found(&with("G1A-20.X1.F100.\nC360.X90.\n"), &[]);
    assert_found(&with("G0A0.\nG1X90.C90.F100.\nX0C0\n"), &[(4, "pole", "on the move")]);
    // A tenth of a degree from the pole C turns by 60: the tool by as much as a chord of that circle, 0.1 degrees.
    let race = "G1A-1.X1.F100.\nA-.1C5.X2.\nC65.X30.\nA-1.C70.X31.\n";
    let found = with(race);
    assert_found(
        &found,
        &[(6, "singularity", "up to here the first rotary axis races beside the pole, 600 degrees a degree")],
    );
}

#[test]
fn feeds_beyond_the_axes_are_reported_in_every_mode_of_feed() {
    let scratch = Scratch::new("programs-feeds");
    let with = |lines: &str| findings(&scratch, lines, &[]);
    let feed = |line, begins| [(line, "feed", begins)];
    // 5400 deg/min over 45 degrees in 10 mm: 1200 mm/min, and 120 times a minute.
    assert_found(&with("G1X10.C45.F1201.\n"), &[]);
    assert_found(&with("G1X10.C45.F1500.\n"), &feed(4, "C allows 1200.0 mm/min here, 80.0 % of what is asked"));
    assert_found(&with("G93G1X10.C45.F120.\n"), &[]);
    assert_found(&with("G93G1X10.C45.F150.\n"), &feed(4, "C allows 1200.0 mm/min here, 80.0 %"));
    assert_found(&with("G1C90.F6000.\n"), &feed(4, "C allows 5400.0 deg/min here, 90.0 %"));
    assert_found(&with("G93G1C90.F80.\n"), &feed(4, "C allows 5400.0 deg/min here, 75.0 %"));
    assert_found(&with("G1X100.F25000.\n"), &feed(4, "X allows 20000.0 mm/min here, 80.0 %"));
    // Under G43.4 the tip rises by 3 mm at radius 200 while C turns by 90 degrees: X reaches r pi/2, 190.99 mm/min.
    let lines = "G43.4H1\nG0A0X200.Y0Z100.\nG1Z103.C90.F300.\n";
    let found = with(lines);
    assert!(found[0].2.contains("allows 180.0 mm/min") && found[0].2.starts_with("C "), "C is the slower: {found:?}");
    let tireless = scratch.write("tireless.toml", machine_text(MIKRON).replace("max_feed = 5400", "max_feed = 9000"));
    let found = findings(&scratch, lines, &["--machine", &tireless]);
    let allowed: f64 = found[0].2.split(' ').nth(2).and_then(|word| word.parse().ok()).expect("a feed");
    assert!((allowed - 190.9).abs() < 0.1, "{found:?}");
}

fn machine_text(name: &str) -> String {
    std::fs::read_to_string(root().join("host/adapt/machines").join(name).with_extension("toml"))
        .expect("an example machine")
}

#[test]
fn the_published_leading_edge_reads_as_published() {
    // Tournier, section 3: at 2 m/min round this edge 65 450 deg/min are asked for; the machines reach 1628.11 and 165.01 mm/min.
    let radius = 2_000.0 / 65_450_f64.to_radians();
    let scratch = Scratch::new("programs-edge");
    for (name, letter, closed) in [("ferrari-rtttr", 'B', 1_628.11), (MIKRON, 'A', 165.01)] {
        let text = machine_text(name);
        let slides = text.lines().map(|line| match line.split_once('=') {
            // The paper reckons with rotary axes only.
            Some((key, value)) if key.trim() == "max_feed" && value.trim().starts_with(['2', '4']) => String::new(),
            Some((key, _)) if ["acceleration", "jerk"].contains(&key.trim()) => String::new(),
            _ => format!("{line}\n"),
        });
        let machine = scratch.write("machine.toml", slides.collect::<String>());
        let mut lines = String::from("G43.4H1\n");
        for step in 0..40 {
            let deg = 4.0 + 0.5 * f64::from(step);
            let (sin, cos) = libm::sincos(deg.to_radians());
            let (across, up) = (radius * sin, radius * cos);
            let (axis, across, deg) = if letter == 'B' { ('X', across, deg) } else { ('Y', across, -deg) };
            let start = if step == 0 { "G0X0Y0" } else { "G1F2000." };
            let _infallible = writeln!(lines, "{start}{axis}{across:.6}Z{up:.6}{letter}{deg:.4}");
        }
        let lines = lines.replace("G0X0Y0Y", "G0X0Y").replace("G0X0Y0X", "G0Y0X");
        let found =
            findings(&scratch, &lines, &["--machine", &machine, "--tool-length", "100", "--part-zero", "0,0,100"]);
        let message = &found.iter().find(|(_, kind, _)| kind == "feed").expect("a finding").2;
        println!("{name}: {message}");
        let allowed: f64 = message.split(' ').nth(2).and_then(|word| word.parse().ok()).expect("a feed");
        assert!(message.starts_with(letter) && (allowed / closed - 1.0).abs() < 5e-4, "{message}");
    }
}

#[test]
fn directions_by_i_j_k_are_found_as_in_the_cl_data_they_come_from() {
    let scratch = Scratch::new("programs-directions");
    let path = "examples/five-axis/tournier-strategy-2.apt";
    for name in crate::kinematics::bench::FILES {
        let [nc, common] = [scratch.path("tcp.nc"), name.to_owned()];
        let common = ["--machine", &common, "--tool-length", "100"];
        let of = |file: &str| {
            let output = run(&[&["check", file, "--json"], &common[..]].concat());
            let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
            let list = report["findings"].as_array().expect("a list").clone();
            list.into_iter().map(|entry| (entry["kind"].to_string(), entry["severity"].to_string())).collect::<Vec<_>>()
        };
        let written = run(&[&["post", path, "--mode", "tcp", "-o", &nc], &common[..]].concat());
        if !written.status.success() {
            println!("{name}: out of reach");
            continue;
        }
        assert_eq!(of(&nc), of(path), "{name}");
    }
}

#[test]
fn moves_of_a_macro_are_reported_at_its_line() {
    let scratch = Scratch::new("programs-macros");
    // X 100 to 400 in steps of 100, in a loop and in a subprogram of the library.
    let looped = "#1=0\nWHILE[#1LT4]DO1\n#1=#1+1\nG1X[#1*100]A-30.F100.\nEND1\n";
    assert_found(&findings(&scratch, looped, &[]), &[(7, "over-limit", "X would")]);
    let library = scratch.path("library");
    std::fs::create_dir_all(&library).expect("a scratch folder");
    scratch.write("library/O9", "%\nO9\nG91G1X100.F100.\nG90\nM99\n%\n");
    assert_found(&findings(&scratch, "M98P9L4\n", &["--library", &library]), &[(4, "over-limit", "X would")]);
}

#[test]
fn moves_that_the_machine_cannot_follow_are_reported_after_the_alarms() {
    let scratch = Scratch::new("programs-refused");
    let faulty = scratch.write("faulty.nc", "%\nG21G90\nG14\nM30\n%\n");
    let arc = scratch.write("arc.nc", "%\nG21G90G43.5H1\nG1X0Y0Z0I0J0K1.F100.\nG2X1.Y1.R1.\nM30\n%\n");
    for (program, said) in [(&faulty, "faulty.nc:3:1: error PS0010"), (&arc, "arc.nc:4: only straight moves")] {
        let output = run(&["check", program, "--machine", MIKRON]);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(1) && error.contains(said), "{error}");
    }
    let output = run(&["check", &faulty, "--machine", "no-such-machine"]);
    assert_eq!(output.status.code(), Some(1));
}
