//! Programs whose tool is known.

use std::f64::consts::TAU;

use fastrand::Rng;

/// Spindle speeds, rev/min.
const SPEEDS: [i64; 2] = [1_000, 8_000];

/// A program under construction.
struct Program {
    lines: Vec<String>,
    is_inch: bool,
    at: [f64; 2],
}

impl Program {
    fn new(rng: &mut Rng) -> Self {
        let is_inch = rng.bool();
        let lines =
            vec![format!("G{}G17G90G94T3M6", if is_inch { 20 } else { 21 }), format!("S{}M3", SPEEDS[rng.usize(0..2)])];
        Program { lines, is_inch, at: [0.0; 2] }
    }

    fn word(&self, letter: char, mm: f64) -> String {
        if self.is_inch { format!("{letter}{:.4}", mm / 25.4) } else { format!("{letter}{mm:.3}") }
    }

    fn add(&mut self, words: String) {
        let number = 10 * self.lines.len();
        self.lines.push(format!("N{number}{words}"));
    }

    /// Turns about a point, by so many radians, counter-clockwise positive.
    fn turn(&mut self, center: [f64; 2], by: f64) {
        let ([x, y], [cx, cy]) = (self.at, center);
        let (sin, cos) = libm::sincos(by);
        let to = [cx + (x - cx) * cos - (y - cy) * sin, cy + (x - cx) * sin + (y - cy) * cos];
        let code = if by > 0.0 { "G3" } else { "G2" };
        let words = [self.word('X', to[0]), self.word('Y', to[1]), self.word('I', cx - x), self.word('J', cy - y)];
        self.add(format!("{code}{}F25.", words.concat()));
        self.at = to;
    }

    fn go(&mut self, code: &str, to: [f64; 2]) {
        let words = [self.word('X', to[0]), self.word('Y', to[1])].concat();
        self.add(format!("{code}{words}F25."));
        self.at = to;
    }

    fn text(&self) -> String {
        self.lines.join("\n") + "\nM30\n"
    }
}

/// A cup mill's program, its inner and outer radius, mm: there and back about two points, a level after the other, and now
/// and then an arc that is none of its.
pub fn cup_mill(rng: &mut Rng) -> (String, [f64; 2]) {
    let outer = 30.0 + 150.0 * rng.f64();
    let inner = outer * (0.6 + 0.37 * rng.f64());
    let mut program = Program::new(rng);
    let base = [200.0 * rng.f64() - 100.0, 200.0 * rng.f64() - 100.0];
    let angle = TAU * rng.f64();
    let about = [(inner, angle), (outer, angle + 0.4 * rng.f64())]
        .map(|(radius, angle)| [base[0] + radius * libm::cos(angle), base[1] + radius * libm::sin(angle)]);
    program.go("G0", base);
    for level in 0..rng.usize(3..9) {
        let z = program.word('Z', -(level as f64));
        program.add(format!("G1{z}F25."));
        for (center, sense) in about.into_iter().zip([-1.0, 1.0]) {
            let by = sense * (0.1 + 0.5 * rng.f64());
            program.turn(center, by);
            program.turn(center, -by);
        }
        if rng.u8(0..3) == 0 {
            let other = [base[0] + 2.0 + 300.0 * rng.f64(), base[1]];
            program.turn(other, 0.3 + rng.f64());
            program.go("G0", base);
        }
    }
    (program.text(), [inner, outer])
}

/// An end mill's program: a rectangle whose corners have two radii, twice each, a few times over.
pub fn end_mill(rng: &mut Rng) -> String {
    let mut program = Program::new(rng);
    let radii = [2.0 + 8.0 * rng.f64(), 2.0 + 8.0 * rng.f64()];
    let (width, height) = (60.0 + 40.0 * rng.f64(), 60.0 + 40.0 * rng.f64());
    for pass in 0..rng.usize(1..4) {
        let grow = 20.0 * pass as f64;
        program.go("G0", [0.0, -grow]);
        let (right, top) = (width + grow, height + grow);
        // Each side, then the corner behind it.
        for (index, (to, into)) in [
            ([right, -grow], [0.0, 1.0]),
            ([right, top], [-1.0, 0.0]),
            ([-grow, top], [0.0, -1.0]),
            ([-grow, -grow], [1.0, 0.0]),
        ]
        .into_iter()
        .enumerate()
        {
            let radius = radii[index % 2];
            let along: [f64; 2] = [into[1], -into[0]];
            let before = [to[0] - radius * along[0], to[1] - radius * along[1]];
            program.go("G1", before);
            program.turn([before[0] + radius * into[0], before[1] + radius * into[1]], TAU / 4.0);
        }
    }
    program.text()
}
