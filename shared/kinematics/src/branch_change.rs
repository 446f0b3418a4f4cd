//! Branch changes: moves on which the tool would swing through the part.
//!
//! A move is a *swing* if the tool axis, while the rotary axes run in a straight line, leaves the arc between the two
//! directions by more than is allowed: (A, C) -> (-A, C + 180) sweeps over 2 A. A move on which A crosses 0 with C
//! continuous is not a swing, although the sign of the branch changes. A swing is only *coarse* if added points along
//! the arc would lead the axes to the same end position. Any other swing is a branch change, which must not be made in
//! the cut.
//!
//! Source: Tournier, 4.1.1; the distinction by following the arc is ours.

use alloc::vec::Vec;

use super::forward::{Axes, Setup, ToolPose};
use super::machine::{Letter, Machine};
use super::vector::{Vector, along_arc, angle_deg, scaled, sum};

/// Steps along the arc for each degree of it.
const STEPS_PER_DEG: f64 = 20.0;
/// Minimum number of steps.
const STEPS_MIN: f64 = 64.0;
/// Tolerance for the comparison of two positions.
const SAME_DEG: f64 = 1e-3;

/// Behaviour of the tool axis on a move between two points, compared with the shortest rotation (the arc) from its
/// first direction to its last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transition {
    /// The tool axis keeps to the arc, within the allowed angle.
    Smooth,
    /// The tool axis leaves the arc by more than the allowed angle, but would keep to it if points were added along
    /// the arc.
    Coarse {
        /// Largest angle of the tool axis from the arc without these points, degrees.
        departure_deg: f64,
    },
    /// A branch change (a switch to the other solution of the rotary axes), or a rotation back by whole turns; added
    /// points would not avoid it.
    Change(BranchChange),
}

/// Move on which the rotary axes change from one of their two solutions for the tool's direction to the other, or by
/// whole turns: they turn by large angles while the direction barely changes. It must not be made in the cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchChange {
    /// Index of the point at which the move ends.
    pub point: usize,
    /// Positions of the rotary axes at the start of the move.
    pub from_deg: [f64; 2],
    /// Positions of the rotary axes at its end.
    pub to_deg: [f64; 2],
    /// Largest angle, on the move, of the tool axis from the shortest rotation between its first and its last
    /// direction.
    pub departure_deg: f64,
    /// Rotary axis whose range forces the change, and index of the point at which that axis would leave its range
    /// without it; `None` if the change only shortens the travel of the axes.
    pub forced_by: Option<(Letter, usize)>,
}

/// Axis positions of the moves that replace a branch change, in order: out of the part, reorientation, and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchChangeMoves {
    /// After the retraction along the tool axis, out of the part, with the old rotary positions.
    pub retract: Axes,
    /// With Z at the upper end of its range, for the reorientation; the retracted position if the range of Z is
    /// unknown.
    pub clear: Axes,
    /// After the move of the rotary axes alone, to their new positions.
    pub reorient: Axes,
    /// At the retraction distance from the next point of the path, along the tool axis.
    pub above: Axes,
    /// At the next point of the path, after the approach along the tool axis.
    pub back: Axes,
}

impl Machine {
    /// Classifies each move of a path; the first entry belongs to the move from the first point to the second.
    /// `rotary_deg` has the positions of the rotary axes at each pose. A move is smooth if the tool axis leaves the
    /// shortest rotation between its two directions by at most `allowed_deg`.
    pub fn transitions(&self, poses: &[ToolPose], rotary_deg: &[[f64; 2]], allowed_deg: f64) -> Vec<Transition> {
        let moves = poses.windows(2).zip(rotary_deg.windows(2)).enumerate();
        let passage = |(before, (poses_of, places)): (usize, (&[ToolPose], &[[f64; 2]]))| {
            let ([start, end], [from, to]) = (poses_of, places) else { return Transition::Smooth };
            let directions = [start.axis, end.axis];
            let departure_deg = self.axis_departure_deg(*from, *to, directions);
            if departure_deg <= allowed_deg {
                return Transition::Smooth;
            }
            if self.follow(directions, *from, allowed_deg).is_some_and(|arrived| is_same(arrived, *to)) {
                return Transition::Coarse { departure_deg };
            }
            let point = before + 1;
            let forced_by = self.end_of_range(poses, point, *from);
            Transition::Change(BranchChange { point, from_deg: *from, to_deg: *to, departure_deg, forced_by })
        };
        moves.map(passage).collect()
    }

    /// Moves that replace a branch change between two consecutive `poses`: retraction along the tool axis by
    /// `distance_mm`, reorientation, and return.
    pub fn branch_change_moves(
        &self,
        change: &BranchChange,
        poses: [&ToolPose; 2],
        setup: &Setup,
        distance_mm: f64,
    ) -> BranchChangeMoves {
        let off = |pose: &ToolPose, rotary_deg: [f64; 2], by_mm: f64| {
            let tip_mm = sum(pose.tip_mm, scaled(pose.axis, by_mm));
            Axes { linear_mm: self.linear_for(tip_mm, rotary_deg, setup), rotary_deg }
        };
        let [last, next] = poses;
        let retract = off(last, change.from_deg, distance_mm);
        let [x_mm, y_mm, z_mm] = retract.linear_mm;
        let [_, _, spindle] = self.linear();
        let top_mm = spindle.range_mm.map_or(z_mm, |[_, top_mm]| top_mm.max(z_mm));
        let clear = Axes { linear_mm: [x_mm, y_mm, top_mm], ..retract };
        BranchChangeMoves {
            retract,
            clear,
            reorient: Axes { rotary_deg: change.to_deg, ..clear },
            above: off(next, change.to_deg, distance_mm),
            back: off(next, change.to_deg, 0.0),
        }
    }

    /// End positions of the axes if they follow the arc step by step within their ranges; `None` if a step is a swing.
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

    /// The axis that would leave its range without a branch change, and the point at which it would.
    fn end_of_range(&self, poses: &[ToolPose], point: usize, from_deg: [f64; 2]) -> Option<(Letter, usize)> {
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
