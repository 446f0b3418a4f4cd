//! Random jobs.

use std::fmt::Write;

use fastrand::Rng;

/// The laws, as job files name them.
pub const LAWS: [&str; 5] = ["contour", "engagement", "engaged-arc", "table", "circumference"];
/// T numbers of a job's tools, and of one that no job has.
pub const TOOL_NUMBERS: [i64; 3] = [3, 4, 5];

/// A job, as it is written and as the truth takes it.
#[derive(Clone, Debug)]
pub struct RandomJob {
    pub law: &'static str,
    pub mode: &'static str,
    pub radius: f64,
    /// Inner radius of a cup mill.
    pub inner_radius: f64,
    pub teeth: u32,
    pub chip: f64,
    /// Spindle speed of the job; programs may command another.
    pub spindle: f64,
    pub is_set_by_operator: bool,
    pub has_number: bool,
    pub max_feed: f64,
    pub max_raise: f64,
    pub inside_only: bool,
    pub is_inside: bool,
    pub depth: f64,
    /// Path and feed per tooth.
    pub table: Vec<(f64, f64)>,
    /// Material, under engaged-arc: a disc's centre and radius.
    pub disc: ([f64; 2], f64),
    pub circle: Circle,
    /// Min, max and step of the override, %.
    pub limits: [u32; 3],
    /// Whether the control's block-delete switch is on.
    pub is_deleting: bool,
    /// The job's second tool, with what is the same for both as here.
    pub second: Option<Box<RandomJob>>,
}

/// Rule of a cup mill.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    pub is_interior: bool,
    pub is_outer: bool,
    pub is_ccw: bool,
    /// The stock line: direction of its normal, degrees, and offset.
    pub line: (f64, f64),
}

impl RandomJob {
    pub fn sample(random: &mut Rng, law: &'static str) -> Self {
        let radius = if law == "circumference" { between(random, 20.0, 80.0) } else { between(random, 2.0, 12.0) };
        let inner_radius = radius * between(random, 0.7, 0.95);
        let mut at = 0.0;
        let chip = log_between(random, 0.02, 0.2);
        let mut knot = || {
            at += [0.02, 0.5, 4.0][random.usize(..3)] * log_between(random, 0.3, 3.0);
            (round(at, 4), round(chip * log_between(random, 0.3, 3.0), 5))
        };
        let table = (0..8).map(|_| knot()).collect();
        let is_interior = random.bool();
        let circle = Circle {
            is_interior,
            is_outer: random.bool(),
            is_ccw: random.bool(),
            line: stock_line(random, radius, inner_radius, is_interior),
        };
        let mode = ["safe-base", "safe-base", "override-only", "rewrite-only"][random.usize(..4)];
        // The meter knows of no least override that holds a feed up.
        let limits = match (law, mode) {
            ("circumference", "override-only") => [1, 200, 1],
            _ => {
                let (min, max) = ([10, 20][random.usize(..2)], [100, 150, 200, 250][random.usize(..4)]);
                [min, max, [1, 1, 5, 10][random.usize(..4)]]
            }
        };
        RandomJob {
            law,
            mode,
            radius: round(radius, 3),
            inner_radius: round(inner_radius, 3),
            teeth: random.u32(2..=6),
            chip: round(chip, 5),
            spindle: f64::from(random.u32(2_000..8_000)),
            is_set_by_operator: random.bool(),
            has_number: random.u8(..4) > 0,
            max_feed: round(log_between(random, 200.0, 10_000.0), 0),
            max_raise: round(between(random, 1.0, 5.0), 2),
            inside_only: random.bool(),
            is_inside: random.bool(),
            depth: round(radius * between(random, 0.05, 1.9), 3),
            table,
            disc: ([round(between(random, -30.0, 30.0), 2), round(between(random, -30.0, 30.0), 2)], 25.0),
            circle,
            limits,
            // If the program's F is sent, a block that is not in the plan begins with 100 %: docs/safety-
            // case.md#transitions.
            is_deleting: random.bool() && mode != "override-only",
            second: None,
        }
    }

    /// The same with another tool beside it, under a law of its own.
    #[must_use]
    pub fn with_second_tool(self, random: &mut Rng) -> Self {
        let law = LAWS[random.usize(..LAWS.len())];
        let RandomJob { mode, limits, max_feed, max_raise, is_deleting, .. } = self;
        // The meter knows of no least override that holds a feed up.
        let limits = if mode == "override-only" { [1, 200, 1] } else { limits };
        let second = RandomJob::sample(random, law);
        let second = RandomJob { mode, limits, max_feed, max_raise, is_deleting, ..second };
        RandomJob { limits, has_number: true, second: Some(Box::new(second)), ..self }
    }

    /// The tool of a place among the job's.
    pub fn tool(&self, place: usize) -> Option<&RandomJob> {
        if place == 0 { Some(self) } else { self.second.as_deref() }
    }

    /// The job.
    pub fn toml(&self) -> String {
        match &self.second {
            None => self.common_toml() + "[tool]\n" + &self.tool_toml(self.has_number.then_some(TOOL_NUMBERS[0]), ""),
            Some(second) => [self, second].iter().zip(TOOL_NUMBERS).fold(self.common_toml(), |text, (tool, number)| {
                text + "[[tool]]\n" + &tool.tool_toml(Some(number), "tool.")
            }),
        }
    }

    /// A job for one of the tools alone.
    pub fn toml_of_one(&self, place: usize) -> String {
        let tool = self.tool(place).expect("the job has such a tool");
        self.common_toml() + "[tool]\n" + &tool.tool_toml(Some(TOOL_NUMBERS[place]), "")
    }

    fn common_toml(&self) -> String {
        let RandomJob { max_feed, max_raise, mode, limits: [min, max, step], .. } = self;
        let mut text = String::from("units = \"mm\"\nprogram = \"program.nc\"\n");
        let _ = writeln!(text, "[limits]\nmax_feed = {max_feed}\nmax_raise = {max_raise}");
        let _ = writeln!(text, "[override]\nmode = \"{mode}\"\nmin = {min}\nmax = {max}\nstep = {step}");
        text
    }

    /// A tool's keys, spindle, law and rules, in tables whose names begin so.
    fn tool_toml(&self, number: Option<i64>, prefix: &str) -> String {
        let RandomJob { law, radius, inner_radius, teeth, chip, spindle, .. } = self;
        let mut text = String::new();
        let _ = match *law {
            "circumference" => writeln!(
                text,
                "kind = \"cup-mill\"\nouter_radius = {radius}\ninner_radius = {inner_radius}\nactive_teeth = {teeth}"
            ),
            _ => writeln!(text, "kind = \"end-mill\"\ndiameter = {}\nteeth = {teeth}", 2.0 * radius),
        };
        if let Some(number) = number {
            let _ = writeln!(text, "number = {number}");
        }
        let set_by = if self.is_set_by_operator { "operator" } else { "program" };
        let _ = writeln!(text, "[{prefix}spindle]\nrev_per_min = {spindle}\nset_by = \"{set_by}\"");
        let _ = writeln!(text, "[{prefix}law]\nkind = \"{law}\"\nfeed_per_tooth = {chip}");
        if *law == "contour" {
            let _ = writeln!(text, "inside_only = {}", self.inside_only);
        }
        text + &self.rules().replace("[[cut]]", &format!("[[{prefix}cut]]"))
    }

    fn rules(&self) -> String {
        if self.law == "circumference" {
            let Circle { is_interior, is_outer, is_ccw, line: (normal, offset) } = self.circle;
            let word = |is: bool, yes: &'static str, no: &'static str| if is { yes } else { no };
            return format!(
                "[[cut]]\nrotation = \"{}\"\ndirection = \"{}\"\nside = \"{}\"\nstock = {{ normal_deg = {normal}, offset = {offset} }}\n",
                word(is_interior, "interior", "exterior"),
                word(is_ccw, "ccw", "cw"),
                word(is_outer, "outer", "inner"),
            );
        }
        let side = match self.law {
            "engaged-arc" => "outer",
            _ if self.is_inside => "inside",
            _ => "outside",
        };
        let body = match self.law {
            "engaged-arc" => format!("stock = {{ disc = [{}, {}, {}] }}", self.disc.0[0], self.disc.0[1], self.disc.1),
            "table" => {
                let rows: Vec<String> = self.table.iter().map(|(path, feed)| format!("[{path}, {feed}]")).collect();
                format!("radial_depth = {}\ntable = [{}]", self.depth, rows.join(", "))
            }
            _ => format!("radial_depth = {}", self.depth),
        };
        let rule = |moves: &str| format!("[[cut]]\n{moves}\nside = \"{side}\"\n{body}\n");
        ["moves = \"lines\"", "moves = \"arcs\"\ndirection = \"cw\"", "moves = \"arcs\"\ndirection = \"ccw\""]
            .map(rule)
            .concat()
    }
}

/// A line that the cutting circles meet while the centre runs about the origin.
fn stock_line(random: &mut Rng, radius: f64, inner_radius: f64, is_interior: bool) -> (f64, f64) {
    let path_radius = if is_interior { inner_radius } else { radius };
    let normal = between(random, -180.0, 180.0);
    (round(normal, 3), round(between(random, -1.0, 1.5) * path_radius, 3))
}

pub fn round(x: f64, digits: i32) -> f64 {
    let scale = libm::pow(10.0, f64::from(digits));
    libm::round(x * scale) / scale
}

pub fn between(random: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.f64()
}

fn log_between(random: &mut Rng, low: f64, high: f64) -> f64 {
    libm::exp(between(random, libm::log(low), libm::log(high)))
}
