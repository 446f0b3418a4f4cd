//! Branch selection: positions of the rotary axes over a whole path, with the least travel within their ranges.
//!
//! Each point of the path has up to two branches, each with as many whole turns as the range of its axes allows.
//! Dynamic programming finds the shortest sequence of positions through all points. Its length is the sum of the
//! angles by which both axes turn:
//!
//! ```text
//! cost of a move = |q0' - q0| + |q1' - q1|,   of an axis without end the shorter way round        (1)
//! ```
//!
//! In a pole's cone the first axis is free and keeps its position, which by the triangle inequality costs no more than
//! any other. A path that begins in the cone begins at the position that the first point outside the cone needs. Of
//! equal costs, the smaller angles are selected.
//!
//! The start of a path may be given: positions before its first point, or the side of the pole on which its second axis stands at the first point outside
//! of the cones. The latter is a choice of branch: for an A/C table the sign of A.
//!
//! Source: Tournier, 2 (selection of a solution as an optimisation); the search is Bellman's.

use alloc::vec::Vec;
use core::fmt;

use super::forward::ToolPose;
use super::inverse::{Angles, Unreachable};
use super::machine::{Machine, RotaryAxis, TURNS_MAX};
use super::vector::{TURN_DEG, wrapped_deg};

/// Tolerance for the comparison of two costs.
const SAME_DEG: f64 = 1e-9;

/// Point of a path that the machine cannot reach, and the reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnreachablePoint {
    /// Index of the point in the path, from 0.
    pub point: usize,
    /// Reason why it cannot be reached.
    pub why: Unreachable,
}

/// Condition on the rotary axes at the start of a path: their positions, or which of their two solutions the path
/// begins on. Without either, the positions with the least travel are selected.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathStart {
    /// Positions of the rotary axes before the first point; the travel from them to that point counts.
    pub rotary_deg: Option<[f64; 2]>,
    /// Required solution at the first point whose direction is not too near to a pole (the direction of the first
    /// rotary axis) for the axes to resolve.
    pub branch: Option<Branch>,
}

/// One of the two solutions of the rotary axes for a direction, named by the position of the second axis relative to
/// the position at which the tool lies along the first axis (the pole).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// The second axis stands at a larger angle than at the pole.
    Positive,
    /// The second axis stands at a smaller angle than at the pole.
    Negative,
}

impl From<Option<[f64; 2]>> for PathStart {
    fn from(rotary_deg: Option<[f64; 2]>) -> Self {
        PathStart { rotary_deg, branch: None }
    }
}

/// Positions for a point, with the least cost to reach them.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    rotary_deg: [f64; 2],
    cost: f64,
    from: usize,
}

impl Machine {
    /// Positions of the rotary axes at each point of a path, with the least sum of the axes' rotations from its start.
    /// Endless axes count on over whole turns, so that each difference is the rotation of the move.
    ///
    /// # Errors
    /// The first point that cannot be reached, or cannot on the branch that `start` requires.
    pub fn select_branches(
        &self,
        poses: &[ToolPose],
        start: impl Into<PathStart>,
    ) -> Result<Vec<[f64; 2]>, UnreachablePoint> {
        let start: PathStart = start.into();
        let start_deg = start.rotary_deg;
        let mut layers: Vec<Vec<Candidate>> = Vec::with_capacity(poses.len());
        for (point, places) in self.places(poses, &start)?.into_iter().enumerate() {
            let arrive = |rotary_deg: [f64; 2]| match layers.last() {
                Some(before) => self.arrival(before, rotary_deg),
                None => {
                    let cost = start_deg.map_or(0.0, |start| self.travel_deg(start, rotary_deg));
                    Some(Candidate { rotary_deg, cost, from: 0 })
                }
            };
            let layer: Vec<Candidate> = places.into_iter().filter_map(arrive).collect();
            if layer.is_empty() {
                return Err(UnreachablePoint { point, why: Unreachable::Direction });
            }
            layers.push(layer);
        }
        Ok(self.unwrapped(backtrack(&layers), start_deg))
    }

    /// Sum of the angles by which both rotary axes turn between two positions, degrees; endless axes turn the shorter
    /// way. (1)
    pub fn travel_deg(&self, from_deg: [f64; 2], to_deg: [f64; 2]) -> f64 {
        let [first, second] = self.rotary();
        let turned = |axis: &RotaryAxis, from: f64, to: f64| match axis.range_deg {
            Some(_) => libm::fabs(to - from),
            None => libm::fabs(wrapped_deg(to - from)),
        };
        turned(first, from_deg[0], to_deg[0]) + turned(second, from_deg[1], to_deg[1])
    }

    /// Possible positions of the axes at each point.
    fn places(&self, poses: &[ToolPose], start: &PathStart) -> Result<Vec<Vec<[f64; 2]>>, UnreachablePoint> {
        let mut places: Vec<Vec<[f64; 2]>> = Vec::with_capacity(poses.len());
        let mut branch = start.branch;
        for (point, pose) in poses.iter().enumerate() {
            let found = if self.is_in_pole_cone(pose.axis) {
                let firsts = match (places.last(), start.rotary_deg) {
                    (Some(before), _) => before.iter().map(|place| place[0]).collect(),
                    (None, Some(start)) => alloc::vec![self.free_first(start[0])],
                    (None, None) => self.firsts_ahead(poses, start.branch),
                };
                self.pole_places(pose, firsts)
            } else {
                self.turns_on(pose, branch.take())
            };
            places.push(found.map_err(|why| UnreachablePoint { point, why })?);
        }
        Ok(places)
    }

    /// All positions for a point outside the poles' cones, the smallest angles first.
    fn turns(&self, pose: &ToolPose) -> Result<Vec<[f64; 2]>, Unreachable> {
        let [first, second] = self.rotary();
        let angles = self.angles(pose.axis);
        let branches: &[[f64; 2]] = match &angles {
            Angles::None | Angles::Any { .. } => return Err(Unreachable::Direction),
            Angles::One(only) => &[*only],
            Angles::Two(both) => &both[..],
        };
        let mut places = Vec::new();
        for branch in branches {
            for first_deg in turns_of(first, branch[0]) {
                places.extend(turns_of(second, branch[1]).map(|second_deg| [first_deg, second_deg]));
            }
        }
        match branches.first() {
            Some(branch) if places.is_empty() => {
                Err(self.in_range(*branch, [0.0; 2]).err().unwrap_or(Unreachable::Direction))
            }
            _ => {
                let size = |place: &[f64; 2]| libm::fabs(place[0]) + libm::fabs(place[1]);
                places.sort_by(|a, b| size(a).total_cmp(&size(b)));
                Ok(places)
            }
        }
    }

    /// Positions for a point outside the poles' cones, on one branch if it is given.
    fn turns_on(&self, pose: &ToolPose, branch: Option<Branch>) -> Result<Vec<[f64; 2]>, Unreachable> {
        let mut places = self.turns(pose)?;
        let Some(branch) = branch else { return Ok(places) };
        let at_pole_deg = match self.angles(self.nearest_pole(pose.axis)) {
            Angles::Any { second_deg } => second_deg,
            _ => 0.0,
        };
        let side = |place: &[f64; 2]| {
            let beyond = wrapped_deg(place[1] - at_pole_deg) > 0.0;
            if beyond { Branch::Positive } else { Branch::Negative }
        };
        let position_deg = places.first().map_or(0.0, |place| wrapped_deg(2.0 * at_pole_deg - place[1]));
        places.retain(|place| side(place) == branch);
        let [_, second] = self.rotary();
        let out = Unreachable::Range { letter: second.letter, position_deg };
        if places.is_empty() { Err(out) } else { Ok(places) }
    }

    /// All positions for a point in a pole's cone with the first axis at one of `firsts`.
    fn pole_places(&self, pose: &ToolPose, mut firsts: Vec<f64>) -> Result<Vec<[f64; 2]>, Unreachable> {
        let [_, second] = self.rotary();
        let Angles::Any { second_deg } = self.angles(self.nearest_pole(pose.axis)) else {
            return Err(Unreachable::Direction);
        };
        firsts.sort_unstable_by(f64::total_cmp);
        firsts.dedup();
        let mut places = Vec::new();
        for first_deg in firsts {
            places.extend(turns_of(second, second_deg).map(|second_deg| [first_deg, second_deg]));
        }
        let out = Unreachable::Range { letter: second.letter, position_deg: second_deg };
        if places.is_empty() { Err(out) } else { Ok(places) }
    }

    /// Positions of the first axis that the first point outside the poles' cones needs.
    fn firsts_ahead(&self, poses: &[ToolPose], branch: Option<Branch>) -> Vec<f64> {
        let outside = poses.iter().find(|pose| !self.is_in_pole_cone(pose.axis));
        let ahead = outside.and_then(|pose| self.turns_on(pose, branch).ok());
        let firsts: Vec<f64> = ahead.into_iter().flatten().map(|place| place[0]).collect();
        if firsts.is_empty() { alloc::vec![self.free_first(0.0)] } else { firsts }
    }

    /// The cheapest transition from the candidates of the previous point.
    fn arrival(&self, before: &[Candidate], rotary_deg: [f64; 2]) -> Option<Candidate> {
        let costs = before.iter().map(|candidate| candidate.cost + self.travel_deg(candidate.rotary_deg, rotary_deg));
        let (from, cost) = cheapest(costs)?;
        Some(Candidate { rotary_deg, cost, from })
    }

    /// Unwraps the positions of endless axes, so that each point is reached the shorter way from the previous one.
    fn unwrapped(&self, mut chosen: Vec<[f64; 2]>, start_deg: Option<[f64; 2]>) -> Vec<[f64; 2]> {
        let [first, second] = self.rotary();
        let mut before = start_deg;
        for place in &mut chosen {
            if let Some(before) = before {
                let follow = |axis: &RotaryAxis, at: f64, near: f64| match axis.range_deg {
                    Some(_) => at,
                    None => RotaryAxis::nearest_turn(at, near),
                };
                *place = [follow(first, place[0], before[0]), follow(second, place[1], before[1])];
            }
            before = Some(*place);
        }
        chosen
    }
}

/// Positions of an angle in the range of its axis; one position for an endless axis.
fn turns_of(axis: &RotaryAxis, angle_deg: f64) -> impl Iterator<Item = f64> {
    let lowest = axis.nearest_in_range(angle_deg, axis.range_deg.map_or(angle_deg, |[least, _]| least));
    let turns = if axis.range_deg.is_some() { TURNS_MAX + 1 } else { 1 };
    let positions = (0..turns).filter_map(move |turn| Some(lowest? + TURN_DEG * f64::from(turn)));
    let axis = *axis;
    positions.take_while(move |position| axis.allows(*position))
}

/// Traces the cheapest sequence back through the layers.
fn backtrack(layers: &[Vec<Candidate>]) -> Vec<[f64; 2]> {
    let ends = layers.last().and_then(|layer| cheapest(layer.iter().map(|candidate| candidate.cost)));
    let mut at = ends.map_or(0, |(at, _)| at);
    let mut chosen = Vec::with_capacity(layers.len());
    for candidate in layers.iter().rev().map_while(|layer| layer.get(at).copied().inspect(|found| at = found.from)) {
        chosen.push(candidate.rotary_deg);
    }
    chosen.reverse();
    chosen
}

/// The first of the smallest costs, with a tolerance for rounding.
fn cheapest(costs: impl Iterator<Item = f64>) -> Option<(usize, f64)> {
    costs.enumerate().reduce(|best, next| if next.1 < best.1 - SAME_DEG { next } else { best })
}

impl fmt::Display for UnreachablePoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "point {}: {}", self.point + 1, self.why)
    }
}

impl core::error::Error for UnreachablePoint {}
