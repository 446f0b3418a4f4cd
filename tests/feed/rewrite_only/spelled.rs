//! Random arcs in every spelling that a program may have.

use std::f64::consts::{PI, TAU};

use arcfeed_units::LengthUnit;
use fastrand::Rng;

/// Arcs in a program.
const ARCS: usize = 12;
const AXES: [char; 3] = ['X', 'Y', 'Z'];
const OFFSETS: [char; 3] = ['I', 'J', 'K'];

/// A program of arcs.
pub struct Spelled {
    /// Text of the program; lines end with CR LF, the last one with nothing.
    pub text: String,
    /// Unit of the program.
    pub unit: LengthUnit,
    /// Whether none of its arcs is a helix.
    pub flat: bool,
}

/// Notation of numbers and positions.
struct Style {
    unit: LengthUnit,
    has_points: bool,
    absolute: bool,
    at: [i64; 3],
}

impl Style {
    /// Least increments in a millimetre.
    fn per_mm(&self) -> f64 {
        if self.unit == LengthUnit::Mm { 1e3 } else { 1e4 / 25.4 }
    }

    fn number(&self, increments: i64) -> String {
        if !self.has_points {
            return increments.to_string();
        }
        let decimals = if self.unit == LengthUnit::Mm { 3 } else { 4 };
        let scale = 10_i64.pow(decimals);
        let width = decimals as usize;
        let fraction = format!("{:0width$}", increments.abs() % scale);
        let sign = if increments < 0 { "-" } else { "" };
        format!("{sign}{}.{}", increments.abs() / scale, fraction.trim_end_matches('0'))
    }

    /// Words for a position, those of axes that do not move left out now and then; the machine is there then.
    fn move_to(&mut self, to: [i64; 3], rng: &mut Rng) -> String {
        let mut words = String::new();
        for axis in 0..3 {
            let stays = to[axis] == self.at[axis];
            if !stays || (self.absolute && rng.u8(0..4) == 0) {
                let value = if self.absolute { to[axis] } else { to[axis] - self.at[axis] };
                words += &format!("{}{}", AXES[axis], self.number(value));
            }
        }
        self.at = to;
        words
    }

    fn feed(&self, rng: &mut Rng) -> String {
        let feed = if self.unit == LengthUnit::Mm { rng.u32(2_000..4_000) } else { rng.u32(80..160) };
        format!("F{feed}{}", if self.has_points { "." } else { "" })
    }
}

/// A program.
pub fn spelled(rng: &mut Rng) -> Spelled {
    let unit = if rng.bool() { LengthUnit::Mm } else { LengthUnit::Inch };
    let mut style = Style { unit, has_points: rng.bool(), absolute: rng.bool(), at: [0; 3] };
    let mut lines = vec!["%".to_owned(), "O1(ARCS, F AND N IN A COMMENT)".to_owned()];
    lines.push(format!(
        "G{}G{}G94",
        if unit == LengthUnit::Mm { 21 } else { 20 },
        if style.absolute { 90 } else { 91 }
    ));
    let flat = rng.bool();
    for index in 0..ARCS {
        let far = 60.0 * style.per_mm();
        let start = [0; 3].map(|_: i64| ((rng.f64() - 0.5) * far) as i64);
        lines.push(format!("G0{}", style.move_to(start, rng)));
        let words = arc(&mut style, flat, rng);
        let feed = if index == 0 || rng.bool() { style.feed(rng) } else { String::new() };
        let number = if rng.bool() { format!("N{}", 10 * (index + 1)) } else { String::new() };
        let delete = if rng.u8(0..6) == 0 { "/" } else { "" };
        let comment = if rng.u8(0..4) == 0 { " (F1. N2 X3.)" } else { "" };
        lines.push(format!("{delete}{number}{words}{feed}{comment}"));
    }
    lines.push("M30".into());
    lines.push("%".into());
    Spelled { text: lines.join("\r\n"), unit, flat }
}

/// The words of an arc from where the machine is.
fn arc(style: &mut Style, flat: bool, rng: &mut Rng) -> String {
    let plane = rng.usize(0..3);
    let (first, second, normal) = [(0, 1, 2), (2, 0, 1), (1, 2, 0)][plane];
    let ccw = rng.bool();
    let radius = (5.0 + 100.0 * rng.f64() * rng.f64()) * style.per_mm();
    let sweep = 0.2 + 5.8 * rng.f64();
    let by_radius = rng.u8(0..3) == 0;
    let full = !by_radius && rng.u8(0..6) == 0;
    let angle = TAU * rng.f64();
    let from = [radius * libm::cos(angle), radius * libm::sin(angle)].map(|value| libm::round(value) as i64);
    // The centre is what the program says: start and end lie on circles about it within the rounding.
    let radius = libm::hypot(from[0] as f64, from[1] as f64);
    let turned = libm::atan2(from[1] as f64, from[0] as f64) + if ccw { sweep } else { -sweep };
    let to = [radius * libm::cos(turned), radius * libm::sin(turned)].map(|value| libm::round(value) as i64);
    let mut end = style.at;
    if !full {
        end[first] += to[0] - from[0];
        end[second] += to[1] - from[1];
    }
    if !flat && rng.bool() {
        end[normal] += rng.i64(-20_000..20_000) * style.per_mm() as i64 / 1_000;
    }
    let center = if by_radius {
        let radius = libm::round(radius) as i64;
        format!("R{}", style.number(if sweep > PI { -radius } else { radius }))
    } else {
        format!("{}{}{}{}", OFFSETS[first], style.number(-from[0]), OFFSETS[second], style.number(-from[1]))
    };
    format!("G{}G{}{}{center}", 17 + plane, if ccw { 3 } else { 2 }, style.move_to(end, rng))
}
