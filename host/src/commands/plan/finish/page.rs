//! Report page of a plan of finishing passes.

use arcfeed_kinematics::vector::Vector;

use super::super::planned_path::solid;
use super::figures::{FinishClearanceFigures, FinishFigures};
use super::result::FinishResult;
use super::viewer;
use crate::post::chart::chart;
use crate::report::page::{Page, Section, escaped};

/// Page of a plan whose proof holds.
pub fn page(result: &FinishResult, figures: &FinishFigures) -> Page {
    let section = |heading: &str, body: String| Section { heading: heading.into(), body };
    let sections = vec![
        section("Verdict", verdict(figures)),
        section("Clearances", clearances(&figures.clearances)),
        section("First rotary axis over the directions of the tool", picture(result)),
        section("Findings of the post-processor", findings(result)),
    ];
    let title = format!("Plan: {}", figures.name);
    let solids = vec![solid(viewer::UNIT, "blades and hub", &viewer::surroundings(&result.part.blisk, 0))];
    Page { viewer: Some(viewer::data(title.clone(), result, solids)), title, lead: None, sections }
}

/// Chart of the tool axes on the machine.
pub fn picture(result: &FinishResult) -> String {
    let axes: Vec<Vector> = result.axes.stops.iter().map(|stop| stop.pose.axis).collect();
    chart(&result.task.machine, &axes)
}

fn verdict(figures: &FinishFigures) -> String {
    let [low, high] = figures.feed.unwrap_or([0.0; 2]);
    format!(
        "<p>The whole mill keeps its distances on every move. {} passes with {} points, {:.1} min of feed moves for one of {} blades.</p>\n\
         <p>Feed {:.1} mm/min wanted; F {low:.1} to {high:.1}. On {} moves the machine's axes allow no more.</p>",
        figures.passes, figures.points, figures.minutes, figures.blades, figures.target_feed, figures.limited_moves
    )
}

/// Table of clearances.
pub fn clearances(figures: &[FinishClearanceFigures]) -> String {
    let rows: String = figures
        .iter()
        .map(|found| {
            format!(
                "<tr><td>{}</td><td>{}</td><td>{:.3}</td><td>{:.3}</td><td>{}</td></tr>\n",
                found.part, found.obstacle, found.certified_mm, found.needed_mm, found.move_number
            )
        })
        .collect();
    format!(
        "<table>\n<tr><th>part</th><th>obstacle</th><th>at least, mm</th><th>needed, mm</th><th>move</th></tr>\n{rows}</table>"
    )
}

/// List of the post-processor's findings.
pub fn findings(result: &FinishResult) -> String {
    if result.axes.findings.is_empty() {
        return "<p>None.</p>".into();
    }
    let items: String = result
        .axes
        .findings
        .iter()
        .map(|finding| format!("<li>move {}</li>\n", escaped(&finding.to_string())))
        .collect();
    format!("<ul>\n{items}</ul>")
}
