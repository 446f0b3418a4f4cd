//! `arcfeed law`: published feeds, a second derivation, and the same numbers as `adapt`.

use std::f64::consts::TAU;

use arcfeed_tests::{Scratch, root, run};
use serde_json::Value;

const CASE: &str = "tests/cases/table-5-4/job.toml";

/// Worked examples of the contour law on public calculator pages: feed at the edge, diameters of tool and feature, side, feed of
/// the centre as printed.
const PUBLISHED_CONTOURS: [(f64, f64, f64, &str, f64, f64); 4] = [
    (20.0, 0.5, 1.0, "inside", 10.0, 0.005),
    (40.0, 1.0, 8.0, "inside", 35.0, 0.05),
    (8.3, 0.370, 0.562, "inside", 2.8, 0.05),
    (8.3, 0.370, 0.562, "outside", 13.8, 0.05),
];

/// Published ranges of feed of the four movements, in/min, and the lines of their arcs in the case's program.
const PUBLISHED_ROTATIONS: [(usize, [f64; 2]); 4] =
    [(5, [74.6, 76.0]), (6, [41.0, 48.0]), (8, [60.5, 62.0]), (9, [40.0, 50.6])];

fn law(options: &[&str]) -> Value {
    let output = run(&[&["law"], options, &["--json"]].concat());
    assert!(output.status.success(), "{options:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report}"))
}

#[test]
fn published_movements_have_their_feeds_at_the_ends_of_their_ranges() {
    for (line, [least, most]) in PUBLISHED_ROTATIONS {
        let at = |place: usize| {
            let place = format!("{}", place as f64 / 40.0);
            number(&law(&["--job", CASE, "--line", &line.to_string(), "--at", &place]), "feed")
        };
        let feeds: Vec<f64> = (0..=40).step_by(4).map(at).collect();
        let found = [feeds.iter().copied().fold(f64::INFINITY, f64::min), feeds.iter().copied().fold(0.0, f64::max)];
        println!("line {line}: {found:.2?} in/min, published {least} .. {most}");
        assert!((found[0] - least).abs() < 0.2 && (found[1] - most).abs() < 0.2, "{line}: {found:?}");
    }
}

#[test]
fn published_contour_feeds_are_those_of_the_command() {
    for (edge, tool, feature, side, printed, rounding) in PUBLISHED_CONTOURS {
        let sign = if side == "inside" { -1.0 } else { 1.0 };
        let [rho, radius] = [(feature + sign * tool) / 2.0, tool / 2.0].map(|length| length.to_string());
        // One tooth a minute: the feed is the feed per tooth.
        let options = ["--rho", &rho, "--radius", &radius, "--edge", side, "--feed-per-tooth", &edge.to_string()];
        let report = law(&[&options[..], &["--spindle", "1", "--teeth", "1", "--units", "inch"]].concat());
        let feed = number(&report, "feed");
        println!("{side}: {feed:.3}, printed {printed}");
        assert!((feed - printed).abs() <= rounding, "{feed} for {printed}");
    }
}

/// Turn of the centre about A for a chip `a` at the contact, by bisection of the source's own condition: after the turn the
/// circle of radius r0 about O' passes through C = (r0 + k a) u.
fn turn_rad(rho: f64, r0: f64, k: f64, a: f64, [ux, uy]: [f64; 2]) -> f64 {
    let [cx, cy] = [(r0 + k * a) * ux, (r0 + k * a) * uy];
    // Above 0 as long as the edge has not reached C.
    let gap = |turn: f64| {
        let (ox, oy) = (rho * libm::sin(turn), rho * (1.0 - libm::cos(turn)));
        k * (libm::hypot(cx - ox, cy - oy) - r0)
    };
    let step = 1e-5;
    let first = (1..).map(|count| f64::from(count) * step).find(|turn| gap(*turn) <= 0.0).expect("it reaches C");
    let [mut low, mut high] = [first - step, first];
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        *(if gap(middle) > 0.0 { &mut low } else { &mut high }) = middle;
    }
    high
}

#[test]
fn a_second_derivation_gives_the_same_step() {
    let mut worst = [0.0_f64; 2];
    for (rho, r0, edge, k) in [
        (112.701324, 128.57607, "outer", 1.0),
        (128.57607, 128.57607, "outer", 1.0),
        (128.57607, 112.701324, "inner", -1.0),
        (40.0, 60.0, "inner", -1.0),
    ] {
        for contact in [25.0_f64, 50.0, 75.0, 100.0] {
            let (sin, cos) = libm::sincos(contact.to_radians());
            let wanted = rho * turn_rad(rho, r0, k, 0.1016, [k * sin, cos]);
            let options = ["--rho", &rho.to_string(), "--radius", &r0.to_string(), "--edge", edge];
            let report =
                law(&[&options[..], &["--feed-per-tooth", "0.1016", "--contact", &contact.to_string()]].concat());
            let off = ["ipt_center", "ipt_center_controller"].map(|key| (number(&report, key) / wanted - 1.0).abs());
            worst = [worst[0].max(off[0]), worst[1].max(off[1])];
        }
    }
    println!("16 cases: {:.1e} at most, the controller {:.1e}", worst[0], worst[1]);
    assert!(worst[0] < 1e-9 && worst[1] < 2e-6, "{worst:?}");
}

#[test]
fn a_stock_line_gives_the_contact_that_the_angle_gives() {
    // O at 270 degrees from A moves to the right; u at 40 degrees from A towards the motion. The line passes through B.
    let (rho, r0) = (100.0, 80.0);
    let (sin, cos) = libm::sincos(40.0 / 360.0 * TAU);
    let b = [r0 * sin, -rho + r0 * cos];
    let offset = (b[0] * libm::cos(0.3) + b[1] * libm::sin(0.3)).to_string();
    let options = ["--rho", "100", "--radius", "80", "--edge", "outer", "--feed-per-tooth", "0.1"];
    let line = ["--stock-normal", &0.3_f64.to_degrees().to_string(), "--stock-offset", &offset, "--position", "270"];
    let [by_line, by_angle] = [&line[..], &["--contact", "40"]].map(|contact| law(&[&options[..], contact].concat()));
    let [line, angle] = [&by_line, &by_angle].map(|report| number(report, "ipt_center"));
    assert!((line / angle - 1.0).abs() < 1e-12, "{line} and {angle}");
}

#[test]
fn the_drawing_has_the_circles_and_what_makes_no_sense_is_refused() {
    let scratch = Scratch::new("law-drawing");
    let svg = scratch.path("law.svg");
    law(&["--job", CASE, "--line", "5", "--svg", &svg]);
    let drawn = std::fs::read_to_string(svg).expect("the drawing");
    assert!(
        drawn.matches("<circle").count() >= 8 && drawn.contains(">O'</text>") && drawn.contains("stock line"),
        "{drawn}"
    );
    let options = ["law", "--rho", "100", "--radius", "80", "--edge", "outer", "--feed-per-tooth", "0.1"];
    let line = ["--stock-normal", "0", "--stock-offset", "300", "--position", "0"];
    for (more, code, words) in [
        (&["--contact", "190"][..], 2, "less than 180"),
        (&[], 2, "--contact DEGREES is missing"),
        (&line, 1, "does not meet the stock line"),
        (&["--contact", "179.9"], 1, "no step gives this chip"),
    ] {
        let output = run(&[&options[..], more].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(code) && message.contains(words), "{more:?}: {message}");
    }
    let job = root().join("examples/pocket/job-engagement.toml");
    let output = run(&["law", "--job", job.to_str().expect("ASCII"), "--line", "13"]);
    assert!(
        output.status.code() == Some(1)
            && String::from_utf8_lossy(&output.stderr).contains("pocket.nc:13:1: the law of this block")
    );
}
