//! A program for the machine, in one of three modes.
//!
//! | mode | X Y Z | direction | F |
//! |---|---|---|---|
//! | `tcp`: G43.5 | tip in the part's frame | I J K | G94, of the tip |
//! | `part-rotary`: G43.4 | tip in the part's frame | A B C | G94, of the tip |
//! | `machine`: no compensation | gauge point in the machine frame | A B C | G93: no other feed means the tip's |
//!
//! Where the axes are computed here, points are added until every straight move keeps to the tolerance.

use std::fmt::Write;

use arcfeed_shared::kinematics::between::{Mode, Stop};
use arcfeed_shared::kinematics::change::WayRound;
use arcfeed_shared::kinematics::forward::Axes;
use arcfeed_shared::kinematics::linearise::Tolerance;
use arcfeed_shared::kinematics::vector::{difference, length};

use super::cl::Cl;
use super::finding::What;
use super::plan::{Plan, Task};

/// Decimals of I, J, K.
const DIRECTION_DECIMALS: usize = 6;
/// Most decimals of a coordinate.
const DECIMALS_MAX: usize = 6;

/// How a program is to be written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style<'a> {
    /// The machine's name.
    pub name: &'a str,
    /// Who computes the axes.
    pub mode: Mode,
    /// What straight moves may be off.
    pub tolerance: Tolerance,
}

/// The program, and the points it has.
///
/// # Errors
/// A move that cannot be made straight, or a change of branch where the program cannot leave the part.
pub fn write(cl: &Cl, plan: &Plan, task: &Task, style: &Style<'_>) -> Result<(String, usize), String> {
    let ways = ways_round(cl, plan);
    if let Some((point, _)) = ways.first().filter(|_| style.mode != Mode::Machine) {
        let line = cl.points.get(*point).map_or(0, |point| point.line);
        return Err(format!(
            "{line}: a change of branch leaves the part only in --mode machine; see what `check --machine` says"
        ));
    }
    let mut text = header(cl, style);
    let mut writer = Writer { task, mode: style.mode, feed: None, points: 0 };
    let mut before: Option<Stop> = None;
    for (index, (point, stop)) in cl.points.iter().zip(&plan.stops).enumerate() {
        let way = ways.iter().find(|(at, _)| *at == index).map(|(_, way)| way);
        let from = match (way, before) {
            (Some(way), Some(last)) => Some(writer.round(&mut text, way, &last, point.feed_mm_per_min)),
            _ => before,
        };
        let path = match from {
            Some(from) => {
                let straight = task.machine.linearise(style.mode, &task.setup, &[from, *stop], &style.tolerance);
                straight.map_err(|error| {
                    format!("{}: no points make the move here straight: {:?}", point.line, error.left)
                })?
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
    text.push_str(if style.mode == Mode::Machine { "G94\nM30\n%\n" } else { "G49\nM30\n%\n" });
    Ok((text, writer.points))
}

/// Changes of branch with the points they end at.
fn ways_round<'p>(cl: &Cl, plan: &'p Plan) -> Vec<(usize, &'p WayRound)> {
    let way = |finding: &'p super::finding::Finding| match &finding.what {
        What::Change(change, way) => Some((change.point.min(cl.points.len()), way.as_ref())),
        _ => None,
    };
    plan.findings.iter().filter_map(way).collect()
}

fn header(cl: &Cl, style: &Style<'_>) -> String {
    let (mode, start) = match style.mode {
        Mode::Tcp => ("TCP", "G94\nG43.5H1\n"),
        Mode::PartRotary => ("PART-ROTARY", "G94\nG43.4H1\n"),
        Mode::Machine => ("MACHINE", ""),
    };
    let plain = |text: &str| -> String {
        let kept = text.chars().filter(|c| c.is_ascii_alphanumeric() || " .-/".contains(*c));
        kept.collect::<String>().to_ascii_uppercase()
    };
    let name = plain(cl.name.as_deref().unwrap_or("CL DATA"));
    format!("%\nO1({name})\n(MACHINE {}, MODE {mode})\nG21G17G40G90\n{start}", plain(style.name))
}

struct Writer<'t> {
    task: &'t Task,
    mode: Mode,
    feed: Option<String>,
    points: usize,
}

impl Writer<'_> {
    /// One move; rapid where there is no feed.
    fn block(&mut self, text: &mut String, from: &Stop, to: &Stop, feed_mm_per_min: Option<f64>) {
        self.points += 1;
        let way_mm = length(difference(to.pose.tip_mm, from.pose.tip_mm));
        let feed = feed_mm_per_min.map(|feed| match self.mode {
            // A turn on the spot has no way: it takes the time of a millimetre.
            Mode::Machine => format!("{:.4}", feed / if way_mm > 0.0 { way_mm } else { 1.0 }),
            Mode::Tcp | Mode::PartRotary => format!("{feed:.3}"),
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

    /// The words of a place.
    fn place(&self, text: &mut String, to: &Stop) {
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

    /// Out of the part, reorient, and above where the path goes on; answers where that is.
    fn round(&mut self, text: &mut String, way: &WayRound, last: &Stop, feed: Option<f64>) -> Stop {
        let at = |axes: Axes| Stop { pose: self.task.machine.forward(&axes, &self.task.setup), axes };
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
    let shown = format!("{value:.decimals$}");
    let shown = if shown.contains('.') { shown.trim_end_matches('0') } else { &shown };
    let is_nothing = shown.trim_start_matches('-').trim_matches(|c| c == '0' || c == '.').is_empty();
    let _infallible = write!(text, "{letter}{}", if is_nothing { "0." } else { shown });
}

/// Decimals that show a resolution.
fn decimals(resolution: f64) -> usize {
    (libm::ceil(-libm::log10(resolution) - 1e-9).max(0.0) as usize).min(DECIMALS_MAX)
}
