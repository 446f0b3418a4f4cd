//! Path of the tool seen from above, as an inline SVG: the chip thickness of each block, and the blocks with vibration.

use std::fmt::Write;

use super::escaped;

const WIDTH: f64 = 700.0;
/// Margin around the path.
const MARGIN: f64 = 20.0;
/// Points nearer than this to the one before are left out, pixels.
const NEAR: f64 = 0.5;

/// Colours for chip thickness over target: none, on target, twice the target or more.
const CHIPS: [[f64; 3]; 3] = [[60.0, 110.0, 200.0], [60.0, 160.0, 90.0], [190.0, 20.0, 30.0]];

/// Kinds of vibration, and their colours beside the path.
const VERDICTS: [(&str, &str); 3] = [("uneven", "#f0d060"), ("period-doubling", "#f0a040"), ("chatter", "#f06060")];

/// Plot of a tool path, coloured by a value for each block; all lengths in one unit.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadPlot {
    /// Blocks in order.
    pub blocks: Vec<PlotBlock>,
    /// Name of the value, which is shown over its target.
    pub quantity: &'static str,
    /// Whether blocks were judged for vibration.
    pub has_vibration: bool,
}

/// Block of the plotted path.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotBlock {
    /// N of the block, or its number.
    pub name: String,
    /// Kind of vibration, as in [`crate::report::loads::UnstableFigures`]; `None` if the block is steady or was not
    /// judged.
    pub verdict: Option<&'static str>,
    /// Largest chip thickness divided by the target; `None` without chips.
    pub chip_ratio: Option<f64>,
    /// Lines of the path, each a series of points X, Y.
    pub lines: Vec<Vec<[f64; 2]>>,
}

impl LoadPlot {
    /// The plot as SVG; empty without a path.
    pub fn svg(&self) -> String {
        let points = || self.blocks.iter().flat_map(|block| &block.lines).flatten();
        let ends = |axis: usize| {
            points().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at[axis]), high.max(at[axis])])
        };
        let [x, y] = [ends(0), ends(1)];
        let size = (x[1] - x[0]).max(y[1] - y[0]);
        if !(size > 0.0 && size.is_finite()) {
            return String::new();
        }
        let scale = (WIDTH - 2.0 * MARGIN) / size;
        let height = (y[1] - y[0]) * scale + 2.0 * MARGIN;
        let place = |at: &[f64; 2]| [MARGIN + (at[0] - x[0]) * scale, MARGIN + (y[1] - at[1]) * scale];
        let mut svg =
            format!("<svg viewBox=\"0 0 {WIDTH} {:.1}\" xmlns=\"http://www.w3.org/2000/svg\">\n", height + 75.0);
        let mut blocks: Vec<&PlotBlock> = self.blocks.iter().collect();
        // The worst block is drawn on top.
        blocks.sort_by(|a, b| a.chip_ratio.unwrap_or(0.0).total_cmp(&b.chip_ratio.unwrap_or(0.0)));
        for (verdict, color) in VERDICTS {
            for block in blocks.iter().filter(|block| block.verdict == Some(verdict)) {
                block.draw(&mut svg, &place, (color, 9.0), self.quantity);
            }
        }
        blocks.iter().for_each(|block| block.draw(&mut svg, &place, (&block.color(), 2.0), self.quantity));
        legend(&mut svg, height, self.has_vibration);
        svg + "</svg>\n"
    }
}

impl PlotBlock {
    fn draw(
        &self,
        svg: &mut String,
        place: &dyn Fn(&[f64; 2]) -> [f64; 2],
        (color, width): (&str, f64),
        quantity: &str,
    ) {
        let mut path = String::new();
        for line in &self.lines {
            let mut pen: Option<[f64; 2]> = None;
            for (index, point) in line.iter().enumerate() {
                let [x, y] = place(point);
                let is_near = pen.is_some_and(|[from_x, from_y]| libm::hypot(x - from_x, y - from_y) < NEAR);
                if is_near && index + 1 < line.len() {
                    continue;
                }
                let _ = write!(path, "{}{x:.1} {y:.1}", if pen.is_none() { 'M' } else { 'L' });
                pen = Some([x, y]);
            }
        }
        let chip = self.chip_ratio.map_or("no value".into(), |ratio| format!("{quantity} {ratio:.2} of the target"));
        let verdict = self.verdict.map_or(String::new(), |verdict| format!(", {verdict}"));
        let _ = writeln!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-linecap=\"round\" \
             stroke-linejoin=\"round\"><title>{}: {chip}{verdict}</title></path>",
            escaped(&self.name)
        );
    }

    fn color(&self) -> String {
        self.chip_ratio.map_or("#bbb".into(), |ratio| chips(ratio / 2.0))
    }
}

/// Colour at a fraction of the scale.
fn chips(part: f64) -> String {
    let place = part.clamp(0.0, 1.0) * (CHIPS.len() - 1) as f64;
    let index = (place as usize).min(CHIPS.len() - 2);
    let within = place - index as f64;
    let [r, g, b] = [0, 1, 2].map(|c: usize| CHIPS[index][c] + (CHIPS[index + 1][c] - CHIPS[index][c]) * within);
    format!("rgb({r:.0},{g:.0},{b:.0})")
}

fn legend(svg: &mut String, top: f64, has_vibration: bool) {
    let _ = write!(svg, "<linearGradient id=\"chips\">");
    for part in [0.0, 0.5, 1.0] {
        let _ = write!(svg, "<stop offset=\"{part}\" stop-color=\"{}\"/>", chips(part));
    }
    let _ = writeln!(
        svg,
        "</linearGradient>\n<rect x=\"{MARGIN}\" y=\"{:.1}\" width=\"240\" height=\"14\" fill=\"url(#chips)\"/>",
        top + 20.0
    );
    let label =
        if has_vibration { "2: thickest chip over wanted" } else { "2: measured over target; grey: not measured" };
    for (at, label) in [(0.0, "0"), (120.0, "1"), (240.0, label)] {
        let _ = writeln!(svg, "<text x=\"{:.1}\" y=\"{:.1}\">{label}</text>", MARGIN + at, top + 50.0);
    }
    for (index, (verdict, color)) in VERDICTS.iter().enumerate().filter(|_| has_vibration) {
        let x = 330.0 + 125.0 * index as f64;
        let _ = writeln!(
            svg,
            "<path d=\"M{x} {0:.1}h24\" stroke=\"{color}\" stroke-width=\"9\"/>\n<text x=\"{1}\" y=\"{2:.1}\">{verdict}</text>",
            top + 27.0,
            x + 30.0,
            top + 31.0
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_is_drawn_last_and_what_is_not_steady_has_a_border() {
        let block = |name: &str, verdict, chip_ratio| PlotBlock {
            name: name.into(),
            verdict,
            chip_ratio: Some(chip_ratio),
            lines: vec![vec![[0.0, 0.0], [0.001, 0.0], [10.0, 0.0]]],
        };
        let svg = LoadPlot {
            blocks: vec![block("N1", Some("chatter"), 2.0), block("N2", None, 1.0)],
            quantity: "chip load",
            has_vibration: true,
        }
        .svg();
        let places = ["<title>N1", "<title>N2", "rgb(190,20,30)\" stroke-width"].map(|part| svg.rfind(part));
        assert!(places[0] > places[1] && places[2] > places[1], "{svg}");
        assert_eq!(svg.matches("stroke=\"#f06060\"").count(), 2);
        assert!(svg.contains("d=\"M20.0 20.0L680.0 20.0\""), "{svg}");
    }

    #[test]
    fn without_a_way_there_is_nothing() {
        assert_eq!(LoadPlot { blocks: Vec::new(), quantity: "", has_vibration: false }.svg(), "");
    }
}
