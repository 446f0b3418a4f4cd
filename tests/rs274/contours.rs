//! Contours for cutter compensation, made with a seeded generator.
//!
//! A contour begins and ends with a line in its own direction, so that every control is beside it from its first move
//! on. Joints are tangent, or have at least ten degrees; coordinates have six decimals.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use fastrand::Rng;

/// Length of the lines before and behind the contour.
const LEAD_MM: f64 = 8.0;

/// One contour as a program: without the tool's call, ended by G40.
#[derive(Clone, Debug)]
pub struct ContourProgram {
    /// Blocks of the program.
    pub text: String,
    /// D and radius of the tool, mm: D2 is 1 mm.
    pub d: u32,
}

/// Writer of moves, in the plane of compensation.
struct Writer {
    text: String,
    at: [f64; 2],
    z: f64,
}

impl ContourProgram {
    /// The contour of a seed; every third one is closed.
    pub fn of_seed(seed: u64) -> Self {
        let mut rng = Rng::with_seed(seed);
        let d = 1 + rng.u32(1..10);
        let side = if rng.bool() { "G41" } else { "G42" };
        let text = if seed.is_multiple_of(3) { closed(&mut rng, side, d) } else { open(&mut rng, side, d) };
        ContourProgram { text, d }
    }

    /// Radius of the tool.
    pub fn radius_mm(&self) -> f64 {
        f64::from(self.d) / 2.0
    }
}

impl Writer {
    fn new([x, y]: [f64; 2], heading: f64, side: &str, d: u32) -> Self {
        let before = along([x, y], heading, -LEAD_MM);
        let mut writer = Writer { text: String::new(), at: [x, y].map(rounded), z: 0.0 };
        let [bx, by] = before.map(rounded);
        writeln!(writer.text, "G40G0X{bx:.6}Y{by:.6}Z0.").expect("a string takes anything");
        let [x, y] = writer.at;
        writeln!(writer.text, "{side}D{d}G1X{x:.6}Y{y:.6}F500.").expect("a string takes anything");
        writer
    }

    fn line(&mut self, to: [f64; 2], rise: f64) {
        self.at = to.map(rounded);
        let [x, y] = self.at;
        let z = self.height(rise);
        writeln!(self.text, "G1X{x:.6}Y{y:.6}{z}").expect("a string takes anything");
    }

    /// Arc about the point `radius` to the left (counter-clockwise) or right. Returns its end and the heading there.
    fn arc(&mut self, heading: f64, radius: f64, sweep: f64, rise: f64) -> f64 {
        let sign = sweep.signum();
        let to_center = along([0.0; 2], heading + sign * PI / 2.0, radius).map(rounded);
        let center = [self.at[0] + to_center[0], self.at[1] + to_center[1]];
        let start = libm::atan2(-to_center[1], -to_center[0]);
        let end = along(center, start + sweep, radius).map(rounded);
        let z = self.height(rise);
        let code = if sign > 0.0 { "G3" } else { "G2" };
        let ([x, y], [i, j]) = (end, to_center);
        writeln!(self.text, "{code}X{x:.6}Y{y:.6}{z}I{i:.6}J{j:.6}").expect("a string takes anything");
        self.at = end;
        heading + sweep
    }

    fn height(&mut self, rise: f64) -> String {
        self.z += rise;
        if rise == 0.0 { String::new() } else { format!("Z{:.3}", self.z) }
    }

    fn end(mut self, heading: f64) -> String {
        let [x, y] = along(self.at, heading, LEAD_MM).map(rounded);
        writeln!(self.text, "G40G1X{x:.6}Y{y:.6}").expect("a string takes anything");
        self.text
    }
}

/// Lines and arcs one after the other, with corners of all kinds.
fn open(rng: &mut Rng, side: &str, d: u32) -> String {
    let mut heading = rng.f64() * TAU;
    let mut writer = Writer::new([0.0; 2], heading, side, d);
    for index in 0..rng.usize(3..8) {
        if index > 0 && rng.u32(0..5) > 1 {
            let turn = (10.0 + 145.0 * rng.f64()).to_radians();
            heading += if rng.bool() { turn } else { -turn };
        }
        let rise = if rng.u32(0..4) == 0 { -0.5 } else { 0.0 };
        if rng.bool() {
            let to = along(writer.at, heading, 4.0 + 14.0 * rng.f64());
            writer.line(to, rise);
        } else {
            let sweep = (20.0 + 150.0 * rng.f64()).to_radians();
            let sweep = if rng.bool() { sweep } else { -sweep };
            heading = writer.arc(heading, 3.0 + 9.0 * rng.f64(), sweep, rise);
        }
    }
    writer.end(heading)
}

/// A polygon around the origin that begins in the middle of a side; some of its corners are rounded.
fn closed(rng: &mut Rng, side: &str, d: u32) -> String {
    let count = rng.usize(4..8);
    let sense = if rng.bool() { 1.0 } else { -1.0 };
    let points: Vec<[f64; 2]> = (0..count)
        .map(|index| {
            let angle = TAU * (index as f64 + 0.3 * rng.f64()) / count as f64;
            along([0.0; 2], sense * angle, 12.0 + 22.0 * rng.f64())
        })
        .collect();
    let middle: [f64; 2] = std::array::from_fn(|axis| rounded(0.5 * (points[0][axis] + points[count - 1][axis])));
    let first = direction(middle, points[0]);
    let mut writer = Writer::new(middle, first, side, d);
    let mut heading = first;
    for index in 0..count {
        let (corner, next) = (points[index], if index + 1 < count { points[index + 1] } else { middle });
        let turn = normalized(direction(corner, next) - heading);
        let radius = 2.0 + 4.0 * rng.f64();
        let cut = radius * libm::tan(0.5 * turn.abs());
        let room = 0.4 * distance(corner, next).min(distance(writer.at, corner));
        if rng.bool() && cut < room && turn.abs() > 0.2 {
            writer.line(along(corner, heading, -cut), 0.0);
            writer.arc(heading, radius, turn, 0.0);
        } else {
            writer.line(corner, 0.0);
        }
        heading = direction(corner, next);
    }
    writer.line(middle, 0.0);
    writer.end(heading)
}

fn along([x, y]: [f64; 2], heading: f64, by: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(heading);
    [x + by * cos, y + by * sin]
}

fn direction(from: [f64; 2], to: [f64; 2]) -> f64 {
    libm::atan2(to[1] - from[1], to[0] - from[0])
}

fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    libm::hypot(to[0] - from[0], to[1] - from[1])
}

/// Angle in (-pi, pi].
fn normalized(angle: f64) -> f64 {
    angle - TAU * ((angle / TAU) - 0.5).ceil()
}

/// To the sixth decimal.
fn rounded(mm: f64) -> f64 {
    (mm * 1e6).round() / 1e6
}
