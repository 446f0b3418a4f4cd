//! Moves of a tool, replaced by straight sweeps with a fixed axis, and the error of that.
//!
//! A straight move that keeps the axis is one exact sweep. For all other moves, the surface that the sweeps leave is nowhere
//! further than the tolerance from the true one:
//!
//! ```text
//! arc, helix, angle a a sweep, radius r:        r a^2 / 8 <= tolerance                   (1)
//! axis turning, angle a a sweep, tool within R
//! of its middle, which is m above the tip:      R a / 2 + m a^2 / 8 <= tolerance         (2)
//! ```
//!
//! Sweeps that follow each other share the position between them, so nothing is left out there. In (2) each sweep has the
//! axis halfway through it, and the tool's middle goes straight.
//!
//! Source: (1) the error of linear interpolation, |f''| a^2 / 8; (2) |turned by a/2 - unturned| <= R a / 2, and (1) for the middle.

use std::fmt;

use arcfeed_kinematics::vector::{Vector, along_arc, angle_deg, difference, dot, length, scaled, sum, turned, unit};

use super::section::Sweep;
use super::tool::Tool;

/// Most sweeps of one move: more are a mistake in the tolerance.
const SWEEPS_MAX: f64 = 1e6;

/// Position of a tool in space: its tip, and the direction of its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position of the tip.
    pub tip_mm: Vector,
    /// Direction of the axis, from the tip to the holder, of any length.
    pub axis: Vector,
}

/// Move of a tool in space: straight or along an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// The tip moves on a straight line while the axis turns at a constant rate, through the smaller angle between both axes.
    Straight {
        /// Pose at the start.
        from: Pose,
        /// Pose at the end.
        to: Pose,
    },
    /// The tip moves on an arc or a helix about a line; the direction of the axis does not change.
    Turn {
        /// Pose at the start.
        from: Pose,
        /// A point of the line about which the tip turns.
        center_mm: Vector,
        /// Direction of that line, of any length.
        normal: Vector,
        /// Angle of the arc, by the right-hand rule about the normal.
        angle_rad: f64,
        /// Displacement along the normal over the whole angle; 0 for an arc.
        rise_mm: f64,
    },
}

/// Reason why a move cannot be replaced by sweeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MoveError {
    /// A tool axis or the normal of an arc is zero or not finite.
    Direction(Vector),
    /// The tool axis turns to its opposite: the plane in which it turns is then not determined.
    Opposite,
    /// A coordinate of a position is not a finite number.
    Position(Vector),
    /// The tolerance is not positive, or so small that the move would need more than a million sweeps.
    Tolerance {
        /// Rejected tolerance.
        tolerance_mm: f64,
    },
}

impl fmt::Display for MoveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MoveError::Direction(direction) => write!(f, "{direction:?} is no direction"),
            MoveError::Opposite => write!(f, "the tool axis turns to its opposite, which can be done in many ways"),
            MoveError::Position(position) => write!(f, "{position:?} is no position"),
            MoveError::Tolerance { tolerance_mm } => {
                write!(f, "{tolerance_mm} mm is no tolerance that this move can keep")
            }
        }
    }
}

impl std::error::Error for MoveError {}

impl Move {
    /// Straight sweeps that replace the move within the tolerance, in the order of the motion.
    ///
    /// # Errors
    /// A direction or position is invalid, the axis turns to its opposite, or the tolerance would need more than a million sweeps.
    pub fn sweeps(&self, tool: &Tool, tolerance_mm: f64) -> Result<Vec<Sweep>, MoveError> {
        if tolerance_mm.is_nan() || tolerance_mm <= 0.0 {
            return Err(MoveError::Tolerance { tolerance_mm });
        }
        match self {
            Move::Straight { from, to } => {
                let (from, to) = (from.checked()?, to.checked()?);
                if from.axis == to.axis {
                    return Ok(vec![Sweep { from_mm: from.tip_mm, to_mm: to.tip_mm, axis: from.axis }]);
                }
                tilting(from, to, tool, tolerance_mm)
            }
            Move::Turn { from, center_mm, normal, angle_rad, rise_mm } => {
                let from = from.checked()?;
                let normal = unit(*normal).ok_or(MoveError::Direction(*normal))?;
                let arm = difference(from.tip_mm, *center_mm);
                let radius_mm = length(difference(arm, scaled(normal, dot(arm, normal))));
                if !(radius_mm.is_finite() && angle_rad.is_finite() && rise_mm.is_finite()) {
                    return Err(MoveError::Position(*center_mm));
                }
                let angle_max_rad = libm::sqrt(8.0 * tolerance_mm / radius_mm); // (1)
                let count = count(angle_rad.abs() / angle_max_rad, tolerance_mm)?;
                let tip_mm = |step: usize| {
                    let part = step as f64 / count as f64;
                    let arm = turned(arm, normal, (angle_rad * part).to_degrees());
                    sum(sum(*center_mm, arm), scaled(normal, rise_mm * part))
                };
                let sweep = |step| Sweep { from_mm: tip_mm(step), to_mm: tip_mm(step + 1), axis: from.axis };
                Ok((0..count).map(sweep).collect())
            }
        }
    }
}

impl Pose {
    /// With the axis as a unit vector.
    fn checked(&self) -> Result<Self, MoveError> {
        if !self.tip_mm.iter().all(|coordinate| coordinate.is_finite()) {
            return Err(MoveError::Position(self.tip_mm));
        }
        let axis = unit(self.axis).ok_or(MoveError::Direction(self.axis))?;
        Ok(Pose { axis, ..*self })
    }
}

/// A straight way of the tip under a turning axis. (2)
fn tilting(from: Pose, to: Pose, tool: &Tool, tolerance_mm: f64) -> Result<Vec<Sweep>, MoveError> {
    let angle_rad = angle_deg(from.axis, to.axis).to_radians();
    let per_rad = tool.reach_mm() / 2.0 + tool.middle_mm().abs() * angle_rad / 8.0;
    let count = count(angle_rad * per_rad / tolerance_mm, tolerance_mm)?;
    let axis = |part: f64| along_arc(from.axis, to.axis, part).ok_or(MoveError::Opposite);
    let middle_mm = |part: f64| {
        let tip_mm = sum(from.tip_mm, scaled(difference(to.tip_mm, from.tip_mm), part));
        Ok(sum(tip_mm, scaled(axis(part)?, tool.middle_mm())))
    };
    let sweep = |step: usize| {
        let part = |steps: f64| (step as f64 + steps) / count as f64;
        let axis = axis(part(0.5))?;
        let to_tip = scaled(axis, tool.middle_mm());
        let tip_mm = |part: f64| Ok(difference(middle_mm(part)?, to_tip));
        Ok(Sweep { from_mm: tip_mm(part(0.0))?, to_mm: tip_mm(part(1.0))?, axis })
    };
    (0..count).map(sweep).collect()
}

fn count(least: f64, tolerance_mm: f64) -> Result<usize, MoveError> {
    match least.ceil().max(1.0) {
        count if count <= SWEEPS_MAX => Ok(count as usize),
        _ => Err(MoveError::Tolerance { tolerance_mm }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: Vector = [0.0, 0.0, 1.0];

    fn tool() -> Tool {
        Tool::cylinder(5.0, 20.0).unwrap()
    }

    #[test]
    fn a_straight_move_under_a_fixed_axis_is_one_sweep() {
        let from = Pose { tip_mm: [1.0, 2.0, 3.0], axis: [0.0, 0.0, 2.0] };
        let to = Pose { tip_mm: [4.0, 2.0, 0.0], axis: [0.0, 0.0, 2.0] };
        let sweeps = Move::Straight { from, to }.sweeps(&tool(), 1e-3).unwrap();
        assert_eq!(sweeps, [Sweep { from_mm: from.tip_mm, to_mm: to.tip_mm, axis: UP }]);
    }

    #[test]
    fn chords_of_a_helix_stay_within_the_tolerance_and_meet() {
        let from = Pose { tip_mm: [20.0, 0.0, 1.0], axis: UP };
        let helix = Move::Turn { from, center_mm: [0.0; 3], normal: UP, angle_rad: -7.0, rise_mm: -3.0 };
        let sweeps = helix.sweeps(&tool(), 1e-3).unwrap();
        for pair in sweeps.windows(2) {
            assert_eq!(pair[0].to_mm, pair[1].from_mm);
        }
        for sweep in &sweeps {
            let middle = scaled(sum(sweep.from_mm, sweep.to_mm), 0.5);
            assert!((20.0 - libm::hypot(middle[0], middle[1])) <= 1e-3);
        }
        let last = sweeps.last().unwrap().to_mm;
        let end = [20.0 * libm::cos(7.0), -20.0 * libm::sin(7.0), -2.0];
        assert!(length(difference(last, end)) < 1e-12, "{last:?}");
    }

    #[test]
    fn every_point_of_a_tilting_tool_is_within_the_tolerance_of_a_sweep() {
        let (tool, tolerance_mm) = (tool(), 0.02);
        let from = Pose { tip_mm: [0.0; 3], axis: UP };
        let to = Pose { tip_mm: [3.0, -1.0, 0.5], axis: [0.3, 0.4, 0.866] };
        let sweeps = Move::Straight { from, to }.sweeps(&tool, tolerance_mm).unwrap();
        let axis_to = unit(to.axis).unwrap();
        for sample in 0..=1000 {
            let part = f64::from(sample) / 1000.0;
            let index = ((part * sweeps.len() as f64) as usize).min(sweeps.len() - 1);
            let within = part * sweeps.len() as f64 - index as f64;
            let sweep = sweeps[index];
            let axis = along_arc(UP, axis_to, part).unwrap();
            let tip_mm = scaled(to.tip_mm, part);
            let swept_tip_mm = sum(sweep.from_mm, scaled(sweep.motion_mm(), within));
            for height_mm in [0.0, 20.0] {
                let true_mm = sum(tip_mm, scaled(axis, height_mm));
                let swept_mm = sum(swept_tip_mm, scaled(sweep.axis, height_mm));
                let disc_mm = 5.0 * angle_deg(axis, sweep.axis).to_radians();
                assert!(length(difference(true_mm, swept_mm)) <= tolerance_mm && disc_mm <= tolerance_mm, "{part}");
            }
        }
    }

    #[test]
    fn what_cannot_be_swept_says_why() {
        let up = Pose { tip_mm: [0.0; 3], axis: UP };
        let to = |axis| Move::Straight { from: up, to: Pose { axis, ..up } };
        assert_eq!(to([0.0, 0.0, -1.0]).sweeps(&tool(), 0.1), Err(MoveError::Opposite));
        assert_eq!(to([0.0; 3]).sweeps(&tool(), 0.1), Err(MoveError::Direction([0.0; 3])));
        assert!(matches!(to([0.0, 1.0, 0.0]).sweeps(&tool(), 1e-9), Err(MoveError::Tolerance { .. })));
        assert!(matches!(to(UP).sweeps(&tool(), 0.0), Err(MoveError::Tolerance { .. })));
    }
}
