//! Remaining material on a surface, as a grid of colours.

use std::fmt::Write;

use arcfeed_units::LengthUnit;

use super::{LeftMap, Lengths};
use crate::report::page::escaped;
use crate::report::page::png::data_uri;

/// Number of shades from nothing to most.
const SHADES: usize = 252;
/// Colour index behind the shades: too much was removed.
const OVERCUT: u8 = SHADES as u8;
/// Last colour index: unknown.
const UNKNOWN: u8 = OVERCUT + 1;

const SCALE: [[f64; 3]; 3] = [[245.0, 245.0, 235.0], [90.0, 170.0, 160.0], [20.0, 40.0, 110.0]];
const RED: [u8; 3] = [200, 20, 20];

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 240.0;

/// Map of remaining material as SVG, with its colour scale; `index` is the number of the map on the page.
pub fn svg(map: &LeftMap, index: usize, unit: LengthUnit) -> String {
    let lengths = Lengths(unit);
    let known = || map.values_mm.iter().flatten().copied();
    let most_mm = known().fold(0.0, f64::max);
    let least_mm = known().fold(f64::INFINITY, f64::min);
    let mut palette: Vec<[u8; 3]> = (0..SHADES).map(|shade| color(shade as f64 / (SHADES - 1) as f64)).collect();
    palette.extend([RED, [255; 3]]);
    let picture = data_uri(map.columns, &palette, UNKNOWN, &pixels(map, most_mm));
    let [left, right, below, above] = map.sides.each_ref().map(|side| escaped(side));
    let mut text = format!(
        "<h3>{}</h3>\n<svg viewBox=\"0 0 700 340\" xmlns=\"http://www.w3.org/2000/svg\">\n\
         <text x=\"350\" y=\"14\" text-anchor=\"middle\">{above}</text>\n\
         <image href=\"{picture}\" x=\"30\" y=\"20\" width=\"{WIDTH}\" height=\"{HEIGHT}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:pixelated\"/>\n\
         <rect x=\"30\" y=\"20\" width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"none\" stroke=\"#888\"/>\n",
        escaped(&map.surface)
    );
    let _ = writeln!(text, "<text x=\"30\" y=\"276\">{left}</text>");
    let _ = writeln!(text, "<text x=\"350\" y=\"276\" text-anchor=\"middle\">{below}</text>");
    let _ = writeln!(text, "<text x=\"670\" y=\"276\" text-anchor=\"end\">{right}</text>");
    let _ = write!(text, "<linearGradient id=\"left{index}\">");
    for (stop, [r, g, b]) in SCALE.iter().enumerate() {
        let _ = write!(text, "<stop offset=\"{}\" stop-color=\"rgb({r},{g},{b})\"/>", stop as f64 / 2.0);
    }
    let _ = writeln!(text, "</linearGradient>");
    let _ = writeln!(
        text,
        "<rect x=\"150\" y=\"290\" width=\"400\" height=\"14\" fill=\"url(#left{index})\" stroke=\"#888\"/>"
    );
    let _ = writeln!(text, "<text x=\"150\" y=\"322\" text-anchor=\"middle\">0</text>");
    let most = format!("{} {}", lengths.of(most_mm), lengths.label());
    let _ = writeln!(text, "<text x=\"550\" y=\"322\" text-anchor=\"middle\">{most}</text>\n</svg>");
    let cells = map.values_mm.len();
    let missing = cells - known().count();
    let least = if least_mm.is_finite() { lengths.of(least_mm) } else { "nothing known".into() };
    let _ = writeln!(text, "<p>Least {least}, most {most} above the allowance; red where less than nothing is left.");
    if missing > 0 {
        let _ = writeln!(text, "The tool was never near {missing} of {cells} places: blank.");
    }
    text + "</p>\n"
}

/// Indices of colours from the top row down.
fn pixels(map: &LeftMap, most_mm: f64) -> Vec<u8> {
    let shade = |value_mm: &Option<f64>| match value_mm {
        None => UNKNOWN,
        Some(mm) if *mm < 0.0 => OVERCUT,
        Some(mm) if most_mm > 0.0 => (mm / most_mm * (SHADES - 1) as f64).round() as u8,
        Some(_) => 0,
    };
    map.values_mm.chunks(map.columns.max(1)).rev().flat_map(|row| row.iter().map(shade)).collect()
}

fn color(part: f64) -> [u8; 3] {
    let place = part.clamp(0.0, 1.0) * (SCALE.len() - 1) as f64;
    let index = (place as usize).min(SCALE.len() - 2);
    let within = place - index as f64;
    std::array::from_fn(|c| (SCALE[index][c] + (SCALE[index + 1][c] - SCALE[index][c]) * within).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_row_comes_first_and_too_little_is_red() {
        let sides = ["", "", "", ""].map(String::from);
        let values_mm = vec![Some(0.0), Some(-0.01), Some(2.0), None];
        let map = LeftMap { surface: "hub".into(), sides, columns: 2, values_mm };
        assert_eq!(pixels(&map, 2.0), [251, UNKNOWN, 0, OVERCUT]);
        let text = svg(&map, 0, LengthUnit::Mm);
        assert!(text.contains("Least -0.010, most 2.000 mm") && text.contains("never near 1 of 4"), "{text}");
    }
}
