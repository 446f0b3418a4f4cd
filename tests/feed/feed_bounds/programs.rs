//! Random programs: the text, and what each of its moves is.

use core::f64::consts::{PI, TAU};

use fastrand::Rng;

use crate::feed_bounds::jobs::{RandomJob, TOOL_NUMBERS, between, round};

/// A plane of arcs: first axis, second axis, and the letters of the centre.
pub const PLANES: [(usize, usize, [char; 2]); 3] = [(0, 1, ['I', 'J']), (2, 0, ['K', 'I']), (1, 2, ['J', 'K'])];

/// A move of the program.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    pub from: [f64; 3],
    pub to: [f64; 3],
    pub arc: Option<ArcMove>,
    /// The F in force.
    pub feed: f64,
    /// The spindle's speed, where it turns at one that is known.
    pub spindle: Option<f64>,
    /// Place of the tool in the spindle among the job's; `None` for one that the job doesn't have.
    pub tool: Option<usize>,
}

/// Shape of an arc.
#[derive(Clone, Copy, Debug)]
pub struct ArcMove {
    pub plane: usize,
    pub is_ccw: bool,
    /// In the plane.
    pub center: [f64; 2],
}

/// A program, block by block.
#[derive(Debug)]
pub struct RandomProgram {
    lines: Vec<String>,
    /// Feed moves by N; `None` with the block-delete switch in the other state.
    pub moves: Vec<Option<Move>>,
    state: State,
    is_deleting: bool,
    /// Spindle speed that the operator sets for each of the job's tools if the program gives none.
    operator_speeds: [Option<f64>; 2],
}

/// State of the control.
#[derive(Clone, Debug)]
struct State {
    at: [f64; 3],
    feed: Option<f64>,
    /// The last S.
    speed: Option<f64>,
    is_on: Option<bool>,
    /// See [`Move::tool`].
    tool: Option<usize>,
    heading: f64,
}

/// Block delete of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Slash {
    None,
    Block,
    /// Before the F word.
    Feed,
}

impl RandomProgram {
    /// Moves of all kinds, tools, speeds, planes, deleted blocks.
    pub fn of_everything(random: &mut Rng, job: &RandomJob) -> Self {
        let mut random_program = RandomProgram::begin(random, job);
        for _ in 0..random.usize(4..16) {
            let slash = match random.u8(..12) {
                0 => Slash::Block,
                1 => Slash::Feed,
                _ => Slash::None,
            };
            match random.u8(..20) {
                0 => random_program.change_tool(random, job),
                18.. if job.second.is_some() => random_program.change_tool(random, job),
                1 => random_program.change_spindle(random, slash),
                2 => random_program.rapid(random),
                3 | 4 => random_program.across(random, [3.0, 30.0], slash),
                5 | 6 => random_program.rise(random, slash),
                7 => random_program.arc(random, job, (1, 0.0), slash),
                8 => random_program.arc(random, job, (2, 0.0), slash),
                9 => {
                    let rise = between(random, -3.0, 3.0);
                    random_program.arc(random, job, (0, rise), slash);
                }
                10..=13 => random_program.across(random, [0.3, 30.0], slash),
                _ => random_program.arc(random, job, (0, 0.0), slash),
            }
        }
        random_program.end()
    }

    /// Lines that go on straight, corners, short blocks, arcs, all in one level.
    pub fn of_transitions(random: &mut Rng, job: &RandomJob) -> Self {
        let mut random_program = RandomProgram::begin(random, job);
        random_program.turn_on(4_000.0);
        for _ in 0..random.usize(5..20) {
            match random.u8(..8) {
                0 => random_program.rise(random, Slash::None),
                1..=4 => random_program.across(random, [0.2, 12.0], Slash::None),
                _ => random_program.arc(random, job, (0, 0.0), Slash::None),
            }
        }
        random_program.end()
    }

    /// The program with `%` and end.
    pub fn text(&self) -> String {
        self.lines.join("\n") + "\n"
    }

    fn begin(random: &mut Rng, job: &RandomJob) -> Self {
        // With several tools, the tool is unknown before the first M6.
        let tool = job.second.is_none().then_some(0);
        let state = State { at: [0.0; 3], feed: None, speed: None, is_on: None, tool, heading: 0.0 };
        let operator_speeds =
            [0, 1].map(|place| job.tool(place).filter(|tool| tool.is_set_by_operator).map(|tool| tool.spindle));
        let lines = ["%", "O1", "G21G17G90G94G40G49"].map(String::from).to_vec();
        let mut random_program =
            RandomProgram { lines, moves: Vec::new(), state, is_deleting: job.is_deleting, operator_speeds };
        if job.has_number && random.bool() {
            random_program.lines.push(format!("T{}M6", TOOL_NUMBERS[0]));
            (random_program.state.is_on, random_program.state.tool) = (Some(false), Some(0));
        }
        if random.u8(..8) > 0 {
            random_program.turn_on(f64::from(random.u32(2_000..8_000)));
        }
        let [x, y] = [0; 2].map(|_| round(between(random, -40.0, 40.0), 4));
        random_program.state.at = [x, y, 0.0];
        random_program.lines.push(format!("G0X{x:.4}Y{y:.4}Z0.0"));
        random_program
    }

    fn end(mut self) -> Self {
        self.lines.extend(["M30", "%"].map(String::from));
        self
    }

    fn turn_on(&mut self, speed: f64) {
        self.lines.push(format!("S{speed}M3"));
        (self.state.speed, self.state.is_on) = (Some(speed), Some(true));
    }

    fn change_tool(&mut self, random: &mut Rng, job: &RandomJob) {
        if !job.has_number {
            return;
        }
        let place = [0, 0, 1, 1, 2][random.usize(..5)];
        self.state.tool = Some(place).filter(|place| job.tool(*place).is_some() && *place < 2);
        self.lines.push(format!("T{}M6", TOOL_NUMBERS[place]));
        self.state.is_on = Some(false);
        if random.u8(..4) > 0 {
            self.turn_on(f64::from(random.u32(2_000..8_000)));
        }
    }

    fn change_spindle(&mut self, random: &mut Rng, slash: Slash) {
        let is_seen = slash != Slash::Block || !self.is_deleting;
        let mark = if slash == Slash::Block { "/" } else { "" };
        match random.u8(..3) {
            0 => {
                self.lines.push(format!("{mark}M5"));
                self.state.is_on = if is_seen { Some(false) } else { self.state.is_on };
            }
            1 => {
                self.lines.push(format!("{mark}M3"));
                self.state.is_on = if is_seen { Some(true) } else { self.state.is_on };
            }
            _ => {
                let speed = f64::from(random.u32(2_000..9_000));
                self.lines.push(format!("{mark}S{speed}"));
                if is_seen {
                    self.state.speed = Some(speed);
                    // An S without an M3 says that somebody else turns it on: at which speed is not known.
                    self.state.is_on = self.state.is_on.or(Some(false));
                }
            }
        }
    }

    fn rapid(&mut self, random: &mut Rng) {
        let [x, y] = [0; 2].map(|_| round(between(random, -40.0, 40.0), 4));
        self.go_rapidly([x, y, self.state.at[2]]);
    }

    fn go_rapidly(&mut self, to: [f64; 3]) {
        let [x, y, z] = to;
        self.lines.push(format!("G0X{x:.4}Y{y:.4}Z{z:.4}"));
        self.state.at = to;
    }

    /// A line in one level, straight on or around a corner.
    fn across(&mut self, random: &mut Rng, [least, most]: [f64; 2], slash: Slash) {
        self.state.heading += if random.bool() { 0.0 } else { between(random, -PI, PI) };
        let (sin, cos) = libm::sincos(self.state.heading);
        let length = between(random, least, most);
        let [x, y, z] = self.state.at;
        self.feed_move(random, [round(x + length * cos, 4), round(y + length * sin, 4), z], None, slash);
    }

    /// A plunge, or a ramp.
    fn rise(&mut self, random: &mut Rng, slash: Slash) {
        let [x, y, z] = self.state.at;
        let across = if random.bool() { 0.0 } else { between(random, 0.0, 20.0) };
        let to = [round(x + across, 4), y, round(z + between(random, -5.0, 5.0), 4)];
        self.feed_move(random, to, None, slash);
    }

    /// An arc, or a helix that rises by so much.
    fn arc(&mut self, random: &mut Rng, job: &RandomJob, (plane, rise): (usize, f64), slash: Slash) {
        let job = self.state.tool.and_then(|place| job.tool(place)).unwrap_or(job);
        if job.law == "circumference" && plane == 0 && rise == 0.0 {
            return self.rotation(random, job, slash);
        }
        let (first, second, _) = PLANES[plane];
        let radius = job.radius * libm::exp(between(random, -1.5, 2.5));
        let (start, sweep) = (between(random, 0.0, TAU), between(random, 0.05, 4.0).min(60.0 / radius));
        let is_ccw = random.bool();
        let from = [self.state.at[first], self.state.at[second]];
        let (sin, cos) = libm::sincos(start);
        let center = [round(from[0] - radius * cos, 4), round(from[1] - radius * sin, 4)];
        let mut to = self.state.at;
        let end = turned(from, center, if is_ccw { sweep } else { -sweep });
        (to[first], to[second]) = (round(end[0], 4), round(end[1], 4));
        to[3 - first - second] = round(to[3 - first - second] + rise, 4);
        self.feed_move(random, to, Some(ArcMove { plane, is_ccw, center }), slash);
    }

    /// An arc of a cup mill about the origin, its start approached first.
    fn rotation(&mut self, random: &mut Rng, job: &RandomJob, slash: Slash) {
        let radius = if job.circle.is_interior { job.inner_radius } else { job.radius };
        let [x, y, z] = self.state.at;
        let start = if libm::fabs(libm::hypot(x, y) - radius) < 2e-3 && random.bool() {
            [x, y]
        } else {
            let (sin, cos) = libm::sincos(between(random, 0.0, TAU));
            [round(radius * cos, 4), round(radius * sin, 4)]
        };
        if random.bool() {
            self.feed_move(random, [start[0], start[1], z], None, Slash::None);
        } else {
            self.go_rapidly([start[0], start[1], z]);
        }
        let is_ccw = if random.u8(..4) > 0 { job.circle.is_ccw } else { random.bool() };
        let sweep = between(random, 0.02, 1.5);
        let end = turned(start, [0.0; 2], if is_ccw { sweep } else { -sweep }).map(|x| round(x, 4));
        self.feed_move(random, [end[0], end[1], z], Some(ArcMove { plane: 0, is_ccw, center: [0.0; 2] }), slash);
    }

    fn feed_move(&mut self, random: &mut Rng, to: [f64; 3], arc: Option<ArcMove>, slash: Slash) {
        let feed = (self.state.feed.is_none() || random.u8(..3) == 0).then(|| f64::from(random.u32(200..4_000)));
        // The first F is never deleted: without one a control stops.
        let slash = if self.state.feed.is_none() { Slash::None } else { slash };
        let [x, y, z] = to;
        let mut line = format!("N{}", self.moves.len() + 1);
        line += match arc {
            None => "G1",
            Some(ArcMove { plane, is_ccw, .. }) => {
                ["G17G2", "G17G3", "G18G2", "G18G3", "G19G2", "G19G3"][2 * plane + usize::from(is_ccw)]
            }
        };
        line += &format!("X{x:.4}Y{y:.4}Z{z:.4}");
        if let Some(ArcMove { plane, center, .. }) = arc {
            let (first, second, letters) = PLANES[plane];
            let from = [self.state.at[first], self.state.at[second]];
            for ((letter, center), from) in letters.iter().zip(center).zip(from) {
                line += &format!("{letter}{:.4}", center - from);
            }
        }
        let is_gone = slash == Slash::Block && self.is_deleting;
        if let Some(feed) = feed {
            line += &format!("{}F{feed}", if slash == Slash::Feed { "/" } else { "" });
        }
        self.lines.push(if slash == Slash::Block { format!("/{line}") } else { line });
        if is_gone {
            return self.moves.push(None);
        }
        if slash != Slash::Feed || !self.is_deleting {
            self.state.feed = feed.or(self.state.feed);
        }
        let State { at, feed, speed, is_on, tool, .. } = self.state;
        let spindle = speed.or(tool.and_then(|place| self.operator_speeds[place])).filter(|_| is_on != Some(false));
        self.moves.push(Some(Move { from: at, to, arc, feed: feed.unwrap_or(0.0), spindle, tool }));
        self.state.at = to;
    }
}

fn turned(point: [f64; 2], center: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    let [x, y] = [point[0] - center[0], point[1] - center[1]];
    [center[0] + x * cos - y * sin, center[1] + x * sin + y * cos]
}
