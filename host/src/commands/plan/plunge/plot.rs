//! Plots of a plan of plunges as SVG: the largest tool along the passage, and the allowance left for side milling.

use std::fmt::Write as _;

use arcfeed_plan::plunge::left_over::{HEIGHTS, LeftOverRow};

use super::figures::PlungeFigures;
use crate::report::page::escaped;

/// Width and height of the plot.
const PLOT: [f64; 2] = [640.0, 200.0];
/// Room for the numbers beside it.
const MARGIN: f64 = 45.0;
/// Width and height of a cell of the map.
const CELL: [f64; 2] = [24.0, 12.0];

/// SVG plot of the largest possible diameter along the rotor's axis, with the diameter of the mill; empty if no plane
/// was measured.
pub fn largest(figures: &PlungeFigures) -> String {
    let places: Vec<[f64; 2]> = figures.largest.iter().map(|found| [found.z_mm, found.diameter_mm]).collect();
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return String::new() };
    let most_mm = places.iter().map(|[_, diameter_mm]| *diameter_mm).fold(figures.diameter_mm, f64::max) * 1.1;
    let x = |z_mm: f64| MARGIN + (z_mm - first[0]) / (last[0] - first[0]).max(1e-9) * PLOT[0];
    let y = |diameter_mm: f64| PLOT[1] * (1.0 - diameter_mm / most_mm);
    let line: Vec<String> = places.iter().map(|[z, diameter]| format!("{:.1},{:.1}", x(*z), y(*diameter))).collect();
    let mill = y(figures.diameter_mm);
    let text = |at: [f64; 2], words: String| format!("<text x=\"{:.1}\" y=\"{:.1}\">{words}</text>\n", at[0], at[1]);
    let right = MARGIN + PLOT[0];
    format!(
        "<svg viewBox=\"0 -12 {:.0} {:.0}\" width=\"{:.0}\" font-size=\"11\">\n\
         <rect x=\"{MARGIN}\" y=\"0\" width=\"{:.0}\" height=\"{:.0}\" fill=\"none\" stroke=\"#888\"/>\n\
         <line x1=\"{MARGIN}\" x2=\"{right:.0}\" y1=\"{mill:.1}\" y2=\"{mill:.1}\" stroke=\"#b03a2e\" stroke-dasharray=\"4\"/>\n\
         <polyline fill=\"none\" stroke=\"#1f5fa8\" points=\"{}\"/>\n{}{}{}{}</svg>\n",
        right + MARGIN,
        PLOT[1] + 32.0,
        right + MARGIN,
        PLOT[0],
        PLOT[1],
        line.join(" "),
        text([0.0, 8.0], format!("{most_mm:.0} mm")),
        text([right - 90.0, mill - 4.0], format!("mill {:.2} mm", figures.diameter_mm)),
        text([MARGIN, PLOT[1] + 14.0], format!("z {:.1} mm", first[0])),
        text([right - 50.0, PLOT[1] + 14.0], format!("z {:.1} mm", last[0])),
    )
}

/// SVG map of the allowance beyond the part's own on both blades: planes from left to right, heights from the hub
/// upwards.
pub fn left_over(rows: &[LeftOverRow]) -> String {
    let all = rows.iter().flat_map(|row| row.sides_mm.iter().flatten().flatten());
    let most_mm = all.copied().fold(0.0, f64::max);
    let mut text = format!(
        "<p>Beyond the allowance, in the planes of the plan: white 0, dark {most_mm:.2} mm. Planes from left to right, heights from the \
         tips of the plunges upwards; a cell's number is its tooltip. Between the planes stand cusps, no higher than the allowed ones.</p>\n"
    );
    for (side, name) in ["left", "right"].iter().enumerate() {
        let size = [CELL[0] * rows.len() as f64, CELL[1] * HEIGHTS as f64];
        let _ = writeln!(
            text,
            "<p>{} blade</p>\n<svg viewBox=\"0 0 {:.0} {:.0}\" width=\"{:.0}\">",
            escaped(name),
            size[0],
            size[1],
            size[0]
        );
        for (column, row) in rows.iter().enumerate() {
            for (height, left_mm) in row.sides_mm[side].iter().enumerate() {
                let Some(left_mm) = left_mm else { continue };
                let dark = (left_mm / most_mm.max(1e-9)).clamp(0.0, 1.0);
                let [red, other] = [255.0 - 115.0 * dark, 255.0 - 215.0 * dark];
                let _ = writeln!(
                    text,
                    "<rect x=\"{:.0}\" y=\"{:.0}\" width=\"{}\" height=\"{}\" fill=\"rgb({red:.0},{other:.0},{other:.0})\" \
                     stroke=\"#ddd\"><title>{:.2} mm: {left_mm:.3} mm</title></rect>",
                    CELL[0] * column as f64,
                    size[1] - CELL[1] * (height + 1) as f64,
                    CELL[0],
                    CELL[1],
                    row.place_mm,
                );
            }
        }
        text += "</svg>\n";
    }
    text
}
