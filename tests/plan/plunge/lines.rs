//! One-sided lines and steps.

use arcfeed_plan::plunge::line::{CurveSample, Fit, support_line};
use arcfeed_plan::plunge::step::stepover;

use super::table::{Worst, rows};

#[test]
fn point_1_one_sided_lines_are_those_of_hull_and_linear_program() {
    let mut worst = Worst::default();
    for row in rows(include_str!("data/an_one_sided_line.csv")) {
        let c = row.numbers(["c0", "c1", "c2", "c3", "c4", "c5"]);
        let samples: Vec<CurveSample> = (0..=2000)
            .map(|k| {
                let s = f64::from(k - 1000) / 1000.0;
                let height_mm = c.iter().rev().fold(0.0, |sum, c| sum * s + c);
                CurveSample { along_mm: s, height_mm, is_counted: true }
            })
            .collect();
        let gap = support_line(&samples, Fit::Gap).unwrap();
        let area = support_line(&samples, Fit::Area).unwrap();
        let least = |line: &arcfeed_plan::plunge::line::SupportLine| {
            samples.iter().map(|sample| line.at_mm(sample.along_mm) - sample.height_mm).fold(f64::INFINITY, f64::min)
        };
        assert!(least(&gap) > -1e-12 && least(&area) > -1e-12, "{}", row.word("case"));
        for (kind, found, column) in [
            ("gap: greatest", gap.gap_max_mm, "gap_max"),
            ("gap: line", gap.offset_mm, "gap_a"),
            ("gap: line", gap.slope, "gap_b"),
            ("area: greatest", area.gap_max_mm, "area_gap_max"),
            ("area: line", area.offset_mm, "area_a"),
            ("area: line", area.slope, "area_b"),
        ] {
            worst.absolute(kind, found, row.number(column));
        }
        // Trapezia between line and samples.
        let gaps: Vec<f64> = samples.iter().map(|sample| area.at_mm(sample.along_mm) - sample.height_mm).collect();
        let sum: f64 = gaps.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0 / 1000.0).sum();
        worst.absolute("area", sum, row.number("area"));
    }
    let limits = ["gap: greatest", "gap: line", "area: greatest", "area: line", "area"].map(|kind| (kind, 1e-6));
    worst.within("an_one_sided_line", &limits);
}

#[test]
fn point_1_steps_leave_the_cusp_of_two_circles() {
    let mut worst = Worst::default();
    for row in rows(include_str!("data/an_step.csv")) {
        let [radius_mm, cusp_mm] = row.numbers(["R_mm", "cusp_mm"]);
        let curvature = match row.word("wall") {
            "convex" => 1.0 / row.number("rho_mm"),
            "concave" => -1.0 / row.number("rho_mm"),
            _ => 0.0,
        };
        let found = stepover(radius_mm, cusp_mm, curvature).unwrap();
        worst.relative("between axes", found.axes_mm, row.number("centers_mm"));
        worst.relative("along the wall", found.wall_mm, row.number("wall_arc_mm"));
        worst.relative("angle", found.angle_rad.to_degrees(), row.number("angle_deg"));
    }
    worst.within("an_step", &["between axes", "along the wall", "angle"].map(|kind| (kind, 1e-6)));
    assert_eq!(stepover(5.0, 0.1, -0.25), None, "a hollow narrower than the tool");
    assert_eq!(stepover(5.0, 6.0, 0.0), None, "a cusp higher than the tool is wide");
}
