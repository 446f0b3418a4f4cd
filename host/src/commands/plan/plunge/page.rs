//! Report page of a plan of plunges.

use std::fmt::Write as _;

use super::comparison::comparisons;
use super::figures::PlungeFigures;
use super::plot;
use super::result::PlungeResult;
use super::viewer;
use crate::report::page::{Page, Section, escaped};

/// Width and height of the picture.
const PICTURE: [f64; 2] = [640.0, 480.0];
/// Points of a blade's outline.
const OUTLINE: u32 = 24;

/// Page of a plan whose proof holds.
pub fn page(result: &PlungeResult, figures: &PlungeFigures) -> Page {
    let section = |heading: &str, body: String| Section { heading: heading.into(), body };
    let sections = vec![
        section("Verdict", verdict(figures)),
        section("Machinability", machinability(figures)),
        section("Largest tool along the passage", plot::largest(figures) + &largest(figures)),
        section("Axes of one passage, seen along the rotor's axis", picture(result)),
        section("Allowance left for side milling", plot::left_over(&result.left_over)),
        section("Comparison", compared(result)),
        section("Planes", planes(figures)),
        section("Clearances", clearances(figures)),
    ];
    Page { title: format!("Plan: {}", figures.name), lead: None, sections, viewer: Some(viewer::data(result)) }
}

fn verdict(figures: &PlungeFigures) -> String {
    let [left, right] = figures.left_over_mm();
    format!(
        "<p>The whole mill touches nothing on any plunge, and keeps the allowance on blades and hub.</p>\n\
         <p>{} plunges in {} planes, {:.1} min a passage without rapids and indexing; {} passages. Beyond the allowance at most \
         {left:.2} mm are left on the left blade and {right:.2} mm on the right one; the flat end is lifted by {:.2} mm at most above the \
         hub's allowance.</p>",
        figures.plunges,
        figures.planes.len(),
        figures.passage_min,
        figures.passages,
        figures.lift_max_mm
    )
}

/// Table with a heading; cells are plain text.
fn table(heads: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String], tag: &str| {
        let cells: String = cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let heads: Vec<String> = heads.iter().map(|head| (*head).to_owned()).collect();
    let body: String = rows.map(|row| line(&row, "td")).collect();
    format!("<table>\n{}{body}</table>", line(&heads, "th"))
}

fn machinability(figures: &PlungeFigures) -> String {
    let rows = ["pressure", "suction"].iter().zip(&figures.sides).map(|(name, side)| {
        let pair = |[one, other]: [f64; 2]| format!("{one:.2} / {other:.2}");
        let (sag, depth) = (format!("{:.3}", side.sag_mm), format!("{:.2}", side.depth_mm));
        vec![(*name).to_owned(), pair(side.twist_deg), pair(side.bend_deg), sag, depth]
    });
    let [narrow, wide] = figures.width_mm;
    let mut text = table(&["side", "twist, degrees", "bend, degrees", "sag, mm", "depth, mm"], rows);
    let _ = write!(
        text,
        "\n<p>Curves are split where they are curved most / where they are farthest from their chord. Twist of the camber lines: {:.2} degrees. \
         Width: {narrow:.2} to {wide:.2} mm between corresponding points; least distance of both sides {:.2} mm.</p>",
        figures.camber_twist_deg, figures.free_width_mm
    );
    text
}

fn largest(figures: &PlungeFigures) -> String {
    let point = |[x, y, z]: [f64; 3]| format!("{x:.2}, {y:.2}, {z:.2}");
    let rows = figures.largest.iter().map(|found| {
        let [left, right] = found.touching_mm.map(point);
        vec![format!("{:.2}", found.z_mm), format!("{:.2}", found.diameter_mm), left, right]
    });
    table(&["z, mm", "largest diameter, mm", "touches left", "touches right"], rows)
}

/// The passage by other mills that the part file describes.
fn compared(result: &PlungeResult) -> String {
    let rows = comparisons(result).into_iter().map(|row| match row.outcome {
        Ok([time_min, volume_mm3]) => vec![
            row.name.to_owned(),
            format!("{time_min:.1}"),
            format!("{:.2}", volume_mm3 / 1e3),
            format!("{:.2}", volume_mm3 / 1e3 / time_min),
            row.left,
        ],
        Err(why) => vec![row.name.to_owned(), String::new(), String::new(), String::new(), why],
    });
    let heads = ["way", "time of a passage, min", "volume, cm3", "rate, cm3/min", "left"];
    table(&heads, rows)
        + "<p>Times are those of the feed moves at the feeds of the part file. Flank milling is assumed to take the volume of the plunges, by passes side by side. Forces \
           and power of the program are those of `arcfeed simulate`.</p>"
}

fn planes(figures: &PlungeFigures) -> String {
    let pair = |[one, other]: [f64; 2]| format!("{one:.2} / {other:.2}");
    let rows = figures.planes.iter().map(|plane| {
        let cells = [pair(plane.width_mm), pair(plane.tilt_deg), pair(plane.left_over_mm), plane.columns.to_string()];
        let first = [plane.family.to_owned(), format!("{:.3}", plane.z_mm), format!("{:.3}", plane.radius_mm)];
        let last = [format!("{:.2}", plane.spacing_mm), format!("{:.2}", plane.step_ratio)];
        first.into_iter().chain(cells).chain(last).collect()
    });
    let heads = [
        "family",
        "z, mm",
        "radius, mm",
        "width at roof / floor, mm",
        "tilt left / right, degrees",
        "left over left / right, mm",
        "columns",
        "spacing, mm",
        "step / allowed",
    ];
    table(&heads, rows)
}

fn clearances(figures: &PlungeFigures) -> String {
    let rows = figures.clearances.iter().map(|found| {
        let (part, obstacle) = (found.part.clone(), found.obstacle.clone());
        vec![
            part,
            obstacle,
            format!("{:.3}", found.certified_mm),
            format!("{:.3}", found.found_mm),
            found.plunge.to_string(),
        ]
    });
    table(&["part", "obstacle", "at least, mm", "found, mm", "plunge"], rows)
}

/// Axes from their tips to the blank, and the outlines of both blades.
fn picture(result: &PlungeResult) -> String {
    let blisk = &result.part.blisk;
    let axes = result.plan.plunges.iter().map(|plunge| {
        let top = plunge.tip + plunge.axis * (plunge.roof_mm[0] - (plunge.to_tool * plunge.tip).z);
        vec![[plunge.tip.x, plunge.tip.y], [top.x, top.y]]
    });
    let share = |k: u32| f64::from(k) / f64::from(OUTLINE);
    let blades = [0, 1].map(|index| blisk.blade(index));
    let outlines = blades.iter().flat_map(|blade| [&blade.pressure, &blade.suction]).flat_map(|face| {
        [0.0, 0.5, 1.0]
            .map(|u| (0..=OUTLINE).map(|k| face.point(u, share(k))).map(|at| [at.x, at.y]).collect::<Vec<_>>())
    });
    let lines: Vec<(&str, Vec<[f64; 2]>)> =
        axes.map(|line| ("#1f5fa8", line)).chain(outlines.map(|line| ("#888", line))).collect();
    // Growing angles to the left, outwards upwards.
    let (sin, cos) = result.plan.planes.first().map_or((0.0, 1.0), |plane| libm::sincos(plane.boundary.middle_rad));
    let turned = |[x, y]: [f64; 2]| [y * cos - x * sin, -(x * cos + y * sin)];
    let all = || lines.iter().flat_map(|(_, line)| line.iter().copied().map(turned));
    let range = |axis: usize| {
        all().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at[axis]), high.max(at[axis])])
    };
    let ([left, right], [top, bottom]) = (range(0), range(1));
    let scale = (PICTURE[0] / (right - left)).min(PICTURE[1] / (bottom - top));
    let mut svg = format!(
        "<svg viewBox=\"-5 -5 {:.0} {:.0}\" width=\"{:.0}\">\n",
        PICTURE[0] + 10.0,
        PICTURE[1] + 10.0,
        PICTURE[0]
    );
    for (colour, line) in &lines {
        let points: Vec<String> = line
            .iter()
            .copied()
            .map(turned)
            .map(|[x, y]| format!("{:.1},{:.1}", (x - left) * scale, (y - top) * scale))
            .collect();
        let _ = writeln!(
            svg,
            "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"0.7\" points=\"{}\"/>",
            points.join(" ")
        );
    }
    svg + "</svg>"
}
