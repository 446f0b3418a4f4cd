//! Map of heights, or of deviations, seen from above, as an inline SVG around one picture.

use std::fmt::Write;

use super::png::data_uri;
use crate::report::material::short;

/// Most pixels along an edge of the picture; more cells share pixels.
const PIXELS_MAX: usize = 512;

/// Number of colours of the scale.
const SHADES: usize = 254;

/// Colour index of cells without material.
const NOTHING: u8 = SHADES as u8;

const WIDTH: f64 = 700.0;

/// Deviations below this are written with two more digits.
const SMALL: f64 = 0.01;

/// Colours from low (dark) to high (light).
const HEIGHTS: [[f64; 3]; 4] = [[40.0, 20.0, 90.0], [30.0, 110.0, 140.0], [90.0, 190.0, 100.0], [250.0, 230.0, 60.0]];

/// Colours from too little over none to too much.
const DEVIATIONS: [[f64; 3]; 5] =
    [[10.0, 40.0, 130.0], [110.0, 160.0, 220.0], [245.0, 245.0, 245.0], [235.0, 140.0, 100.0], [140.0, 10.0, 30.0]];

/// Map of values over a surface as a picture; lengths in one unit.
#[derive(Clone, Debug)]
pub struct Map {
    /// Number of cells along X.
    pub columns: usize,
    /// Values row by row from the lowest Y.
    pub values: Vec<Option<f64>>,
    /// X and Y of the lowest corner.
    pub lowest: [f64; 2],
    /// Length of a cell's edge.
    pub step: f64,
    /// Unit of all lengths.
    pub unit: &'static str,
    /// Largest deviation and its place, in a map of deviations.
    pub largest: Option<(f64, [f64; 2])>,
}

impl Map {
    /// The map as SVG.
    pub fn svg(&self) -> String {
        let rows = self.values.len() / self.columns.max(1);
        let size = [self.columns as f64 * self.step, rows as f64 * self.step];
        let height = WIDTH * size[1] / size[0];
        let [low, high] = self.range();
        let shared = self.columns.max(rows).div_ceil(PIXELS_MAX);
        let (width, pixels) = self.pixels(shared, [low, high]);
        let mut palette: Vec<[u8; 3]> = (0..SHADES).map(|n| self.color(n as f64 / (SHADES - 1) as f64)).collect();
        palette.push([255; 3]);
        let picture = data_uri(width, &palette, NOTHING, &pixels);
        let whole = height + 75.0;
        let mut svg = format!("<svg viewBox=\"0 0 {WIDTH} {whole:.1}\" xmlns=\"http://www.w3.org/2000/svg\">\n");
        let _ = writeln!(
            svg,
            "<image href=\"{picture}\" width=\"{WIDTH}\" height=\"{height:.1}\" preserveAspectRatio=\"none\" \
             style=\"image-rendering:pixelated\"/>\n<rect width=\"{WIDTH}\" height=\"{height:.1}\" fill=\"none\" stroke=\"#888\"/>"
        );
        if let Some((value, at)) = self.largest {
            let [x, y] =
                [(at[0] - self.lowest[0]) / size[0] * WIDTH, (1.0 - (at[1] - self.lowest[1]) / size[1]) * height];
            let digits = if value.abs() < SMALL { 6 } else { 4 };
            let (anchor, dx) = if x > WIDTH / 2.0 { ("end", -12.0) } else { ("start", 12.0) };
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"8\" fill=\"none\" stroke=\"#000\" stroke-width=\"2\"/>\n\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">largest: {value:+.digits$} {}</text>",
                x + dx,
                // `clamp` would panic here: a long, narrow map is lower than a line of text.
                (y + 4.0).max(12.0).min(height - 4.0),
                self.unit
            );
        }
        self.legend(&mut svg, height, [low, high]);
        svg + "</svg>\n"
    }

    /// Draws the corners of the picture, and the scale.
    fn legend(&self, svg: &mut String, top: f64, [low, high]: [f64; 2]) {
        let end = |axis: usize, cells: usize| self.lowest[axis] + cells as f64 * self.step;
        let rows = self.values.len() / self.columns.max(1);
        let (x, y) = (end(0, self.columns), end(1, rows));
        let [x0, y0, x1, y1] = [self.lowest[0], self.lowest[1], x, y].map(short);
        let _ = writeln!(svg, "<text x=\"0\" y=\"{:.1}\">X{x0} Y{y0}</text>", top + 16.0);
        let _ =
            writeln!(svg, "<text x=\"{WIDTH}\" y=\"{:.1}\" text-anchor=\"end\">X{x1}; top: Y{y1}</text>", top + 16.0);
        let id = if self.largest.is_some() { "deviations" } else { "heights" };
        let _ = write!(svg, "<linearGradient id=\"{id}\">");
        for part in 0..=8 {
            let [r, g, b] = self.color(f64::from(part) / 8.0);
            let _ = write!(svg, "<stop offset=\"{}\" stop-color=\"rgb({r},{g},{b})\"/>", f64::from(part) / 8.0);
        }
        let _ = writeln!(svg, "</linearGradient>");
        let _ =
            writeln!(svg, "<rect x=\"150\" y=\"{:.1}\" width=\"400\" height=\"14\" fill=\"url(#{id})\"/>", top + 30.0);
        for (at, value) in [(150.0, low), (350.0, (low + high) / 2.0), (550.0, high)] {
            let label = format!("{} {}", short(value), self.unit);
            let _ = writeln!(svg, "<text x=\"{at}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>", top + 60.0);
        }
    }

    /// Ends of the scale; those of deviations are symmetrical.
    fn range(&self) -> [f64; 2] {
        let known = || self.values.iter().flatten().copied();
        let [low, high] = [known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max)];
        match self.largest {
            Some((value, _)) => [-value.abs(), value.abs()],
            None if low <= high => [low, high],
            None => [0.0, 0.0],
        }
    }

    /// Indices of colours from the top row down; a pixel shows the largest of its cells.
    fn pixels(&self, shared: usize, [low, high]: [f64; 2]) -> (usize, Vec<u8>) {
        let width = self.columns.div_ceil(shared);
        let rows: Vec<&[Option<f64>]> = self.values.chunks(self.columns.max(1)).collect();
        let size = |value: &f64| if self.largest.is_some() { value.abs() } else { *value };
        let mut pixels = Vec::new();
        for rows in rows.chunks(shared).rev() {
            for column in 0..width {
                let cells = rows.iter().flat_map(|row| row.iter().skip(column * shared).take(shared)).flatten();
                let shown = cells.max_by(|a, b| size(a).total_cmp(&size(b)));
                let part = |value: &f64| if high > low { (value - low) / (high - low) } else { 0.5 };
                pixels.push(shown.map_or(NOTHING, |value| (part(value) * (SHADES - 1) as f64).round() as u8));
            }
        }
        (width, pixels)
    }

    fn color(&self, part: f64) -> [u8; 3] {
        let stops: &[[f64; 3]] = if self.largest.is_some() { &DEVIATIONS } else { &HEIGHTS };
        let place = part.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let index = (place as usize).min(stops.len() - 2);
        let within = place - index as f64;
        std::array::from_fn(|c| (stops[index][c] + (stops[index + 1][c] - stops[index][c]) * within).round() as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(columns: usize, values: Vec<Option<f64>>, largest: Option<(f64, [f64; 2])>) -> Map {
        Map { columns, values, lowest: [0.0; 2], step: 1.0, unit: "mm", largest }
    }

    #[test]
    fn the_top_row_comes_first_and_what_is_not_there_is_transparent() {
        let heights = map(2, vec![Some(0.0), Some(1.0), None, Some(0.5)], None);
        assert_eq!(heights.pixels(1, heights.range()), (2, vec![254, 127, 0, 253]));
    }

    #[test]
    fn cells_that_share_a_pixel_show_the_worst() {
        let off = map(4, vec![Some(0.1), Some(-0.3), Some(0.2), None], Some((-0.3, [1.5, 0.5])));
        assert_eq!(off.range(), [-0.3, 0.3]);
        assert_eq!(off.pixels(2, off.range()), (2, vec![0, 211]));
    }

    #[test]
    fn no_deviation_is_neutral_and_the_largest_is_marked() {
        let off = map(1, vec![Some(0.0)], Some((0.0, [0.5, 0.5])));
        assert_eq!(off.color(0.5), [245, 245, 245]);
        assert!(off.svg().contains("<circle cx=\"350.0\" cy=\"350.0\""), "{}", off.svg());
    }

    #[test]
    fn a_map_lower_than_a_line_of_text_is_drawn() {
        let off = map(100, vec![Some(0.1); 100], Some((0.1, [50.0, 0.5])));
        assert!(off.svg().contains("largest: +0.1000 mm"), "{}", off.svg());
    }
}
