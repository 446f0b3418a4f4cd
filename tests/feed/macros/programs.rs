//! Random programs with loops, nested and modal calls, variables in coordinates, G10 and G52.

use std::fmt::Write;

use fastrand::Rng;

/// Called programs; each calls only later ones.
const CALLED: usize = 4;
const RADII: [&str; 3] = ["8.", "8.", "12."];
const FEEDS: [&str; 3] = ["900.", "900.", "400."];

/// A program and those of its library, by file name.
pub struct RandomProgram {
    pub text: String,
    pub library: Vec<(String, String)>,
}

struct Writer {
    rng: Rng,
    text: String,
    /// Index of the called program that is written; none for the main program.
    called: Option<usize>,
    /// Modal calls are not set in a macro that one calls.
    has_modal: bool,
    labels: u32,
    counters: u32,
}

pub fn random(seed: u64) -> RandomProgram {
    let mut rng = Rng::with_seed(seed);
    let in_library = rng.u8(..4) == 0;
    let mut writer = Writer { rng, text: String::new(), called: None, has_modal: false, labels: 100, counters: 20 };
    writer.text += "%\nO0001 (RANDOM)\nG21G17G90G94\nT1M6\nS8000M3\nG0X0.Y0.Z5.\n";
    for (variable, values) in [(18, RADII), (9, FEEDS)] {
        let value = writer.one_of(&values);
        let _ = writeln!(writer.text, "#{variable}={value}");
    }
    for variable in 100..104 {
        let value = f64::from(writer.rng.i32(-200..200)) / 8.0;
        let _ = writeln!(writer.text, "#{variable}={value:.3}");
    }
    writer.text += "G1Z-1.F300.\n";
    for _ in 0..writer.rng.usize(8..20) {
        writer.statement(0, 0);
    }
    writer.text += "G0Z50.\nM30\n";
    let mut library = Vec::new();
    for index in 0..CALLED {
        let main = std::mem::take(&mut writer.text);
        (writer.called, writer.counters) = (Some(index), 20 + index as u32 * 3);
        let _ = writeln!(writer.text, "O{} (CALLED)", 9_000 + index);
        for _ in 0..writer.rng.usize(2..5) {
            writer.statement(0, 0);
        }
        writer.text += "M99\n";
        let called = std::mem::replace(&mut writer.text, main);
        if in_library && index == CALLED - 1 {
            library.push((format!("O{}.nc", 9_000 + index), called));
        } else {
            writer.text += &called;
        }
    }
    writer.text += "%\n";
    RandomProgram { text: writer.text, library }
}

impl Writer {
    fn one_of(&mut self, of: &[&str]) -> String {
        of[self.rng.usize(..of.len())].to_owned()
    }

    /// A coordinate, with or without variables.
    fn value(&mut self) -> String {
        let number = f64::from(self.rng.i32(-400..400)) / 8.0;
        match self.rng.u8(..4) {
            0 => format!("#{}", 100 + self.rng.u32(..4)),
            1 => format!("[#{}+{number:.3}]", 100 + self.rng.u32(..4)),
            2 => format!("[{number:.3}*COS[30.]]"),
            _ => format!("{number:.3}"),
        }
    }

    fn feed(&mut self) -> String {
        self.one_of(&["", "", "F900.", "F#9", "F[#9/2]", "F400."])
    }

    /// A statement; at most three loops are nested.
    fn statement(&mut self, loops: u32, depth: u32) {
        let can_call = self.called.is_none_or(|index| index + 1 < CALLED) && depth < 3;
        match self.rng.u8(..14) {
            0 | 1 => self.line(),
            2..=4 => self.arc(),
            5 if loops < 2 && depth < 3 => self.repeat(loops, depth),
            6 | 7 if can_call => self.call(),
            8 if self.called.is_none() && !self.has_modal && can_call => self.modal(loops, depth),
            9 if depth < 2 => self.shifted(loops, depth),
            10 => self.skipped(loops, depth),
            11 => {
                let (variable, value) = (100 + self.rng.u32(..4), self.value());
                let _ = writeln!(self.text, "#{variable}={value}");
            }
            12 => {
                let code = self.one_of(&["M8", "G4P20", "(A COMMENT)", "N7 M9", "G0Z2.\nG1Z-1."]);
                let _ = writeln!(self.text, "{code}");
            }
            _ => {
                let (x, y) = (self.value(), self.value());
                let _ = writeln!(self.text, "G10L2P1X{x}Y{y}");
            }
        }
    }

    fn line(&mut self) {
        let (x, y, feed) = (self.value(), self.value(), self.feed());
        let code = self.one_of(&["G1", "G1", "G1", "G0"]);
        let _ = writeln!(self.text, "{code}X{x} Y{y}{feed}");
    }

    fn arc(&mut self) {
        let (code, feed) = (self.one_of(&["G3", "G3", "G2"]), self.feed());
        let radius = self.one_of(&["8.", "12.", "#18", "#18", "[#18*2]"]);
        let _ = match self.rng.u8(..3) {
            0 => writeln!(self.text, "G91{code}X[2*{radius}]I{radius}{feed}\nG90"),
            1 => writeln!(self.text, "N5 {code}I-{radius}{feed}(CIRCLE)"),
            _ => writeln!(self.text, "{code}J{radius}{feed}"),
        };
    }

    fn repeat(&mut self, loops: u32, depth: u32) {
        let (counter, times) = (self.counters, self.rng.u32(0..5));
        self.counters += 1;
        let _ = writeln!(self.text, "#{counter}=0\nWHILE[#{counter}LT{times}]DO{}", loops + 1);
        for _ in 0..self.rng.usize(1..3) {
            self.statement(loops + 1, depth + 1);
        }
        let _ = writeln!(self.text, "#{counter}=#{counter}+1\nEND{}", loops + 1);
    }

    fn call(&mut self) {
        let next = self.called.map_or(0, |index| index + 1);
        let program = 9_000 + self.rng.usize(next..CALLED);
        let (radius, feed) = (self.one_of(&RADII), self.one_of(&FEEDS));
        let times = self.rng.u32(1..3);
        let _ = match self.rng.u8(..3) {
            0 => writeln!(self.text, "M98P{program}L{times}"),
            1 => writeln!(self.text, "G65P{program}R{radius}F{feed}"),
            _ => writeln!(self.text, "G65P{program}L{times}R#18F#9"),
        };
    }

    fn modal(&mut self, loops: u32, depth: u32) {
        let (radius, feed) = (self.one_of(&RADII), self.one_of(&FEEDS));
        let _ = writeln!(self.text, "G66P{}R{radius}F{feed}", 9_000 + CALLED - 1);
        self.has_modal = true;
        self.line();
        self.statement(loops, depth + 2);
        self.has_modal = false;
        self.text += "G67\n";
    }

    fn shifted(&mut self, loops: u32, depth: u32) {
        let (x, y) = (self.value(), self.value());
        let _ = writeln!(self.text, "G52X{x}Y{y}");
        self.statement(loops, depth + 1);
        self.text += "G52X0.Y0.\n";
    }

    fn skipped(&mut self, loops: u32, depth: u32) {
        // A jump from outside into a loop is an alarm; these labels are behind their jump, in the same loop.
        let (label, variable, value) = (self.labels, 100 + self.rng.u32(..4), self.value());
        self.labels += 1;
        let _ = writeln!(self.text, "IF[#{variable}GT{value}]GOTO{label}");
        self.statement(loops, depth + 1);
        let _ = writeln!(self.text, "N{label}");
    }
}
