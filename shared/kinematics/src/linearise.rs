//! Linearisation: adds points to a path so that straight moves of the axes keep within a tolerance.
//!
//! A move that leaves its line or its arc by more than the tolerance is halved. The new tip is the midpoint of the
//! line. If the tool axis is within its tolerance, the rotary axes take the midpoint of their move; otherwise the
//! direction is the midpoint of the arc, with the rotary positions nearest to the midpoint of their move. The
//! deviation falls with the square of the length, so that a few halvings suffice. A move that is still out of
//! tolerance after the last halving is a swing ([`super::branch_change`]) or passes a pole too closely
//! ([`super::singularity`]).
//!
//! Source: Tournier, 4.1.1 ("sampling of the movement"); halving is the simplest method.

use alloc::vec::Vec;
use core::fmt;

use super::deviation::{Deviation, Mode, PathPoint, mixed};
use super::forward::{Axes, Setup, ToolPose};
use super::machine::Machine;
use super::vector::{along_arc, scaled, sum};

/// Maximum number of halvings of one move: 4096 points.
const HALVINGS: u32 = 12;

/// Largest allowed deviation of the tool from its path on each move of a linearised path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Largest distance of the tip from the straight line between two tips.
    pub tip_mm: f64,
    /// Largest angle of the tool axis from the shortest rotation between two directions.
    pub axis_deg: f64,
}

/// Error: a move stays out of tolerance however many points are added to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearisationError {
    /// Index of the point at which the move ends.
    pub point: usize,
    /// Deviation that remains on this move after the last halving.
    pub left: Deviation,
}

impl Tolerance {
    fn holds(&self, found: Deviation) -> bool {
        found.tip_mm <= self.tip_mm && found.axis_deg <= self.axis_deg
    }
}

impl Machine {
    /// Adds points between the points `stops` of a path until each move is within the tolerance.
    ///
    /// # Errors
    /// The first move that added points do not bring within the tolerance.
    pub fn linearise(
        &self,
        mode: Mode,
        setup: &Setup,
        stops: &[PathPoint],
        tolerance: &Tolerance,
    ) -> Result<Vec<PathPoint>, LinearisationError> {
        let mut path: Vec<PathPoint> = stops.first().copied().into_iter().collect();
        for (point, to) in stops.iter().enumerate().skip(1) {
            let mut ahead = alloc::vec![(*to, 0)];
            while let (Some(&from), Some((to, halvings))) = (path.last(), ahead.pop()) {
                let left = self.deviation(mode, setup, &from, &to);
                if tolerance.holds(left) {
                    path.push(to);
                    continue;
                }
                let keeps_axis = left.axis_deg <= tolerance.axis_deg;
                let may_halve = halvings < HALVINGS;
                let middle = if may_halve { self.middle(setup, [&from, &to], keeps_axis) } else { None };
                let middle = middle.ok_or(LinearisationError { point, left })?;
                ahead.push((to, halvings + 1));
                ahead.push((middle, halvings + 1));
            }
        }
        Ok(path)
    }

    /// Midpoint of a move.
    fn middle(&self, setup: &Setup, [from, to]: [&PathPoint; 2], keeps_axis: bool) -> Option<PathPoint> {
        let tip_mm = scaled(sum(from.pose.tip_mm, to.pose.tip_mm), 0.5);
        let between_deg = mixed(&from.axes, &to.axes, 0.5).rotary_deg;
        let (axis, rotary_deg) = if keeps_axis {
            (self.axis_at(between_deg), between_deg)
        } else {
            let axis = along_arc(from.pose.axis, to.pose.axis, 0.5)?;
            (axis, self.nearest(axis, between_deg, true)?)
        };
        let linear_mm = self.linear_for(tip_mm, rotary_deg, setup);
        Some(PathPoint { pose: ToolPose { tip_mm, axis }, axes: Axes { linear_mm, rotary_deg } })
    }
}

impl fmt::Display for LinearisationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Deviation { tip_mm, axis_deg } = self.left;
        let point = self.point + 1;
        write!(
            f,
            "point {point}: no points make the move to it straight: {tip_mm:.4} mm and {axis_deg:.4} degrees are left"
        )
    }
}

impl core::error::Error for LinearisationError {}
