//! Changes of branch: moves on which the tool would swing through the part.
//!
//! A move is a *swing* where the tool axis, while the rotary axes run in a straight line, leaves the arc between the two directions
//! by more than is allowed: (A, C) -> (-A, C + 180) sweeps over 2 A. A crossing 0 with C continuous is none, although the sign
//! of the branch changes. A swing that the machine would not make if points were added along the arc, because it then arrives
//! where it should, is only *coarse*; any other is a change of branch and never to be made in the cut.
//!
//! Source: Tournier, 4.1.1; telling the two apart by following the arc is ours.

use alloc::vec::Vec;

use super::forward::{Axes, Pose, Setup};
use super::machine::{Letter, Machine};
use super::vector::{Vector, along_arc, angle_deg, scaled, sum};

/// Steps along the arc for each degree of it.
const STEPS_PER_DEG: f64 = 20.0;
/// Least number of steps.
const STEPS_MIN: f64 = 64.0;
/// Two places this close to each other are the same.
const SAME_DEG: f64 = 1e-3;

/// What the machine does on a move between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Passage {
    /// The tool axis keeps to its arc.
    Smooth,
    /// It would with points added between.
    Coarse {
        /// How far it leaves the arc without them.
        departure_deg: f64,
    },
    /// A change of branch, or a turn back by whole turns.
    Change(Change),
}

/// A change of branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The point of the path that the move ends at.
    pub point: usize,
    /// Where the rotary axes stand before it.
    pub from_deg: [f64; 2],
    /// Where they stand after it.
    pub to_deg: [f64; 2],
    /// How far the tool axis would leave its arc.
    pub departure_deg: f64,
    /// The axis whose range forces it, and the point at which it would be left; `None`: the way is only shorter.
    pub forced_by: Option<(Letter, usize)>,
}

/// The way round a change of branch: nothing of it is in the cut but the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WayRound {
    /// Along the tool axis, out of the part.
    pub retract: Axes,
    /// On to the upper end of Z, where its range is known; the retracted place where not.
    pub clear: Axes,
    /// Rotary axes only.
    pub reorient: Axes,
    /// Above the point to return to.
    pub above: Axes,
    /// Along the tool axis, back into the cut.
    pub back: Axes,
}

impl Machine {
    /// What each move of a path does, the first being that to the second point; `allowed_deg` is how far the tool axis may leave
    /// its arc.
    pub fn passages(&self, poses: &[Pose], course: &[[f64; 2]], allowed_deg: f64) -> Vec<Passage> {
        let moves = poses.windows(2).zip(course.windows(2)).enumerate();
        let passage = |(before, (poses_of, places)): (usize, (&[Pose], &[[f64; 2]]))| {
            let ([start, end], [from, to]) = (poses_of, places) else { return Passage::Smooth };
            let directions = [start.axis, end.axis];
            let departure_deg = self.axis_departure_deg(*from, *to, directions);
            if departure_deg <= allowed_deg {
                return Passage::Smooth;
            }
            if self.follow(directions, *from, allowed_deg).is_some_and(|arrived| is_same(arrived, *to)) {
                return Passage::Coarse { departure_deg };
            }
            let point = before + 1;
            let forced_by = self.end_of_range(poses, point, *from);
            Passage::Change(Change { point, from_deg: *from, to_deg: *to, departure_deg, forced_by })
        };
        moves.map(passage).collect()
    }

    /// The way round a change: out of the part by `distance_mm`, reorient there, and back.
    pub fn way_round(&self, change: &Change, poses: [&Pose; 2], setup: &Setup, distance_mm: f64) -> WayRound {
        let off = |pose: &Pose, rotary_deg: [f64; 2], by_mm: f64| {
            let tip_mm = sum(pose.tip_mm, scaled(pose.axis, by_mm));
            Axes { linear_mm: self.linear_for(tip_mm, rotary_deg, setup), rotary_deg }
        };
        let [last, next] = poses;
        let retract = off(last, change.from_deg, distance_mm);
        let [x_mm, y_mm, z_mm] = retract.linear_mm;
        let [_, _, spindle] = self.linear();
        let top_mm = spindle.range_mm.map_or(z_mm, |[_, top_mm]| top_mm.max(z_mm));
        let clear = Axes { linear_mm: [x_mm, y_mm, top_mm], ..retract };
        WayRound {
            retract,
            clear,
            reorient: Axes { rotary_deg: change.to_deg, ..clear },
            above: off(next, change.to_deg, distance_mm),
            back: off(next, change.to_deg, 0.0),
        }
    }

    /// Where the axes arrive if they follow the arc step by step, within their ranges; `None` where a step is a swing.
    fn follow(&self, directions: [Vector; 2], from_deg: [f64; 2], allowed_deg: f64) -> Option<[f64; 2]> {
        let steps = libm::ceil(angle_deg(directions[0], directions[1]) * STEPS_PER_DEG).max(STEPS_MIN) as usize;
        let (mut at, mut before) = (from_deg, directions[0]);
        for step in 1..=steps {
            let next = along_arc(directions[0], directions[1], step as f64 / steps as f64)?;
            let there = self.nearest(next, at, true)?;
            if self.axis_departure_deg(at, there, [before, next]) > allowed_deg {
                return None;
            }
            (at, before) = (there, next);
        }
        Some(at)
    }

    /// Who would leave its range, and where, if the axes went on without a change.
    fn end_of_range(&self, poses: &[Pose], point: usize, from_deg: [f64; 2]) -> Option<(Letter, usize)> {
        let mut at = from_deg;
        for (index, pose) in poses.iter().enumerate().skip(point) {
            at = self.nearest(pose.axis, at, false)?;
            let mut axes = self.rotary().iter().zip(at);
            if let Some((axis, _)) = axes.find(|(axis, position_deg)| !axis.allows(*position_deg)) {
                return Some((axis.letter, index));
            }
        }
        None
    }
}

fn is_same(one_deg: [f64; 2], other_deg: [f64; 2]) -> bool {
    libm::fabs(one_deg[0] - other_deg[0]) + libm::fabs(one_deg[1] - other_deg[1]) < SAME_DEG
}
