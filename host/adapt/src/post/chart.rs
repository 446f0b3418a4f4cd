//! Chart of the tool axes of a path on a plane of directions, with lines of equal position of the first rotary axis (Tournier 2006, figure
//! 11).
//!
//! For an A/C table the plane is that of (i, j). Lines of equal C are rays from the pole: where a path crosses many of them at once, C turns fast.

use std::fmt::Write;

use arcfeed_kinematics::inverse::Angles;
use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::vector::{Vector, cross, dot, scaled, sum, unit};

/// Size of the chart, height with its legend, and margin.
const SIZE: f64 = 480.0;
const HEIGHT: f64 = 512.0;
const MARGIN: f64 = 36.0;
/// Rays of equal positions.
const RAYS: u32 = 24;
/// Least half width of the chart, sine of the angle from the pole.
const HALF_MIN: f64 = 0.01;

/// Chart as SVG: the directions of the tool with the positions of the first rotary axis, and the tool axes `axes` of a path on them.
pub fn chart(machine: &Machine, axes: &[Vector]) -> String {
    let first = machine.rotary()[0].direction;
    let (right, up) = across(first);
    let place = |axis: &Vector| [dot(*axis, right), dot(*axis, up)];
    let reach = axes.iter().flat_map(place).map(f64::abs).fold(HALF_MIN, f64::max) * 1.1;
    let scale = (SIZE / 2.0 - MARGIN) / reach;
    let (x, y) = (|right: f64| SIZE / 2.0 + right * scale, |up: f64| SIZE / 2.0 - up * scale);
    let letter = machine.rotary()[0].letter;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {SIZE} {HEIGHT}\" role=\"img\" font-family=\"sans-serif\" font-size=\"10\">\n\
         <title>{letter} over the directions of the tool axis</title>\n<rect width=\"{SIZE}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\n"
    );
    for ray in 0..RAYS {
        let (sin, cos) = libm::sincos(core::f64::consts::TAU * f64::from(ray) / f64::from(RAYS));
        let [end_x, end_y] = [x(reach * cos), y(reach * sin)];
        let (middle, color) = (SIZE / 2.0, "#9bb7d9");
        let _infallible = writeln!(
            svg,
            "<line x1=\"{middle}\" y1=\"{middle}\" x2=\"{end_x:.1}\" y2=\"{end_y:.1}\" stroke=\"{color}\"/>"
        );
        let beside = sum(sum(scaled(right, cos), scaled(up, sin)), scaled(first, 20.0));
        if let Some(position_deg) = position_deg(machine, beside) {
            let [at_x, at_y] = [x(1.08 * reach * cos), y(1.08 * reach * sin)];
            let _infallible = writeln!(
                svg,
                "<text x=\"{at_x:.1}\" y=\"{at_y:.1}\" text-anchor=\"middle\" dominant-baseline=\"middle\" fill=\"#345\">{:.0}</text>",
                // Without the sign of a zero.
                libm::round(position_deg) + 0.0
            );
        }
    }
    let points: Vec<String> =
        axes.iter().map(place).map(|[right, up]| format!("{:.2},{:.2}", x(right), y(up))).collect();
    let _infallible = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#b03030\" stroke-width=\"1.5\"/>",
        points.join(" ")
    );
    for point in points.iter().take(1) {
        if let Some((at_x, at_y)) = point.split_once(',') {
            let _infallible = writeln!(svg, "<circle cx=\"{at_x}\" cy=\"{at_y}\" r=\"4\" fill=\"#b03030\"/>");
        }
    }
    let second_letter = machine.rotary()[1].letter;
    let lines = [
        format!("blue: lines of equal {letter}, degrees, on the branch with the greater {second_letter}"),
        format!("red: tool axes, from the dot; half width {reach:.3}"),
    ];
    for (line, at_y) in lines.iter().zip([SIZE + 12.0, SIZE + 26.0]) {
        let _infallible = writeln!(svg, "<text x=\"8\" y=\"{at_y:.0}\">{line}</text>");
    }
    svg + "</svg>"
}

/// Two directions across an axis: of Z those of X and Y.
fn across(first: Vector) -> (Vector, Vector) {
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let near = if dot(first, x).abs() < 0.9 { x } else { y };
    let right = unit(sum(near, scaled(first, -dot(near, first)))).unwrap_or(z);
    // Seen from the positive end of Z, whichever way the axis counts.
    let up = cross(first, right);
    (right, if dot(up, y) < 0.0 { scaled(up, -1.0) } else { up })
}

/// Position of the first axis for a direction, on the branch with the greater position of the second.
fn position_deg(machine: &Machine, direction: Vector) -> Option<f64> {
    match machine.angles(unit(direction)?) {
        Angles::Two([one, other]) => Some(if one[1] > other[1] { one[0] } else { other[0] }),
        Angles::One(only) => Some(only[0]),
        _ => None,
    }
}
