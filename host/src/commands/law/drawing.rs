//! Drawing of a case of a law as SVG, in a frame that moves with the tool: x along its motion, y towards A. The chip is drawn thicker than
//! it is.

use std::fmt::Write;

use arcfeed_model::cut::ContourSide;

use super::case::{Case, Contour, Evaluated, Rotation};

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 720.0;
/// Margin around the drawing.
const MARGIN: f64 = 40.0;
/// Chip in the drawing, over the radius of the cutting circle.
const CHIP_RATIO: f64 = 0.12;

const PATH: &str = "#999";
const TOOL: &str = "#36c";
const NEXT: &str = "#c63";
const STOCK: &str = "#3a7";

/// Picture in a frame, and its SVG.
struct Picture {
    svg: String,
    scale: f64,
    origin: [f64; 2],
}

/// SVG text of the drawing.
pub fn svg(case: &Case, evaluated: &Evaluated) -> String {
    match case {
        Case::Circumference(rotation) => of_rotation(rotation, evaluated),
        Case::Contour(contour) => of_contour(contour),
    }
}

fn of_rotation(case: &Rotation, evaluated: &Evaluated) -> String {
    let Rotation { rho_mm: rho, radius_mm: r0, edge, feed_per_tooth_mm: a, .. } = *case;
    let ([ux, uy], k) = (evaluated.contact, f64::from(edge.advance()));
    let mut picture = Picture::around([0.0, 0.0], r0, [0.0, rho]);
    let (o, center) = ([0.0, 0.0], [0.0, rho]);
    // The centre goes further in the drawing, by as much as the chip is thicker.
    let enlarged = (CHIP_RATIO * r0 / a).max(1.0);
    let turn = (evaluated.path_mm / rho * enlarged).min(1.0);
    let next = [rho * libm::sin(turn), rho * (1.0 - libm::cos(turn))];
    let (b, c) = ([r0 * ux, r0 * uy], [(r0 + k * a * enlarged) * ux, (r0 + k * a * enlarged) * uy]);
    picture.circle(center, rho, PATH, "6 4");
    picture.circle(o, r0, TOOL, "");
    picture.circle(next, r0, NEXT, "4 3");
    // The stock line passes through B; from an angle alone its direction is unknown.
    if let super::case::Contact::Line { normal_deg, position: [px, py], is_clockwise, .. } = case.contact {
        let (ny, nx) = libm::sincos(normal_deg.to_radians());
        let turn = if is_clockwise { -1.0 } else { 1.0 };
        let [along, towards] = [turn * (ny * px - nx * py), -(nx * px + ny * py)];
        let end = |sign: f64| [b[0] - sign * towards * 2.0 * r0, b[1] + sign * along * 2.0 * r0];
        picture.line(end(1.0), end(-1.0), STOCK);
    }
    picture.line(o, center, PATH);
    picture.line(o, c, TOOL);
    for (point, name) in [(o, "O"), (center, "A"), (b, "B"), (c, "C"), (next, "O'")] {
        picture.point(point, name);
    }
    picture.caption(&[
        ("centre's path, rho", PATH),
        ("cutting circle, r0", TOOL),
        ("one tooth later", NEXT),
        ("stock line", STOCK),
    ]);
    picture.note(&format!("chip and step drawn {enlarged:.0} times as large"));
    picture.svg + "</svg>\n"
}

fn of_contour(case: &Contour) -> String {
    let Contour { rho_mm: q, radius_mm: r, side, .. } = *case;
    let contour = if side == ContourSide::Outside { q - r } else { q + r };
    let mut picture = Picture::around([0.0, 0.0], q.max(contour), [0.0, q]);
    let (center, o) = ([0.0, 0.0], [0.0, q]);
    picture.circle(center, q, PATH, "6 4");
    picture.circle(center, contour, STOCK, "");
    picture.circle(o, r, TOOL, "");
    picture.line(center, [0.0, contour], PATH);
    for (point, name) in [(center, "A"), (o, "O"), ([0.0, contour], "B")] {
        picture.point(point, name);
    }
    picture.caption(&[("centre's path, q", PATH), ("contour, Rc", STOCK), ("tool, r", TOOL)]);
    picture.svg + "</svg>\n"
}

impl Picture {
    /// Picture of a circle and a point.
    fn around([x, y]: [f64; 2], radius: f64, [px, py]: [f64; 2]) -> Self {
        let reach = radius * (1.0 + CHIP_RATIO);
        let [low, high] = [[(x - reach).min(px), (y - reach).min(py)], [(x + reach).max(px), (y + reach).max(py)]];
        let scale = (WIDTH.min(HEIGHT) - 2.0 * MARGIN) / (high[0] - low[0]).max(high[1] - low[1]);
        let origin = [MARGIN - low[0] * scale, MARGIN + high[1] * scale];
        let svg = format!(
            "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\" font-size=\"13\">\n"
        );
        Picture { svg, scale, origin }
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.origin[0] + x * self.scale, self.origin[1] - y * self.scale]
    }

    fn circle(&mut self, center: [f64; 2], radius: f64, color: &str, dashes: &str) {
        let [x, y] = self.place(center);
        let r = radius * self.scale;
        let _ = writeln!(
            self.svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r:.1}\" fill=\"none\" stroke=\"{color}\" stroke-dasharray=\"{dashes}\"/>"
        );
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], color: &str) {
        let ([x, y], [to_x, to_y]) = (self.place(from), self.place(to));
        let _ = writeln!(self.svg, "<path d=\"M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}\" stroke=\"{color}\"/>");
    }

    fn point(&mut self, at: [f64; 2], name: &str) {
        let [x, y] = self.place(at);
        let _ = writeln!(
            self.svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/><text x=\"{:.1}\" y=\"{:.1}\">{name}</text>",
            x + 6.0,
            y - 6.0
        );
    }

    fn caption(&mut self, entries: &[(&str, &str)]) {
        for (index, (text, color)) in entries.iter().enumerate() {
            let x = MARGIN + 165.0 * index as f64;
            let _ = writeln!(self.svg, "<text x=\"{x}\" y=\"18\" fill=\"{color}\">{text}</text>");
        }
    }

    fn note(&mut self, text: &str) {
        let _ = writeln!(self.svg, "<text x=\"{MARGIN}\" y=\"{:.1}\">{text}</text>", HEIGHT - 12.0);
    }
}
