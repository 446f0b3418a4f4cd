//! A program as shops run it, with work offsets, tool lengths, a turned bolt circle, canned cycles and reference returns,
//! from `adapt` over `simulate` to `serve` on a pseudo-terminal; its time against the sum of its moves, worked out by hand
//! from the drawing and the offsets.
#![cfg(unix)]

use std::f64::consts::PI;

use arcfeed_tests::{Running, Scratch, root, run};
use serde_json::Value;

const JOB: &str = "tests/cases/shop-program/job.toml";
const CASE: &str = "tests/cases/shop-program";
/// Path acceleration, mm/s2, the speed that a corner may keep in one axis and the rapid, mm/s: docs/control.md.
const ACCELERATION: f64 = 500.0;
const CORNER: f64 = 5.0;
const RAPID: f64 = 200.0;
/// A move begins and ends between two steps of 1 ms.
const PER_MOVE_S: f64 = 1e-3;

/// From rest to rest.
fn time_s(length_mm: f64, speed_mm_per_s: f64) -> f64 {
    if length_mm * ACCELERATION < speed_mm_per_s * speed_mm_per_s {
        return 2.0 * libm::sqrt(length_mm / ACCELERATION);
    }
    length_mm / speed_mm_per_s + speed_mm_per_s / ACCELERATION
}

/// Two rapids at right angles: the corner between them keeps its speed.
fn corner_s(first_mm: f64, second_mm: f64) -> f64 {
    let not_lost = (2.0 * CORNER / ACCELERATION) - CORNER * CORNER / (ACCELERATION * RAPID);
    time_s(first_mm, RAPID) + time_s(second_mm, RAPID) - not_lost
}

/// The whole program, the bore at `feed` mm/min; and of how many moves it is made.
fn program_s(feed: f64) -> (f64, usize) {
    let rapid = |mm: f64| time_s(mm, RAPID);
    let cut = |mm: f64, feed: f64| time_s(mm, feed / 60.0);
    let mut times = vec![
        // G54: X20 Y0 is -280, -200; Z-5 with a tool of 120.5 is -400 + 120.5 - 5 = -284.5.
        corner_s(libm::hypot(280.0, 200.0), 284.5),
        cut(2.0 * PI * 20.0, feed),
        // G81 at the centre, from Z-5 to Z-8 at F1500, up again, and Z to the machine's zero.
        rapid(20.0),
        cut(3.0, 1500.0),
        rapid(3.0),
        rapid(284.5),
        // G55: X0 Y0 is -100, -200, from -300, -200; Z50 with a tool of 150 is -395 + 150 + 50 = -195.
        corner_s(200.0, 195.0),
        // To the first hole and R; from the first to the second hole, a quarter of the circle on.
        rapid(40.0),
        rapid(48.0),
        rapid(40.0 * libm::sqrt(2.0)),
        // Back to the middle and up, to R, the tap down and up, up, and by way of Z5 to zero.
        rapid(libm::hypot(40.0, 48.0)),
        rapid(48.0),
        cut(12.0, 1000.0),
        cut(12.0, 1000.0),
        rapid(48.0),
        rapid(45.0),
        rapid(395.0 - 150.0 - 5.0),
    ];
    for _hole in 0..2 {
        // 20 mm in cuts of 8, 8 and 4; those behind the first begin 1 mm higher; out to R each time, and back to 1 mm above.
        times.extend([cut(8.0, 300.0), rapid(8.0), rapid(7.0), cut(9.0, 300.0), rapid(16.0), rapid(15.0)]);
        times.extend([cut(5.0, 300.0), rapid(20.0)]);
    }
    (times.iter().sum(), times.len() + 2)
}

fn report(out: &str) -> Value {
    let line = out.lines().find(|line| line.starts_with('{')).unwrap_or_else(|| panic!("no JSON in {out:?}"));
    serde_json::from_str(line).expect("JSON")
}

fn json(arguments: &[&str]) -> Value {
    let output = run(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    report(&String::from_utf8(output.stdout).expect("text"))
}

#[track_caller]
fn assert_time(found: &Value, feed: f64) {
    let (wanted_s, moves) = program_s(feed);
    let found_s = found.as_f64().expect("a time");
    println!("{found_s:.3} s, by hand {wanted_s:.3} s, {moves} moves");
    assert!((found_s - wanted_s).abs() < PER_MOVE_S * moves as f64, "{found_s} s, not {wanted_s} s");
}

/// The bore's path has a radius of 20, its wall one of 25: 0.1 mm a tooth at the wall is 3200 * 20 / 25.
const BORE: f64 = 2560.0;

#[test]
fn only_the_bore_is_adapted_and_what_follows_gets_its_feed_back() {
    let scratch = Scratch::new("shop-adapt");
    let out = scratch.path("out.nc");
    assert!(run(&["adapt", JOB, "-o", &out]).status.success());
    let [program, sent] = [format!("{}/{CASE}/shop.nc", root().display()), out]
        .map(|path| std::fs::read_to_string(path).expect("a program"));
    let wanted = program
        .replace("N70G3I-20.F1500.", "N70G3I-20.F2560.")
        .replace("N85G98G81X0Y0Z-8.R-5.", "N85G98G81X0Y0Z-8.R-5.F1500.");
    assert_eq!(sent, wanted);
}

#[test]
fn checked_with_the_settings_of_its_job_it_has_the_moves_that_are_counted_by_hand() {
    let report = json(&["check", JOB, "--json"]);
    let counts = ["arcs", "linear", "rapids"].map(|kind| report["counts"][kind].as_u64().expect("a count"));
    // Cut straight: G81 once, two holes in three cuts each, the tap down and up.
    assert_eq!(counts, [1, 9, 25]);
    assert_eq!(counts.iter().sum::<u64>(), program_s(BORE).1 as u64);
    assert_eq!((&report["warnings"], &report["control"]), (&Value::Array(vec![]), &Value::from("fanuc-16i")));
}

#[test]
fn simulated_it_takes_the_time_of_its_moves() {
    let report = json(&["simulate", JOB, "--json"]);
    assert_eq!((&report["blocks_executed"], &report["alarms"]), (&Value::from(24), &Value::Array(vec![])));
    assert_time(&report["cycle_time_s"], BORE);
    assert_time(&report["baseline_cycle_time_s"], 1500.0);
    assert_eq!(report["movements"][0]["arcs"], 1, "the bore, at the level that the drawing says");
    let streamed = json(&["stream", JOB, "--json"]);
    assert_eq!((&streamed["blocks_executed"], &streamed["link"]["starved_ms"]), (&Value::from(24), &Value::from(0)));
    assert_eq!(streamed["cycle_time_s"], report["cycle_time_s"]);
}

#[test]
fn served_on_a_pseudo_terminal_it_does_the_same() {
    let scratch = Scratch::new("shop-serve");
    let (executed, out) = (scratch.path("served.nc"), scratch.path("out.nc"));
    let arguments =
        ["serve", JOB, "--pty", "--once", "--json", "--executed", &executed, "--speed", "20", "--baudrate", "115200"];
    let mut server = Running::start(&scratch, "serve", &arguments);
    let port = server.line("port: ");
    let journal = scratch.path("journal");
    let stream = ["stream", JOB, "--port", &port, "--baudrate", "115200", "--journal", &journal];
    let sender = Running::start(&scratch, "stream", &stream).end();
    assert_eq!(sender.code, Some(0), "{}", sender.err);
    let served = server.end();
    assert_eq!(served.code, Some(0), "{}", served.err);
    assert_time(&report(&served.out)["cycle_time_s"], BORE);
    assert!(run(&["adapt", JOB, "-o", &out]).status.success());
    let blocks = |path: &str| -> Vec<String> {
        let text = std::fs::read_to_string(path).expect("blocks");
        text.lines().filter(|line| *line != "%").map(str::to_owned).collect()
    };
    assert_eq!(blocks(&executed), blocks(&out));
}

#[test]
fn a_job_means_the_drawing_wherever_the_work_offset_is() {
    let scratch = Scratch::new("shop-offset");
    let job = std::fs::read_to_string(root().join("examples/ibr-slot/job.toml")).expect("the example");
    let program = root().join("examples/ibr-slot/ibr-slot.nc");
    let job = job.replace("\"ibr-slot.nc\"", &format!("{:?}", program.display().to_string()));
    let plain = scratch.write("plain.toml", &job);
    scratch.write("machine.toml", "unit = 'mm'\n[work]\nG54 = { X = -311.5, Y = 47.25, Z = -120.0 }\n");
    let elsewhere = scratch.write("elsewhere.toml", job.replace("[control]", "[control]\nsettings = \"machine.toml\""));
    let sent = |job: &str| {
        let out = scratch.path("out.nc");
        assert!(run(&["adapt", job, "-o", &out]).status.success());
        std::fs::read(&out).expect("a program")
    };
    assert_eq!(sent(&plain), sent(&elsewhere));
    let [here, there] = [&plain, &elsewhere].map(|job| json(&["simulate", job, "--json"]));
    let arcs = |report: &Value| -> Vec<u64> {
        let movements = report["movements"].as_array().expect("movements").iter();
        movements.map(|movement| movement["arcs"].as_u64().expect("a count")).collect()
    };
    assert_eq!((arcs(&here), &here["override"]["max"]), (arcs(&there), &there["override"]["max"]));
    let error = |report: &Value| report["chip_load"]["error_ratio_max"].as_f64().expect("chips");
    println!("largest error of the chip: {} here, {} there", error(&here), error(&there));
    assert!(error(&there) < 5e-3);
}

/// The job of the example's fourth movement, its stock line turned by 90 degrees, and what it makes of a program.
fn turned_arc(scratch: &Scratch, name: &str, program: &str) -> Value {
    scratch.write(&format!("{name}.nc"), program);
    let job = format!(
        "units = \"inch\"\nprogram = \"{name}.nc\"\n[tool]\nkind = \"cup-mill\"\nouter_radius = 5.06205\n\
         inner_radius = 4.43706\nactive_teeth = 10\n[spindle]\nrev_per_min = 1000\nset_by = \"operator\"\n[limits]\nmax_feed = \"90000 mm\"\nmax_raise = 100\n[law]\nkind = \"circumference\"\n\
         feed_per_tooth = 0.004\n[[cut]]\nrotation = \"interior\"\ndirection = \"cw\"\nside = \"inner\"\n\
         stock = {{ normal_deg = 187.563, offset = 7.2959 }}\n"
    );
    let job = scratch.write(&format!("{name}.toml"), job);
    let output = run(&["adapt", &job, "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("text");
    let mut block: Value = serde_json::from_str(text.lines().last().expect("a block")).expect("JSON");
    block["line"] = Value::Null;
    block
}

#[test]
fn a_law_governs_an_arc_turned_shifted_or_mirrored_where_the_machine_makes_it() {
    let scratch = Scratch::new("shop-turned");
    // A point x, y turned by 90 degrees is -y, x.
    let by_hand = "%\nG20G0X-10.5358Y-3.6044\nG2X-11.3322Y-3.0241I2.1989J3.8539F25.\nM30\n%\n";
    let turned = "%\nG20G68X0Y0R90.\nG0X-3.6044Y10.5358\nG2X-3.0241Y11.3322I3.8539J-2.1989F25.\nM30\n%\n";
    let shifted = "%\nG20G52X-10.Y-3.\nG0X-.5358Y-.6044\nG2X-1.3322Y-.0241I2.1989J3.8539F25.\nM30\n%\n";
    let mirrored = "%\nG20G51.1X0\nG0X10.5358Y-3.6044\nG3X11.3322Y-3.0241I-2.1989J3.8539F25.\nM30\n%\n";
    let halved = "%\nG20G51X0Y0P500\nG0X-21.0716Y-7.2088\nG2X-22.6644Y-6.0482I4.3978J7.7078F25.\nM30\n%\n";
    let wanted = turned_arc(&scratch, "by-hand", by_hand);
    assert_eq!(wanted["reason"], "law", "{wanted}");
    assert_eq!(turned_arc(&scratch, "turned", turned), wanted);
    assert_eq!(turned_arc(&scratch, "shifted", shifted), wanted);
    assert_eq!(turned_arc(&scratch, "mirrored", mirrored), wanted);
    assert_eq!(turned_arc(&scratch, "halved", halved), wanted);
}

#[test]
fn a_move_under_g41_keeps_its_feed_and_that_is_said_at_its_place() {
    let scratch = Scratch::new("shop-g41");
    let job = std::fs::read_to_string(root().join(JOB)).expect("the job").replace("settings = \"machine.toml\"", "");
    let job = scratch.write("job.toml", job);
    let program = scratch.write("shop.nc", "%\nG21S3000M3G0X20.Y0Z-5.\nG1G41D1X25.F900.\nG3I-25.\nG1G40X20.\nM30\n%\n");
    let out = scratch.path("out.nc");
    let output = run(&["adapt", &job, "-o", &out]);
    let said = String::from_utf8(output.stderr).expect("text");
    assert!(output.status.success() && said.lines().count() == 2, "{said}");
    assert!(said.contains("no move is governed, so all feeds stay as programmed"), "{said}");
    assert!(said.starts_with(&format!("{program}:4:1: warning: ")) && said.contains("under G41"), "{said}");
    assert_eq!(std::fs::read(&out).expect("a program"), std::fs::read(&program).expect("a program"));
    assert!(run(&["simulate", &job]).status.success());
}
