//! Deviation of the tool from its path between two points, while the axes run in a straight line.
//!
//! | mode | the control interpolates | the tip leaves its line | the tool axis leaves its arc |
//! |---|---|---|---|
//! | `Tcp` | tip and direction | no | no |
//! | `PartRotary` | tip and rotary axes | no | yes |
//! | `Machine` | all axes | yes | yes |
//!
//! The line connects the two tips, the arc is the great circle between the two directions. Both deviations are the
//! maximum over many points of the move, at most one degree of either axis apart, with a finer search about the
//! maximum.
//!
//! Source: Tournier, 2 and 4.1.1 ("kinematical errors"); the measure is ours.

use super::forward::{Axes, Setup, ToolPose};
use super::machine::Machine;
use super::vector::{Vector, difference, dot, length, off_arc_deg, scaled, sum};

/// Minimum number of steps of the coarse search.
const POINTS_MIN: usize = 16;
/// Maximum number of steps of the coarse search.
const POINTS_MAX: usize = 2_000;
/// Steps of the golden-section search about the maximum; each reduces the interval to 0.618 of its length.
const REFINEMENTS: usize = 30;
/// Golden ratio of the search.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// Interpolation mode: the coordinates that the control moves evenly between two points of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Tip and direction of the tool in the part's frame, as under tool centre point control: the control computes the
    /// axes.
    Tcp,
    /// Tip in the part's frame, together with the rotary axes, whose positions the program contains.
    PartRotary,
    /// All axes; the program contains their positions.
    Machine,
}

/// A point of a path: the programmed pose of the tool, and the positions of the axes there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Programmed tip and direction.
    pub pose: ToolPose,
    /// Positions of all five axes that give this pose.
    pub axes: Axes,
}

/// Largest deviation of the tool from its path on the move between two points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Largest distance of the tip from the straight line between the two tips.
    pub tip_mm: f64,
    /// Largest angle of the tool axis from the shortest rotation between its two directions.
    pub axis_deg: f64,
}

impl Machine {
    /// Largest deviation of the tool on the move between two points if the control interpolates in this mode.
    pub fn deviation(&self, mode: Mode, setup: &Setup, from: &PathPoint, to: &PathPoint) -> Deviation {
        if mode == Mode::Tcp {
            return Deviation::default();
        }
        let axis_deg =
            self.axis_departure_deg(from.axes.rotary_deg, to.axes.rotary_deg, [from.pose.axis, to.pose.axis]);
        if mode == Mode::PartRotary {
            return Deviation { tip_mm: 0.0, axis_deg };
        }
        let off_line = |part: f64| {
            let pose = self.forward(&mixed(&from.axes, &to.axes, part), setup);
            off_line_mm(pose.tip_mm, from.pose.tip_mm, to.pose.tip_mm)
        };
        Deviation { tip_mm: greatest(points(from.axes.rotary_deg, to.axes.rotary_deg), off_line), axis_deg }
    }

    /// Largest angle of the tool axis from the shortest rotation between two directions, while the rotary axes run
    /// evenly from `from_deg` to `to_deg`.
    pub fn axis_departure_deg(&self, from_deg: [f64; 2], to_deg: [f64; 2], directions: [Vector; 2]) -> f64 {
        let off_arc = |part: f64| {
            let at = [0, 1].map(|axis: usize| between(pick(from_deg, axis), pick(to_deg, axis), part));
            off_arc_deg(self.axis_at(at), directions[0], directions[1])
        };
        greatest(points(from_deg, to_deg), off_arc)
    }
}

/// Positions of the axes on a straight move, at this fraction of it (0 at `from`, 1 at `to`).
pub fn mixed(from: &Axes, to: &Axes, part_ratio: f64) -> Axes {
    let [first, second] = [0, 1].map(|at| between(pick(from.rotary_deg, at), pick(to.rotary_deg, at), part_ratio));
    let way = difference(to.linear_mm, from.linear_mm);
    Axes { linear_mm: sum(from.linear_mm, scaled(way, part_ratio)), rotary_deg: [first, second] }
}

fn between(from: f64, to: f64, part: f64) -> f64 {
    from + (to - from) * part
}

fn pick(pair: [f64; 2], at: usize) -> f64 {
    if at == 0 { pair[0] } else { pair[1] }
}

/// Number of steps: one for each degree of the axis that turns further, plus one, within the limits.
fn points(from_deg: [f64; 2], to_deg: [f64; 2]) -> usize {
    let turned = libm::fabs(to_deg[0] - from_deg[0]).max(libm::fabs(to_deg[1] - from_deg[1]));
    (turned as usize).saturating_add(1).clamp(POINTS_MIN, POINTS_MAX)
}

/// Maximum of a function on [0, 1]: coarse search in `points` steps, then a golden-section search about the best of
/// them.
fn greatest(points: usize, value: impl Fn(f64) -> f64) -> f64 {
    let step = 1.0 / points as f64;
    let (mut best, mut at) = (0.0, 0.0);
    for index in 0..=points {
        let part = index as f64 * step;
        let found = value(part);
        if found > best {
            (best, at) = (found, part);
        }
    }
    let (mut low, mut high) = ((at - step).max(0.0), (at + step).min(1.0));
    for _ in 0..REFINEMENTS {
        let (left, right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        let (at_left, at_right) = (value(left), value(right));
        best = best.max(at_left).max(at_right);
        if at_left > at_right { high = right } else { low = left }
    }
    best
}

/// Distance of a point from a line segment.
fn off_line_mm(point: Vector, from: Vector, to: Vector) -> f64 {
    let (way, there) = (difference(to, from), difference(point, from));
    let square = dot(way, way);
    let part = if square > 0.0 { (dot(there, way) / square).clamp(0.0, 1.0) } else { 0.0 };
    length(difference(there, scaled(way, part)))
}
