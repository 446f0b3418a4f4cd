//! Rows of plunges into a round bar: peaks and time at a constant feed and under the law.

use arcfeed_tests::run;
use serde_json::Value;

use crate::plunge_law::plunge_job::PlungeJob;

/// Four plunges 4 mm apart, 30 mm deep into the back of a bar.
const PROGRAM: &str = "%\nG21G17G90G94\nS800M3\nN1G0X0.Y3.Z5.\nN2G1Z-30.F160.\nN3G0Z5.\nN4X4.\nN5G1Z-30.F160.\nN6G0Z5.\nN7X8.\n\
                       N8G1Z-30.F160.\nN9G0Z5.\nN10X12.\nN11G1Z-30.F160.\nN12G0Z5.\nN13M30\n%\n";

/// A row in this mode.
fn row<'a>(name: &'a str, mode: &'a str, program: &'a str) -> PlungeJob<'a> {
    PlungeJob {
        name,
        tool: "kind = \"end-mill\"\ndiameter = 10\nteeth = 3\nheight = 40",
        workpiece: "round = { from = [-20, 0, -40], to = [30, 0, -40], radius = 40 }\nstep = 0.25",
        cutting: "material = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 2\nlayers = 2",
        spindle: "rev_per_min = 800\nmax_power = \"0.6 kW\"\nmax_torque = \"9 Nm\"",
        mode,
        feed_per_tooth_mm: 0.08,
        max_raise: 2.0,
        program,
    }
}

/// The same four plunges, 12 mm deep.
fn short() -> String {
    PROGRAM.replace("Z-30.", "Z-12.")
}

#[test]
fn point_7_plunges_under_the_law_keep_power_and_torque_in_both_modes() {
    for mode in ["mode = \"safe-base\"", "mode = \"rewrite-only\""] {
        let found = row("row", mode, PROGRAM).found();
        let (power, torque) = (found.most(|load| load.power_w), found.most(|load| load.torque_n_m));
        let chip = found.most(|load| load.chip_mm);
        println!(
            "{mode}: power {:.0} W for {:.0}, torque {:.2} Nm for {:.2}, chip {:.4} mm for {:.4}, time {:.1} s for {:.1}",
            power[0], power[1], torque[0], torque[1], chip[0], chip[1], found.time_s[0], found.time_s[1]
        );
        assert!(power[0] <= 600.0 && torque[0] <= 9.0 && chip[0] <= 0.08 * 1.005, "{power:?} {torque:?} {chip:?}");
        assert!(power[1] > 600.0, "the constant feed is too fast: {power:?}");
        let pieces: u64 = found.adapted.iter().filter_map(|block| block["pieces"].as_u64()).sum();
        assert_eq!(pieces > 4, mode.contains("rewrite-only"), "{pieces} pieces");
        let laws = found.adapted.iter().filter(|block| block["law"] == "plunge").count();
        assert_eq!(laws, 4);
    }
}

/// Report of a command.
fn report(arguments: &[&str]) -> Value {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one object")
}

/// Cycle time of a command's report, s.
fn cycle_time_s(arguments: &[&str]) -> f64 {
    report(arguments)["cycle_time_s"].as_f64().expect("a time")
}

/// Number of feed moves down in a table of blocks, their smallest and largest override, and the changes.
fn descents_in_table(path: &str) -> [u64; 4] {
    let text = std::fs::read_to_string(path).expect("a table");
    let mut lines = text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let heads = lines.next().expect("a head");
    let column = |name: &str| heads.iter().position(|head| *head == name).expect("a column");
    let columns = ["n", "override_min_percent", "override_max_percent", "override_changes"].map(column);
    let rows = lines.map(|words| columns.map(|column| words[column].parse().unwrap_or(0)));
    let plunges = rows.filter(|[n, ..]: &[u64; 4]| [2, 5, 8, 11].contains(n));
    plunges.fold([0, u64::MAX, 0, 0], |[count, min, max, changes], [_, least, most, changed]| {
        [count + 1, min.min(least), max.max(most), changes + changed]
    })
}

#[test]
fn the_reports_have_the_override_of_the_descents_as_the_table_of_blocks_has_it() {
    let (scratch, job) = row("override-row", "mode = \"safe-base\"", &short()).written();
    assert!(run(&["engage", &job]).status.success());
    let [trace, journal] = ["run.csv", "journal"].map(|name| scratch.path(name));
    let stream = ["stream", &job, "--port", "sim:", "--journal", &journal];
    let reports = [
        report(&["simulate", &job, "--json", "--trace", &trace]),
        report(&[&stream[..], &["--json"]].concat()),
        report(&["simulate", &job, "--json", "--set", "override.max=100"]),
    ];
    let [found, streamed, least] = reports.each_ref().map(|report| {
        let figures = &report["descents"];
        let of = |key: &str| figures["override"][key].as_u64().expect("a figure");
        [figures["moves"].as_u64().expect("a number"), of("min"), of("max"), of("changes")]
    });
    println!("moves, least and largest override, changes: {found:?}, streamed {streamed:?}, at 100 % {least:?}");
    assert_eq!(found, descents_in_table(&scratch.path("run-blocks.csv")));
    assert_eq!(streamed, found);
    assert!(found[0] == 4 && found[1] == 100 && found[2] > 110 && least == [4, 100, 100, 0], "{found:?} {least:?}");
    let output = run(&["simulate", &job]);
    let text = String::from_utf8_lossy(&output.stdout);
    let line = format!("plunge law: 4 descents at an override of 100 .. {} %, {} changes", found[2], found[3]);
    assert!(text.contains(&line), "{text}");
}

#[test]
fn a_board_raises_the_least_feed_of_a_streamed_row_as_the_controller_of_a_simulated_run_does() {
    let (scratch, job) = row("streamed-row", "mode = \"safe-base\"", PROGRAM).written();
    assert!(run(&["engage", &job]).status.success());
    let journal = scratch.path("journal");
    let board = ["stream", &job, "--port", "sim:", "--board", "sim:", "--journal", &journal, "--json"];
    let least = ["simulate", &job, "--json", "--set", "override.max=100"];
    let time_s = [&["simulate", &job, "--json"][..], &board, &least].map(cycle_time_s);
    println!(
        "simulated {:.2} s, streamed with a board {:.2} s, at the least feed {:.2} s",
        time_s[0], time_s[1], time_s[2]
    );
    assert!((time_s[1] / time_s[0] - 1.0).abs() < 1e-3 && time_s[0] < 0.85 * time_s[2], "{time_s:?}");
}

#[test]
fn parameters_of_a_board_at_a_tapped_line_warn_that_plunges_keep_their_programmed_feed() {
    let (scratch, job) = row("tapped-row", "mode = \"safe-base\"", &short()).written();
    assert!(run(&["engage", &job]).status.success());
    let output = run(&["parameters", &job, "--output", &scratch.path("page")]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert_eq!(said.matches("leaves plunges and ramps their programmed feed").count(), 1, "{said}");
}
