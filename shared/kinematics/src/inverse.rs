//! Inverse kinematics: all positions of the axes for a pose.
//!
//! Wanted are q0, q1 with R_0(q0) R_1(q1) t0 = t. With the directions u0, u1 of the axes, w = R_1(q1) t0 lies on the circle of t0
//! about u1 and on that of t about u0:
//!
//! ```text
//! c = u0.u1,  a = t.u0,  b = t0.u1,  d = u1.(t0 - a u0),  n = u0 x u1,  p = |t x u0| |n|        (1)
//! w = ((a - b c) u0 + d u1 +- sqrt((p - d)(p + d)) n) / n.n                                     (2)
//! q1: angle from t0 to w about u1,    q0: angle from w to t about u0                            (3)
//! ```
//!
//! If |d| > p, no angles reach t. If t x u0 = 0, t is a *pole*: it lies along the first axis, and any q0 is a solution.
//! The root is computed from t x u0, so that nothing cancels near a pole, where acos(k) would lose half of the digits.
//!
//! Source: two circles on a sphere (the second of the problems named after Paden and Kahan); for A/C tables the two solutions
//! are those of Tournier, table 1.

use core::fmt;

use super::forward::{Axes, Setup, ToolPose};
use super::machine::{AxisName, Letter, Machine, RotaryAxis};
use super::vector::{HALF_TURN_DEG, Vector, angle_deg, cross, difference, dot, length, scaled, sum, wrapped_deg};

/// Tolerance below which a direction counts as a pole, or as the limit of the reachable directions.
const NOTHING: f64 = 1e-15;

/// Positions of the rotary axes that give one tool direction, without whole turns and regardless of the axes' ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Angles {
    /// No positions give the direction.
    None,
    /// The direction is at the limit of the reachable directions, where both solutions coincide.
    One([f64; 2]),
    /// Two solutions.
    Two([[f64; 2]; 2]),
    /// The direction lies along the first rotary axis (a pole): the position of the second axis is determined, that of
    /// the first is free.
    Any {
        /// Position of the second axis.
        second_deg: f64,
    },
}

/// Positions of all five axes that give one pose of the tool, with the rotary axes in their ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solutions {
    /// No positions, and the reason.
    None(Unreachable),
    /// Only one solution exists, or only one lies in the ranges.
    One(Axes),
    /// Two solutions that differ by more than whole turns.
    Two([Axes; 2]),
    /// Infinitely many solutions; in this one the first rotary axis is as near as possible to the requested position.
    Any(Axes),
}

/// Reason why no positions of the rotary axes give a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unreachable {
    /// No angles of the two axes give it, whatever their ranges.
    Direction,
    /// An angle would give it, but lies outside the range of this axis.
    Range {
        /// The axis whose range is too small.
        letter: Letter,
        /// The angle that it would need.
        position_deg: f64,
    },
}

impl Machine {
    /// All positions of the rotary axes that give a direction, which is a unit vector in the part's frame from the tip
    /// to the holder. (1) to (3)
    pub fn angles(&self, direction: Vector) -> Angles {
        let [u0, u1] = self.rotary().map(|axis| axis.direction);
        let t0 = self.tool();
        let (c, a, b) = (dot(u0, u1), dot(direction, u0), dot(t0, u1));
        let d = dot(u1, difference(t0, scaled(u0, a)));
        let (n, from_pole) = (cross(u0, u1), length(cross(direction, u0)));
        let square = dot(n, n);
        let p = from_pole * length(n); // (1)
        if libm::fabs(d) > p + NOTHING {
            return Angles::None;
        }
        let root = libm::sqrt(((p - d) * (p + d)).max(0.0));
        let on_both = sum(scaled(u0, (a - b * c) / square), scaled(u1, d / square));
        let solve = |sign: f64| {
            let w = sum(on_both, scaled(n, sign * root / square)); // (2)
            [turn_about(u0, w, direction), turn_about(u1, t0, w)] // (3)
        };
        if from_pole < NOTHING {
            let [_, second_deg] = solve(1.0);
            return Angles::Any { second_deg };
        }
        if root == 0.0 { Angles::One(solve(1.0)) } else { Angles::Two([solve(-1.0), solve(1.0)]) }
    }

    /// All positions of the axes that give a pose, with the rotary axes in their ranges; each is moved by whole turns
    /// as near to `near_deg` as the ranges allow.
    pub fn inverse(&self, pose: &ToolPose, setup: &Setup, near_deg: [f64; 2]) -> Solutions {
        let axes =
            |rotary_deg: [f64; 2]| Axes { linear_mm: self.linear_for(pose.tip_mm, rotary_deg, setup), rotary_deg };
        let one = |angles: [f64; 2]| self.in_range(angles, near_deg).map(axes);
        match self.angles(pose.axis) {
            Angles::None => Solutions::None(Unreachable::Direction),
            Angles::One(angles) => match one(angles) {
                Ok(axes) => Solutions::One(axes),
                Err(why) => Solutions::None(why),
            },
            Angles::Two([first, second]) => match (one(first), one(second)) {
                (Ok(first), Ok(second)) => Solutions::Two([first, second]),
                (Ok(axes), Err(_)) | (Err(_), Ok(axes)) => Solutions::One(axes),
                (Err(why), Err(_)) => Solutions::None(why),
            },
            Angles::Any { second_deg } => match one([self.free_first(near_deg[0]), second_deg]) {
                Ok(axes) => Solutions::Any(axes),
                Err(why) => Solutions::None(why),
            },
        }
    }

    /// Positions of the rotary axes that differ from `angles_deg` by whole turns, lie in the ranges, and are as near
    /// as possible to `near_deg`.
    ///
    /// # Errors
    /// [`Unreachable::Range`] for the first axis whose range has no such position.
    pub fn in_range(&self, angles_deg: [f64; 2], near_deg: [f64; 2]) -> Result<[f64; 2], Unreachable> {
        let [first, second] = self.rotary();
        let place = |axis: &RotaryAxis, angle_deg: f64, near_deg: f64| {
            let nearest = axis.nearest_in_range(angle_deg, near_deg);
            nearest.ok_or(Unreachable::Range { letter: axis.letter, position_deg: angle_deg })
        };
        Ok([place(first, angles_deg[0], near_deg[0])?, place(second, angles_deg[1], near_deg[1])?])
    }

    /// Those positions of the rotary axes that give a direction with the least sum of rotations from
    /// `near_deg`. With `ranged` only positions in the ranges count. `None` if there are none.
    pub fn nearest(&self, direction: Vector, near_deg: [f64; 2], ranged: bool) -> Option<[f64; 2]> {
        let [first, second] = self.rotary();
        let place = |axis: &RotaryAxis, angle_deg: f64, near_deg: f64| {
            if ranged {
                axis.nearest_in_range(angle_deg, near_deg)
            } else {
                Some(RotaryAxis::nearest_turn(angle_deg, near_deg))
            }
        };
        let both =
            |angles: [f64; 2]| Some([place(first, angles[0], near_deg[0])?, place(second, angles[1], near_deg[1])?]);
        let way = |at: &[f64; 2]| libm::fabs(at[0] - near_deg[0]) + libm::fabs(at[1] - near_deg[1]);
        let found = match self.angles(direction) {
            Angles::None => [None, None],
            Angles::One(only) => [both(only), None],
            Angles::Two(branches) => branches.map(both),
            Angles::Any { second_deg } => [both([near_deg[0], second_deg]), None],
        };
        found.into_iter().flatten().min_by(|one, other| way(one).total_cmp(&way(other)))
    }

    /// The axes whose position lies outside their range.
    pub fn over_limits(&self, axes: &Axes) -> impl Iterator<Item = AxisName> {
        let linear = self.linear().iter().zip(axes.linear_mm).enumerate();
        let linear = linear.filter(|(_, (axis, at))| !axis.allows(*at)).map(|(index, _)| AxisName::Linear(index));
        let rotary = self.rotary().iter().zip(axes.rotary_deg).filter(|(axis, at)| !axis.allows(*at));
        linear.chain(rotary.map(|(axis, _)| AxisName::Rotary(axis.letter)))
    }

    /// Position of the first rotary axis to use when the tool lies along that axis, where any position gives the same
    /// direction: `near_deg`, limited to the range.
    pub fn free_first(&self, near_deg: f64) -> f64 {
        let [first, _] = self.rotary();
        first.range_deg.map_or(near_deg, |[least, greatest]| near_deg.clamp(least, greatest))
    }

    /// Angle between a direction and the line of the first rotary axis: 0 at a pole, at most 90 degrees.
    pub fn from_pole_deg(&self, direction: Vector) -> f64 {
        let [first, _] = self.rotary();
        let angle = angle_deg(direction, first.direction);
        angle.min(HALF_TURN_DEG - angle)
    }

    /// Angle from a pole (the direction of the first rotary axis) within which the axes cannot resolve directions: the
    /// angle by which one least increment of the second axis moves the tool axis there.
    pub fn pole_cone_deg(&self) -> f64 {
        let [_, second] = self.rotary();
        second.resolution_deg * length(cross(second.direction, self.tool()))
    }

    /// Whether a direction is nearer to a pole than [`Self::pole_cone_deg`].
    pub fn is_in_pole_cone(&self, direction: Vector) -> bool {
        self.from_pole_deg(direction) <= self.pole_cone_deg()
    }

    /// Unit vector of the pole nearest to a direction: along the first rotary axis, or opposite to it.
    pub fn nearest_pole(&self, direction: Vector) -> Vector {
        let [first, _] = self.rotary();
        scaled(first.direction, if dot(direction, first.direction) < 0.0 { -1.0 } else { 1.0 })
    }
}

/// Angle about u that rotates v to w; both must have the same component along u.
fn turn_about(u: Vector, v: Vector, w: Vector) -> f64 {
    let across = |x: Vector| difference(x, scaled(u, dot(u, x)));
    let (v, w) = (across(v), across(w));
    wrapped_deg(libm::atan2(dot(u, cross(v, w)), dot(v, w)).to_degrees())
}

impl fmt::Display for Unreachable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unreachable::Direction => f.write_str("no positions of the rotary axes give this direction"),
            Unreachable::Range { letter, position_deg } => {
                write!(f, "{letter} would have to stand at {position_deg:.3} degrees, outside its range")
            }
        }
    }
}

impl core::error::Error for Unreachable {}
