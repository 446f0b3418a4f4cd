//! `arcfeed lobes`: the tables of an independent program, the process in the time domain, and the best speeds, through the
//! command.

use std::fmt::Write;

use arcfeed_tests::{Scratch, of_full_set, root, run};
use serde_json::Value;

use crate::cutting_forces::rows::rows;
use crate::stability::milling::Milling;
use crate::stability::tables::{Table, tables};

/// Largest relative difference from a table.
const TABLE_RATIO: f64 = 0.01;

/// Tolerance of the time domain, relative.
const BAND: f64 = 0.05;

/// Job file of a table's milling; the tool is 10 mm in diameter.
fn job(milling: &Milling) -> String {
    let [tangential, normal] = milling.specific_mpa;
    let mut text = format!(
        "units = \"mm\"\nprogram = \"p.nc\"\n[tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = {}\nheight = 100\n\
         [spindle]\nrev_per_min = 5000\n[law]\nkind = \"engagement\"\nfeed_per_tooth = 0.05\n[limits]\nmax_feed = 5000\n\
         [workpiece]\nstep = 1\nblock = {{ from = [0, 0, -20], to = [20, 20, 0] }}\n\
         [cutting]\ncutting = [{tangential}, {normal}, 0]\nedge = [20, 10, 0]\naxial_depth = 0.5\nmodes = [\n",
        milling.teeth
    );
    for mode in &milling.modes {
        let shape = mode.shape.xy();
        let circular_per_s = std::f64::consts::TAU * mode.frequency_hz;
        // k = (2 pi f)^2 m, m = 1/|s|^2; N/m to N/mm.
        let stiffness = circular_per_s * circular_per_s / shape.norm_squared() / 1e3;
        let direction = shape.normalize();
        writeln!(
            text,
            "{{ frequency = {}, damping = {}, stiffness = {stiffness}, direction = [{}, {}, 0] }},",
            mode.frequency_hz, mode.damping_ratio, direction.x, direction.y
        )
        .expect("strings take what is written");
    }
    text + "]\n"
}

/// Report of the command; the cut is that of a table.
fn lobes(job: &str, milling: &Milling, options: &[&str]) -> Value {
    let depth = format!("{}mm", 10.0 * milling.immersion);
    let side = if milling.is_up { "conventional" } else { "climb" };
    let cut = ["lobes", job, "--radial-depth", &depth, "--milling", side, "--json"];
    let output = run(&[&cut, options].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn limit_mm(point: &Value) -> f64 {
    point["depth_limit"].as_f64().expect("a limit")
}

#[test]
fn the_command_has_the_limits_of_the_tables() {
    let scratch = Scratch::new("lobes-tables");
    for Table { name, csv, milling } in tables() {
        let job = scratch.write("job.toml", job(&milling));
        // One call for two rows: both ends of its range.
        let rows = rows(csv);
        let (mut worst, mut count): (f64, _) = (0.0, 0);
        for pair in rows.chunks_exact(2).step_by(of_full_set(1, 6)) {
            let range = format!("{},{}", pair[0].text("rpm"), pair[1].text("rpm"));
            let report = lobes(&job, &milling, &["--speeds", &range, "--points", "2"]);
            let points = report["points"].as_array().expect("points");
            for (row, point) in pair.iter().zip(points) {
                assert_eq!(point["rev_per_min"].as_f64(), Some(row.number("rpm")));
                worst = worst.max((limit_mm(point) / row.number("alim_ref_mm") - 1.0).abs());
                count += 1;
            }
        }
        println!("{name}: {count} limits, {worst:.5} at most");
        assert!(count > 4 && worst < TABLE_RATIO, "{name}: {worst}");
    }
}

#[test]
fn the_time_domain_is_stable_below_the_limits_and_chatters_above_them() {
    let scratch = Scratch::new("lobes-time");
    let Some(Table { milling, .. }) = tables().into_iter().nth(1) else { panic!("a table") };
    let job = scratch.write("job.toml", job(&milling));
    // In the stretch between two cusps, where the theory's own limit is not steep.
    let report = lobes(&job, &milling, &["--speeds", "5000,7000", "--points", "21"]);
    let points = report["points"].as_array().expect("points");
    for point in points.iter().step_by(of_full_set(1, 10)) {
        let (speed, limit_mm) = (point["rev_per_min"].as_f64().expect("a speed"), limit_mm(point));
        // The depth at which the simulated cut begins to chatter, by bisection.
        let [mut stable_mm, mut unstable_mm] = [limit_mm * (1.0 - 2.0 * BAND), limit_mm * (1.0 + 2.0 * BAND)];
        assert!(!milling.chatters(speed, stable_mm) && milling.chatters(speed, unstable_mm), "{speed} rev/min");
        while unstable_mm - stable_mm > BAND / 5.0 * limit_mm {
            let middle_mm = f64::midpoint(stable_mm, unstable_mm);
            *(if milling.chatters(speed, middle_mm) { &mut unstable_mm } else { &mut stable_mm }) = middle_mm;
        }
        let off = f64::midpoint(stable_mm, unstable_mm) / limit_mm - 1.0;
        println!("{speed} rev/min: {limit_mm:.4} mm by the command, {off:+.4} in the time domain");
        assert!(off.abs() < BAND, "{speed}: {off}");
    }
}

#[test]
fn a_quarter_turn_of_the_feed_is_a_quarter_turn_of_the_modes() {
    let scratch = Scratch::new("lobes-direction");
    let Some(Table { milling, .. }) = tables().into_iter().nth(1) else { panic!("a table") };
    let job = scratch.write("job.toml", job(&milling));
    let turned =
        std::fs::read_to_string(&job).expect("the job").replace("direction = [1, 0, 0]", "direction = [0, 1, 0]");
    let turned = scratch.write("turned.toml", turned);
    let range = ["--speeds", "5000,15000", "--points", "5"];
    let points = |job: &str, options: &[&str]| lobes(job, &milling, &[&range, options].concat())["points"].clone();
    let along = points(&job, &[]);
    assert_eq!(points(&turned, &["--feed-direction", "90"]), along);
    assert_ne!(points(&turned, &[]), along);
}

#[test]
fn the_best_speeds_are_the_highest_of_the_range_and_lie_in_the_machines() {
    let scratch = Scratch::new("lobes-best");
    let Some(Table { milling, .. }) = tables().into_iter().nth(1) else { panic!("a table") };
    let machine =
        std::fs::read_to_string(root().join("host/adapt/machines/mitsui-seiki-hu80a-5x.toml")).expect("a machine");
    scratch.write("machine.toml", format!("spindle_range = [15, 6000]\n{machine}"));
    let text = job(&milling).replace("[workpiece]", "[machine]\nfile = \"machine.toml\"\n[workpiece]");
    let job = scratch.write("job.toml", text);
    let svg = scratch.path("lobes.svg");
    let report = lobes(&job, &milling, &["--points", "20", "--svg", &svg]);
    let speeds: Vec<f64> =
        report["points"].as_array().expect("points").iter().filter_map(|point| point["rev_per_min"].as_f64()).collect();
    // From 60 vibrations of the fastest mode between two teeth.
    let fastest_hz = milling.modes.iter().map(|mode| mode.frequency_hz).fold(0.0, f64::max);
    let slowest = fastest_hz / milling.teeth as f64;
    assert!(
        speeds.len() == 20 && speeds.last() == Some(&6000.0) && (speeds[0] / slowest - 1.0).abs() < 1e-12,
        "{speeds:?}"
    );
    let depths = |key: &str| -> Vec<f64> {
        report[key]
            .as_array()
            .expect("points")
            .iter()
            .map(|point| point["depth_limit"].as_f64().unwrap_or(1e3))
            .collect()
    };
    let highest = depths("points").into_iter().fold(0.0, f64::max);
    assert!(depths("best").first() == Some(&highest) && depths("best").is_sorted_by(|a, b| a >= b));
    assert!(report["job"]["is_stable"] == (limit_mm(&report["job"]) > 0.5));
    let drawn = std::fs::read_to_string(svg).expect("the plot");
    assert!(drawn.starts_with("<svg") && drawn.contains("rev/min") && drawn.contains("<path"), "{drawn}");
    let outside = run(&["lobes", &job, "--speeds", "5000,9000"]);
    let message = String::from_utf8_lossy(&outside.stderr).into_owned();
    assert!(outside.status.code() == Some(2) && message.contains("15 to 6000 rev/min"), "{message}");
}

#[test]
fn what_the_theory_does_not_know_is_refused_with_its_place() {
    let scratch = Scratch::new("lobes-refused");
    let Some(Table { milling, .. }) = tables().into_iter().next() else { panic!("a table") };
    let text = job(&milling);
    for (old, new, words) in [
        ("modes = [\n", "pitch = [170, 190]\nmodes = [\n", "uneven `pitch`"),
        ("damping = 0.011", "damping = 0", "modes` with damping"),
        ("direction = [1, 0, 0]", "direction = [0, 0, 1]", "not along Z"),
        ("[cutting]", "[nothing]", "unknown field"),
    ] {
        assert!(text.contains(old), "{old}");
        let job = scratch.write("job.toml", text.replace(old, new));
        let output = run(&["lobes", &job, "--speeds", "4000,9000"]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            output.status.code() == Some(1) && message.contains(words) && message.contains("job.toml:"),
            "{message}"
        );
    }
}
