//! Report page of the plan of a repair: maps over the unrolled side, v to the right and u upwards.

use std::fmt::Write as _;

use super::super::finish::page::{clearances, findings, picture};
use super::figures::{RepairFigures, text};
use super::result::RepairResult;
use super::viewer::{self, BEFORE, PLANNED, PREDICTED, TAKEN};
use crate::report::page::{Page, Section, escaped};

/// Verdict of a plan whose proof holds.
const VERDICT: &str = "The whole mill keeps its distances on every move, from above the part and back.";

/// Width of a map; its height follows from the lattice.
const WIDTH: f64 = 560.0;

/// Page of a plan.
pub fn page(result: &RepairResult, figures: &RepairFigures) -> Page {
    let plan = &result.plan;
    let section = |heading: &str, body: String| Section { heading: heading.into(), body };
    let before = map(result, BEFORE, |i, j| plan.field.rows[i][j].along_mm);
    let left = map(result, PLANNED, |i, j| plan.planned_mm[i][j].or(plan.field.rows[i][j].along_mm));
    let taken = map(result, TAKEN, |i, j| Some((plan.field.rows[i][j].along_mm? - plan.planned_mm[i][j]?).max(0.0)));
    let predicted = map(result, PREDICTED, |i, j| Some(result.predicted_mm[i][j]? - plan.planned_mm[i][j]?));
    let sections = vec![
        section("Verdict", format!("<p>{VERDICT}</p>\n<pre>{}</pre>", escaped(&text(figures)))),
        section(BEFORE, before),
        section(PLANNED, left),
        section(TAKEN, taken),
        section(PREDICTED, predicted),
        section("Clearances", clearances(&figures.clearances)),
        section("First rotary axis over the directions of the tool", picture(&result.path)),
        section("Findings of the post-processor", findings(&result.path)),
    ];
    Page { title: format!("Repair: {}", figures.name), lead: None, sections, viewer: Some(viewer::data(result)) }
}

/// Map of a value in mm over the lattice: from blue, the least, to red, the greatest; places without a value are grey.
fn map(result: &RepairResult, label: &str, value: impl Fn(usize, usize) -> Option<f64>) -> String {
    let rows = &result.plan.field.rows;
    let (high, wide) = (rows.len(), rows[0].len());
    let values = || (0..high).flat_map(|i| (0..wide).map(move |j| (i, j)));
    let (low, top) = values()
        .filter_map(|(i, j)| value(i, j))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, top), mm| (low.min(mm), top.max(mm)));
    let size = WIDTH / wide as f64;
    let mut text = format!(
        "<svg viewBox=\"0 0 {WIDTH} {:.1}\" width=\"{WIDTH}\" role=\"img\" aria-label=\"Map: {label}\">\n",
        size * high as f64
    );
    for (i, j) in values() {
        let colour = value(i, j).map_or("#999".into(), |mm| {
            let share = if top > low { (mm - low) / (top - low) } else { 0.0 };
            format!("hsl({:.0} 80% 50%)", 240.0 * (1.0 - share))
        });
        let (x, y) = (size * j as f64, size * (high - 1 - i) as f64);
        let _ = writeln!(
            text,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{size:.2}\" height=\"{size:.2}\" fill=\"{colour}\"/>"
        );
    }
    let range = if low <= top { format!("{low:.3} mm (blue) to {top:.3} mm (red)") } else { "no values".into() };
    let _ = write!(text, "</svg>\n<p>{range}; root below, tip above, leading edge on the left.</p>");
    text
}
