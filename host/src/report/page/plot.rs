//! Step functions, of time or another quantity, as an inline SVG: lanes one above the other, with one axis below.

use std::fmt::Write;

use super::escaped;

const WIDTH: f64 = 900.0;
const LANE_HEIGHT: f64 = 150.0;
/// Margins of the lanes: left, right, and above each.
const MARGINS: [f64; 3] = [70.0, 15.0, 30.0];

/// Lane of the diagram: one quantity over the quantity of the common axis.
#[derive(Clone, Debug)]
pub struct Lane {
    /// Title of the lane, with the unit.
    pub title: String,
    /// Curves of the lane.
    pub series: Vec<Series>,
    /// Value that is marked by a line, such as a target; `None` without one.
    pub mark: Option<f64>,
    /// Between the steps the quantity is unknown; otherwise it is zero there.
    pub has_gaps: bool,
}

/// Curve of a diagram.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name of the run.
    pub name: &'static str,
    /// Colour in CSS syntax.
    pub color: &'static str,
    /// Steps: from, to in the unit of the axis, and the value between.
    pub steps: Vec<([f64; 2], f64)>,
}

/// The lanes as SVG, over an axis from 0 in this unit.
pub fn svg(lanes: &[Lane], unit: &str) -> String {
    let steps = || lanes.iter().flat_map(|lane| &lane.series).flat_map(|series| &series.steps);
    let until = steps().map(|([_, to], _)| *to).fold(1e-3, f64::max);
    let [left, right, above] = MARGINS;
    let height = lanes.len() as f64 * (LANE_HEIGHT + above) + 35.0;
    let x = |at: f64| left + at / until * (WIDTH - left - right);
    let mut svg = format!("<svg viewBox=\"0 0 {WIDTH} {height}\" xmlns=\"http://www.w3.org/2000/svg\">\n");
    for (index, lane) in lanes.iter().enumerate() {
        let top = above + index as f64 * (LANE_HEIGHT + above);
        draw(&mut svg, lane, top, &x);
    }
    let bottom = height - 35.0;
    for tick in ticks(until) {
        text(&mut svg, [x(tick), bottom + 16.0], "middle", &format!("{tick}"));
    }
    text(&mut svg, [x(until), bottom + 32.0], "end", unit);
    svg + "</svg>\n"
}

fn draw(svg: &mut String, lane: &Lane, top: f64, x: &dyn Fn(f64) -> f64) {
    let values = lane.series.iter().flat_map(|series| &series.steps).map(|(_, value)| *value);
    let most = values.chain(lane.mark).fold(1e-9, f64::max);
    let y = |value: f64| top + LANE_HEIGHT * (1.0 - value / most);
    let [left, right, _] = MARGINS;
    text(svg, [left, top - 8.0], "start", &lane.title);
    for tick in ticks(most) {
        let at = y(tick);
        let _ = writeln!(svg, "<path d=\"M{left} {at:.1}H{}\" stroke=\"#ddd\"/>", WIDTH - right);
        text(svg, [left - 6.0, at + 4.0], "end", &format!("{tick}"));
    }
    if let Some(mark) = lane.mark {
        let at = y(mark);
        let _ =
            writeln!(svg, "<path d=\"M{left} {at:.1}H{}\" stroke=\"#3a7\" stroke-dasharray=\"6 4\"/>", WIDTH - right);
    }
    for (index, series) in lane.series.iter().enumerate() {
        let _ = writeln!(
            svg,
            "<path d=\"{}\" fill=\"none\" stroke=\"{}\"/>",
            path(&series.steps, x, &y, lane.has_gaps),
            series.color
        );
        let at = WIDTH - right - 90.0 * (lane.series.len() - 1 - index) as f64;
        let (color, name) = (series.color, series.name);
        let _ =
            writeln!(svg, "<text x=\"{at}\" y=\"{}\" text-anchor=\"end\" fill=\"{color}\">{name}</text>", top - 8.0);
    }
}

/// Steps as a path; steps within one pixel's column become the line from their lowest to their highest value.
fn path(steps: &[([f64; 2], f64)], x: &dyn Fn(f64) -> f64, y: &dyn Fn(f64) -> f64, has_gaps: bool) -> String {
    let mut path = String::new();
    let mut pen = [f64::NAN; 2];
    let mut column: Option<(i64, [f64; 2])> = None;
    for ([from, to], value) in steps {
        let [from, to, at] = [x(*from), x(*to), y(*value)].map(|place| (place * 10.0).round() / 10.0);
        let own = from.floor() as i64;
        if to.floor() as i64 == own && pen[0].floor() as i64 == own {
            let (_, [low, high]) = column.filter(|(other, _)| *other == own).unwrap_or((own, [pen[1]; 2]));
            if (low..=high).contains(&at) {
                continue;
            }
            column = Some((own, [low.min(at), high.max(at)]));
        }
        let is_gap = from > pen[0] + 0.1;
        if is_gap && !has_gaps {
            let _ = write!(path, "V{0}H{from}", y(0.0));
        }
        let _ = if pen[0].is_nan() || (is_gap && has_gaps) {
            write!(path, "M{from} {at}H{to}")
        } else {
            write!(path, "V{at}H{to}")
        };
        pen = [to, at];
    }
    path
}

/// Round numbers from zero to `most`, about five of them.
fn ticks(most: f64) -> Vec<f64> {
    let rough = most / 5.0;
    let power = libm::pow(10.0, rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|part| part * power).find(|step| *step >= rough).unwrap_or(rough);
    let digits = (-step.log10().floor()).max(0.0) as i32;
    let scale = libm::pow(10.0, f64::from(digits));
    (0..=(most / step + 1e-9) as u32).map(|tick| (f64::from(tick) * step * scale).round() / scale).collect()
}

fn text(svg: &mut String, [x, y]: [f64; 2], anchor: &str, text: &str) {
    let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>", escaped(text));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_cover_the_range() {
        assert_eq!(ticks(200.0), [0.0, 50.0, 100.0, 150.0, 200.0]);
        assert_eq!(ticks(0.37), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(ticks(57.4), [0.0, 20.0, 40.0]);
    }

    #[test]
    fn svg_curve_breaks_or_drops_at_pauses_and_has_each_column_once() {
        let same = |v: f64| v;
        let steps = [([0.0, 10.0], 5.0), ([20.0, 30.0], 7.0)];
        assert_eq!(path(&steps, &same, &same, false), "M0 5H10V0H20V7H30");
        assert_eq!(path(&steps, &same, &same, true), "M0 5H10M20 7H30");
        let dense: Vec<([f64; 2], f64)> =
            (0..1000).map(|n| ([f64::from(n) * 1e-3, f64::from(n + 1) * 1e-3], f64::from(n % 3))).collect();
        assert!(path(&dense, &same, &same, false).len() < 60, "{}", path(&dense, &same, &same, false));
    }
}
