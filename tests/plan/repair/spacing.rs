//! Equal arcs, passes and chords.

use std::collections::BTreeMap;

use arcfeed_plan::geometry::surface::Surface;
use arcfeed_plan::repair::arc_length::ArcLength;
use arcfeed_plan::repair::stepover::{contact_chord, pass_spacing};

use super::surfaces::Sheet;
use crate::plunge::table::{Row, Worst, rows};

#[test]
fn point_1_equal_arcs_are_those_of_quadrature() {
    let table = rows(include_str!("data/feng_arc_length.csv"));
    let mut cases: BTreeMap<&str, Vec<&Row<'_>>> = BTreeMap::new();
    for row in &table {
        cases.entry(row.word("case")).or_default().push(row);
    }
    let mut worst = Worst::default();
    for case in cases.values() {
        let [p, q] = case[0].numbers(["p", "q"]);
        let (range, speed): ([f64; 2], Box<dyn Fn(f64) -> f64>) = match case[0].word("curve") {
            "ellipse" => {
                let speed = move |t: f64| libm::hypot(p * libm::sin(t), q * libm::cos(t));
                ([0.0, core::f64::consts::FRAC_PI_2], Box::new(speed))
            }
            "parabola" => ([-1.0, 3.0], Box::new(move |x: f64| libm::hypot(1.0, 2.0 * p * x))),
            "spiral" => ([0.0, 2.0], Box::new(move |t: f64| p * libm::hypot(1.0, q) * libm::exp(q * t))),
            "sheet_v" => ([0.0, 1.0], Box::new(move |v: f64| Sheet.jet([p, v]).v.norm())),
            other => panic!("{other}"),
        };
        let curve = ArcLength::new(range, speed);
        let places = curve.equal_arcs(case.len());
        for (row, place) in case.iter().zip(places) {
            worst.absolute("parameter", place, row.number("parameter"));
            worst.absolute("length, mm", curve.length_mm(), row.number("length_mm"));
        }
    }
    worst.within("feng_arc_length", &[("parameter", 1e-9), ("length, mm", 1e-9)]);
}

#[test]
fn point_1_passes_follow_the_longest_cross_line() {
    let mut worst = Worst::default();
    for row in rows(include_str!("data/feng_stepover.csv")) {
        let lengths_mm = row.numbers(["l0", "l1", "l2", "l3", "l4", "l5", "l6", "l7", "l8"]);
        if row.word("surface") == "sheet" {
            let from = row.number("p1");
            for (k, expected) in lengths_mm.iter().enumerate() {
                let u = from + (1.0 - from) * k as f64 / 8.0;
                let line = ArcLength::new([0.0, 1.0], |v| Sheet.jet([u, v]).v.norm());
                worst.absolute("cross line, mm", line.length_mm(), *expected);
            }
        }
        let spacing = pass_spacing(&lengths_mm, row.number("stepover_mm")).unwrap();
        worst.absolute("passes", spacing.passes as f64, row.number("paths"));
        worst.absolute("least, mm", spacing.least_mm, row.number("least_mm"));
        worst.absolute("greatest, mm", spacing.greatest_mm, row.number("greatest_mm"));
    }
    let limits = [("passes", 0.0), ("least, mm", 1e-9), ("greatest, mm", 1e-9), ("cross line, mm", 1e-9)];
    worst.within("feng_stepover", &limits);
    assert_eq!(pass_spacing(&[], 0.5), None);
    assert_eq!(pass_spacing(&[10.0], 0.0), None);
}

#[test]
fn point_1_chords_are_those_of_the_ball_s_centre() {
    let mut worst = Worst::default();
    for row in rows(include_str!("data/feng_chord.csv")) {
        let sign = if row.word("wall") == "convex" { 1.0 } else { -1.0 };
        let [ball_mm, tolerance_mm, rho_mm] = row.numbers(["ball_mm", "tolerance_mm", "rho_mm"]);
        let chord = contact_chord(ball_mm, tolerance_mm, sign / rho_mm).unwrap();
        worst.absolute("centres, mm", chord.centres_mm, row.number("centers_mm"));
        worst.absolute("surface, mm", chord.surface_mm, row.number("contact_arc_mm"));
    }
    worst.within("feng_chord", &[("centres, mm", 1e-9), ("surface, mm", 1e-9)]);
    assert_eq!(contact_chord(3.0, 0.01, -1.0 / 3.0), None, "a hollow as narrow as the ball");
    assert_eq!(contact_chord(3.0, 0.01, 0.0).unwrap().surface_mm, f64::INFINITY);
}
