//! A line with a rise is one line for all levels: a job with two such rules adapts a program as one with a rule a level.

use std::fmt::Write;

use arcfeed_tests::{Scratch, root, run};
use serde_json::Value;

const HEAD: &str = "units = \"inch\"\nprogram = \"slot.nc\"\n\
    tool = { kind = \"cup-mill\", outer_radius = 5.06205, inner_radius = 4.43706, active_teeth = 10 }\n\
    spindle = { rev_per_min = 1000, set_by = \"operator\" }\nlimits = { max_feed = \"90000 mm\", max_raise = 100 }\nlaw = { kind = \"circumference\", feed_per_tooth = 0.004 }\n";

/// Rotation, direction, side, normal, and the line of one level with its rise: offset, at Z.
const RULES: [(&str, f64, f64, [f64; 2]); 2] = [
    ("rotation = \"exterior\"\ndirection = \"cw\"\nside = \"outer\"", 48.104, 0.05, [10.4502, -27.5688]),
    ("rotation = \"interior\"\ndirection = \"cw\"\nside = \"inner\"", 97.563, -0.03, [7.2959, -27.6626]),
];

const LEVELS: usize = 13;

fn program() -> String {
    std::fs::read_to_string(root().join("examples/ibr-slot/ibr-slot.nc")).expect("the example")
}

/// Z of the levels of the example program: its moves down, then the lines between levels.
fn heights() -> Vec<f64> {
    let program = program();
    let heights = program.lines().filter_map(|line| {
        let (words, rest) = line.split_once('Z')?;
        let is_level = words.contains("G93") || words.contains("G1X");
        let number: String = rest.chars().take_while(|c| "-.0123456789".contains(*c)).collect();
        is_level.then(|| number.parse().expect("a number"))
    });
    let heights: Vec<f64> = heights.collect();
    assert_eq!(heights.len(), LEVELS);
    heights
}

fn rising() -> String {
    let mut text = HEAD.to_owned();
    for (moves, normal_deg, rise, [offset, at]) in RULES {
        let offset = offset - rise * at;
        let _ = writeln!(
            text,
            "[[cut]]\n{moves}\nstock = {{ normal_deg = {normal_deg}, offset = {offset}, rise = {rise} }}"
        );
    }
    text
}

/// Movement 2 is on every second level from the second on, movement 4 on the others: 13 rules.
fn level_by_level() -> String {
    let mut text = HEAD.to_owned();
    for (level, z) in heights().into_iter().enumerate() {
        let (moves, normal_deg, rise, [offset, at]) = RULES[(level + 1) % 2];
        let offset = offset + rise * (z - at);
        let _ = writeln!(
            text,
            "[[cut]]\n{moves}\nstock = {{ normal_deg = {normal_deg}, offset = {offset} }}\nz = [{:.4}, {:.4}]",
            z - 0.04,
            z + 0.04
        );
    }
    text
}

fn adapted(scratch: &Scratch, name: &str, job: &str) -> (Vec<Value>, String) {
    let (job, out) = (scratch.write(name, job), scratch.path(&format!("{name}.nc")));
    let output = run(&["adapt", &job, "--json", "-o", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("JSON is text");
    let blocks = text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect();
    (blocks, std::fs::read_to_string(out).expect("what adapt wrote"))
}

#[test]
fn a_line_that_rises_is_a_line_for_every_level() {
    let scratch = Scratch::new("rise");
    scratch.write("slot.nc", program());
    let (rising, rising_nc) = adapted(&scratch, "rising.toml", &rising());
    let (levels, levels_nc) = adapted(&scratch, "levels.toml", &level_by_level());
    assert_eq!(rising_nc, levels_nc);
    assert_eq!(rising.len(), levels.len());
    let mut governed = Vec::new();
    for (own, other) in rising.iter().zip(&levels) {
        assert_eq!(own["n"], other["n"]);
        for key in ["feed_min", "feed_max", "contact_deg_start", "contact_deg_end"] {
            match (own[key].as_f64(), other[key].as_f64()) {
                (Some(own), Some(other)) => assert!((own - other).abs() <= 1e-5 * own.abs(), "{key}: {own}, {other}"),
                (own, other) => assert_eq!(own, other, "{key}"),
            }
        }
        assert_eq!(own["reason"], other["reason"]);
        if own["law"] == "circumference" {
            governed.push(own["feed_min"].as_f64());
        }
    }
    println!("{} arcs governed, {governed:.2?} in/min", governed.len());
    assert_eq!(governed.len(), LEVELS);
}
