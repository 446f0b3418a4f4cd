//! Writing of an NC program for a five-axis machine, in one of three modes.
//!
//! | mode | X Y Z | direction | F |
//! |---|---|---|---|
//! | `tcp`: G43.5 | tip in the part's frame | I J K | G94, of the tip |
//! | `part-rotary`: G43.4 | tip in the part's frame | A B C | G94, of the tip |
//! | `machine`: no compensation | gauge point in the machine frame | A B C | G93, no faster than the axes |
//!
//! In the modes that compute the axes here, points are added until every straight move keeps to the tolerance.

use std::fmt::Write;

use arcfeed_kinematics::branch_change::BranchChangeMoves;
use arcfeed_kinematics::deviation::{Deviation, Mode, PathPoint};
use arcfeed_kinematics::forward::Axes;
use arcfeed_kinematics::linearise::Tolerance;
use arcfeed_kinematics::vector::{difference, length};

use super::cl::Cl;
use super::finding::FindingKind;
use super::plan::{AxisPlan, Task};

/// Decimals of I, J, K.
const DIRECTION_DECIMALS: usize = 6;
/// Decimals of F in G93: controls take eight digits.
const INVERSE_TIME_DECIMALS: usize = 3;
/// Most decimals of a coordinate.
const DECIMALS_MAX: usize = 6;

/// Settings for writing an NC program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style<'a> {
    /// Name of the machine, for a comment.
    pub name: &'a str,
    /// Mode: whether the control or the writer computes the axes.
    pub mode: Mode,
    /// Largest deviation of the straight moves from the path: of the tip, and of the tool's axis.
    pub tolerance: Tolerance,
    /// Tool and spindle words at the start; `None`: the program has only the moves.
    pub start: Option<ToolStart>,
}

/// Tool and spindle words at the start of a whole program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolStart {
    /// Program number (O word).
    pub number: u32,
    /// Number of the tool, for T and H.
    pub tool: u32,
    /// Spindle speed (S word), rev/min.
    pub rev_per_min: f64,
    /// The program switches coolant on and off (M8, M9).
    pub coolant: bool,
}

/// Writes the NC program; returns it with its number of points.
///
/// # Errors
/// A move cannot be made straight, or the branch changes where the program cannot leave the part.
pub fn write(cl: &Cl, plan: &AxisPlan, task: &Task, style: &Style<'_>) -> Result<(String, usize), String> {
    let ways = ways_round(plan);
    if let Some((point, _)) = ways.first().filter(|_| style.mode != Mode::Machine) {
        let line = cl.points.get(*point).map_or(0, |point| point.line);
        return Err(format!(
            "{line}: a change of branch leaves the part only in --mode machine; see what `check --machine` says"
        ));
    }
    let mut text = header(cl, task, style, plan.stops.first());
    let mut writer = Writer { task, mode: style.mode, feed: None, points: 0 };
    let mut before: Option<PathPoint> = None;
    for (index, (point, stop)) in cl.points.iter().zip(&plan.stops).enumerate() {
        let way = ways.iter().find(|(at, _)| *at == index).map(|(_, way)| way);
        let from = match (way, before) {
            (Some(way), Some(last)) => Some(writer.round(&mut text, way, &last, point.feed_mm_per_min)),
            _ => before,
        };
        let path = match from {
            Some(from) => {
                let straight = task.machine.linearise(style.mode, &task.setup, &[from, *stop], &style.tolerance);
                straight.map_err(|error| not_straight(point.line, error.left))?
            }
            None => vec![*stop, *stop],
        };
        for pair in path.windows(2) {
            if let [from, to] = pair {
                writer.block(&mut text, from, to, point.feed_mm_per_min.filter(|_| before.is_some()));
            }
        }
        before = Some(*stop);
    }
    text.push_str(&footer(style));
    Ok((text, writer.points))
}

/// Changes of branch with the points at which they end.
fn ways_round(plan: &AxisPlan) -> Vec<(usize, &BranchChangeMoves)> {
    let mut ways = Vec::new();
    for finding in &plan.findings {
        if let FindingKind::Change(change, way) = &finding.what {
            ways.push((change.point, way.as_ref()));
        }
    }
    ways
}

fn header(cl: &Cl, task: &Task, style: &Style<'_>, first: Option<&PathPoint>) -> String {
    let (number, tool) = style.start.map_or((1, 1), |start| (start.number, start.tool));
    let (mode, lengths) = match style.mode {
        Mode::Tcp => ("TCP", format!("G94\nG43.5H{tool}\n")),
        Mode::PartRotary => ("PART-ROTARY", format!("G94\nG43.4H{tool}\n")),
        Mode::Machine => ("MACHINE", String::new()),
    };
    // The rotary axes turn with the tool at the end of Z, and alone; then X and Y move, from the part's zero as it lies with all axes at zero: so
    // the tool comes down to the first place along its own axis.
    let mut turns = String::from("G0");
    for (axis, value) in task.machine.rotary().iter().zip(first.map_or([0.0; 2], |stop| stop.axes.rotary_deg)) {
        word(&mut turns, &axis.letter.to_string(), value, decimals(axis.resolution_deg));
    }
    turns.push_str("\nG0");
    let linear = difference(first.map_or([0.0; 3], |stop| stop.axes.linear_mm), task.setup.part_zero_mm);
    for ((letter, value), axis) in ["X", "Y"].into_iter().zip(linear).zip(task.machine.linear()) {
        word(&mut turns, letter, value, decimals(axis.resolution_mm));
    }
    let start = style.start.map_or(String::new(), |ToolStart { rev_per_min, coolant, .. }| {
        let coolant = if coolant { "M8\n" } else { "" };
        format!("G49\nG91G28Z0.\nG90\nT{tool}M6\n{turns}\nS{}M3\n{coolant}", libm::round(rev_per_min))
    });
    let plain = |text: &str| -> String {
        let kept = text.chars().filter(|c| c.is_ascii_alphanumeric() || " .-/".contains(*c));
        kept.collect::<String>().to_ascii_uppercase()
    };
    let name = plain(cl.name.as_deref().unwrap_or("CL DATA"));
    format!("%\nO{number}({name})\n(MACHINE {}, MODE {mode})\nG21G17G40G90\n{start}{lengths}", plain(style.name))
}

fn footer(style: &Style<'_>) -> String {
    let mut text = String::from(if style.mode == Mode::Machine { "G94\n" } else { "G49\n" });
    if let Some(start) = style.start {
        text += if start.coolant { "M9\nM5\nG91G28Z0.\nG90\n" } else { "M5\nG91G28Z0.\nG90\n" };
    }
    text + "M30\n%\n"
}

struct Writer<'t> {
    task: &'t Task,
    mode: Mode,
    feed: Option<String>,
    points: usize,
}

impl Writer<'_> {
    /// Writes one move; a rapid if there is no feed.
    fn block(&mut self, text: &mut String, from: &PathPoint, to: &PathPoint, feed_mm_per_min: Option<f64>) {
        self.points += 1;
        let feed = feed_mm_per_min.map(|feed| match self.mode {
            Mode::Machine => self.inverse_time(from, to, feed),
            Mode::Tcp | Mode::PartRotary => shown(feed, 3),
        });
        let code = match (&feed, self.mode) {
            (None, Mode::Machine) => "G94G0",
            (None, _) => "G0",
            (Some(_), Mode::Machine) => "G93G1",
            (Some(_), _) => "G1",
        };
        text.push_str(code);
        self.place(text, to);
        // In G93 every block has its own F.
        if let Some(feed) = feed.filter(|feed| self.mode == Mode::Machine || self.feed.as_ref() != Some(feed)) {
            let _infallible = write!(text, "F{feed}");
            self.feed = Some(feed);
        }
        text.push('\n');
    }

    /// F in G93: one over the minutes of a move, as long as the slowest axis takes.
    fn inverse_time(&self, from: &PathPoint, to: &PathPoint, feed_mm_per_min: f64) -> String {
        let way_mm = length(difference(to.pose.tip_mm, from.pose.tip_mm));
        // A turn at a fixed tip has no path: it takes the time of a millimetre.
        let way_mm = if way_mm > 0.0 { way_mm } else { 1.0 };
        let allowed = self.task.machine.axis_feed(&from.axes, &to.axes, way_mm);
        let feed = allowed.map_or(feed_mm_per_min, |allowed| feed_mm_per_min.min(allowed.feed_mm_per_min));
        shown(feed / way_mm, INVERSE_TIME_DECIMALS)
    }

    /// Writes the words of a position.
    fn place(&self, text: &mut String, to: &PathPoint) {
        let linear = if self.mode == Mode::Machine { to.axes.linear_mm } else { to.pose.tip_mm };
        for ((letter, value), axis) in ["X", "Y", "Z"].into_iter().zip(linear).zip(self.task.machine.linear()) {
            word(text, letter, value, decimals(axis.resolution_mm));
        }
        if self.mode == Mode::Tcp {
            for (letter, value) in ["I", "J", "K"].into_iter().zip(to.pose.axis) {
                word(text, letter, value, DIRECTION_DECIMALS);
            }
            return;
        }
        for (axis, value) in self.task.machine.rotary().iter().zip(to.axes.rotary_deg) {
            word(text, &axis.letter.to_string(), value, decimals(axis.resolution_deg));
        }
    }

    /// Leaves the part, reorients, and approaches the next point from above; returns the position reached.
    fn round(&mut self, text: &mut String, way: &BranchChangeMoves, last: &PathPoint, feed: Option<f64>) -> PathPoint {
        let at = |axes: Axes| PathPoint { pose: self.task.machine.forward(&axes, &self.task.setup), axes };
        let [retract, clear, reorient, above] = [way.retract, way.clear, way.reorient, way.above].map(at);
        text.push_str("(RETRACT, REORIENT, RETURN)\n");
        self.block(text, last, &retract, feed);
        for (from, to) in [(&retract, &clear), (&clear, &reorient), (&reorient, &above)] {
            self.block(text, from, to, None);
        }
        above
    }
}

fn word(text: &mut String, letter: &str, value: f64, decimals: usize) {
    let _infallible = write!(text, "{letter}{}", shown(value, decimals));
}

/// Number with a point and without trailing zeros.
fn shown(value: f64, decimals: usize) -> String {
    let digits = format!("{value:.decimals$}");
    let pointed = if digits.contains('.') { digits } else { digits + "." };
    let short = pointed.trim_end_matches('0');
    if short == "-0." { "0.".into() } else { short.into() }
}

fn not_straight(line: usize, Deviation { tip_mm, axis_deg }: Deviation) -> String {
    format!(
        "{line}: no points make the move here straight, {tip_mm:.3} mm and {axis_deg:.3} degrees are left: a pole is too close; try --repair, \
         or a wider --axis-tolerance"
    )
}

/// Number of decimals that a resolution needs.
fn decimals(resolution: f64) -> usize {
    (libm::ceil(-libm::log10(resolution) - 1e-9).max(0.0) as usize).min(DECIMALS_MAX)
}
