//! Singularities: fast turns and incoherent movement (Tournier's term) near a pole, and their repair.
//!
//! In the plane across the first rotary axis (for an A/C table the plane of (i, j)) a direction has a radius (its
//! angle from the pole) and an azimuth, and the first axis follows the azimuth alone. If a path passes the pole at a
//! small radius, that axis turns very fast although the tool hardly turns. With dpsi the angle between the directions
//! of two points,
//!
//! ```text
//! gain = |dq0| / dpsi,    fast where it is above a limit                                        (1)
//! ```
//!
//! A fast turn alone is not incoherent: on a straight path past the pole the azimuth changes fast and evenly. The movement is *incoherent* if the first axis
//! also turns back, over the interval and one move on either side by
//!
//! ```text
//! reversal = sum |dq0| - |sum dq0|  > 1 degree                                                  (2)
//! ```
//!
//! By (2) the source's strategy 2 is incoherent and its strategies 1, 3 and 4 are not, as it states. It also names a cone about the pole, from the
//! resolution and the precision of the axes, that should not be crossed: an interval with a point within the precision is reported, too. The precision is
//! assumed, as no source prints it.
//!
//! Repair: the directions within such an interval move on their circles about the pole, so that the second axis keeps
//! its positions. Their azimuths change uniformly with dpsi, from that of the last coherent point to that of the next.
//! If these two azimuths differ by more than a quarter turn, the path goes through the pole: beyond it the azimuth is
//! the opposite one, and the second axis changes its sign while the first continues. The interval is widened until the
//! gain (1) is below the limit.
//!
//! A ball end mill keeps its contact if its centre does not move, so its tip moves by r (t - t'). For any other tool a
//! change of direction changes the surface: beyond a tolerance the repair is rejected.
//!
//! Source: Tournier, 4.1.2 (the circle, and the restriction to ball end mills). The circle's radius is hypot(i, j)
//! itself; the source's sqrt(1 - k^2) is 5 % off at its printed digits. The widening and the uniform azimuth are ours.

use alloc::vec::Vec;

use super::forward::ToolPose;
use super::machine::Machine;
use super::vector::{HALF_TURN_DEG, Vector, angle_deg, cross, difference, dot, scaled, sum, turned, unit, wrapped_deg};

/// Precision of rotary axes about a pole. Assumed.
const PRECISION_DEG: f64 = 0.25;
/// Rotations of the first axis below this are ignored.
const TURN_MIN_DEG: f64 = 1.0;
/// A quarter turn.
const QUARTER_DEG: f64 = 90.0;

/// Shape of the tool's cutting end: it decides whether a change of the tool's direction changes the cut surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToolEnd {
    /// A ball end mill: the surface stays if the centre of the ball does.
    Ball {
        /// Radius of the ball.
        radius_mm: f64,
    },
    /// Any other shape: a change of direction changes the surface.
    Other,
}

/// Limits for finding and repairing singularities (places of a path near the direction of the first rotary axis).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepairLimits {
    /// Largest ratio of the first axis' rotation to the tool's that does not count as a fast turn: degrees per degree.
    /// (1)
    pub gain_ratio: f64,
    /// Largest angle between the tool axis and the shortest rotation between two points' directions; a move with a
    /// larger angle is a change between the solutions of the rotary axes, which is not repaired here.
    pub departure_deg: f64,
    /// Largest change of direction that a repair may make if the tool is not a ball end mill.
    pub error_deg: f64,
}

impl Default for RepairLimits {
    /// Gain ratio of 10, departure of 0.5 degrees, change of direction of 0.01 degrees.
    fn default() -> Self {
        RepairLimits { gain_ratio: 10.0, departure_deg: 0.5, error_deg: 0.01 }
    }
}

/// Interval of a path beside a pole (the direction of the first rotary axis) in which that axis turns fast, or turns
/// forth and back (incoherent movement).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Singularity {
    /// Index of the last point before the interval.
    pub before: usize,
    /// Index of the first point after it.
    pub after: usize,
    /// Largest ratio of the first axis' rotation to the tool's on a move of the interval. (1)
    pub gain_ratio: f64,
    /// Angle by which the first axis turns forth and back again in the interval: the sum of its rotations minus the
    /// resulting one. (2)
    pub reversal_deg: f64,
    /// Smallest angle between the direction of one of its points and the pole; points whose angle the axes cannot
    /// resolve do not count.
    pub from_pole_deg: f64,
    /// Largest change of direction that its repair makes or would make.
    pub error_deg: f64,
    /// Whether the interval was repaired.
    pub outcome: RepairOutcome,
}

/// Result of repairing the path at a singularity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RepairOutcome {
    /// The directions within the interval were changed so that the first axis turns evenly.
    Repaired,
    /// Nothing was changed: the tool is not a ball end mill, and the change of direction would exceed the limit.
    Refused,
    /// Nothing was changed: the path begins or ends within the interval, or no point of the path lies within it.
    NoRoom,
}

impl Singularity {
    /// Whether the first axis turns back in the interval by more than a degree, instead of only turning fast. (2)
    pub fn is_incoherent(&self) -> bool {
        self.reversal_deg > TURN_MIN_DEG
    }

    /// Whether the movement is incoherent (the first axis turns back), or passes the pole at a smaller angle than the
    /// assumed precision of the axes.
    pub fn is_fault(&self) -> bool {
        self.is_incoherent() || self.from_pole_deg < PRECISION_DEG
    }
}

impl Machine {
    /// Finds the intervals beside a pole (the direction of the first rotary axis) in which the rotary axes turn fast,
    /// and changes the directions of the poses in them. The positions of the rotary axes have to be computed anew
    /// afterwards.
    pub fn repair(
        &self,
        poses: &mut [ToolPose],
        rotary_deg: &[[f64; 2]],
        end: ToolEnd,
        limits: &RepairLimits,
    ) -> Vec<Singularity> {
        let mut found = Vec::new();
        let mut from = 0;
        while let Some((before, after, gain_ratio)) = self.stretch(poses, rotary_deg, from, limits) {
            let corrected = self.corrected(poses, [before, after], from, limits.gain_ratio);
            let reversal_deg = reversal_deg(rotary_deg, [before, after]);
            let outside = poses.get(before..=after).unwrap_or_default().iter();
            let outside = outside.map(|pose| pose.axis).filter(|axis| !self.is_in_pole_cone(*axis));
            let from_pole_deg = outside.map(|axis| self.from_pole_deg(axis)).fold(f64::INFINITY, f64::min);
            let outcome = RepairOutcome::NoRoom;
            let stretch =
                Singularity { before, after, gain_ratio, reversal_deg, from_pole_deg, error_deg: 0.0, outcome };
            found.push(
                corrected
                    .map_or(stretch, |(before, directions)| apply(poses, before, &directions, (stretch, end, limits))),
            );
            from = found.last().map_or(after, |stretch| stretch.after);
        }
        found
    }

    /// The next interval after a point: its ends and its largest gain.
    fn stretch(
        &self,
        poses: &[ToolPose],
        rotary_deg: &[[f64; 2]],
        from: usize,
        limits: &RepairLimits,
    ) -> Option<(usize, usize, f64)> {
        let gains = poses.windows(2).zip(rotary_deg.windows(2)).enumerate().skip(from);
        let mut stretch: Option<(usize, usize, f64)> = None;
        for (index, (poses, places)) in gains {
            let gain = match (poses, places) {
                ([start, end], [from, to]) => self.gain([start.axis, end.axis], [*from, *to], limits.departure_deg),
                _ => 0.0,
            };
            match &mut stretch {
                None if gain > limits.gain_ratio => stretch = Some((index, index + 1, gain)),
                Some((_, after, greatest)) if gain > limits.gain_ratio => {
                    (*after, *greatest) = (index + 1, greatest.max(gain))
                }
                Some(_) => break,
                None => {}
            }
        }
        stretch
    }

    /// Gain of a move; 0 for small rotations and for swings. (1)
    fn gain(&self, directions: [Vector; 2], places: [[f64; 2]; 2], departure_deg: f64) -> f64 {
        let [from, to] = places;
        let turned = libm::fabs(to[0] - from[0]);
        if turned < TURN_MIN_DEG || self.axis_departure_deg(from, to, directions) > departure_deg {
            return 0.0;
        }
        turned / angle_deg(directions[0], directions[1])
    }

    /// New directions for the points within an interval, and the point before the first. The interval is widened until
    /// they are coherent, but not beyond `floor`.
    fn corrected(
        &self,
        poses: &[ToolPose],
        ends: [usize; 2],
        floor: usize,
        gain_ratio: f64,
    ) -> Option<(usize, Vec<Vector>)> {
        let [mut before, mut after] = ends;
        loop {
            if after > before + 1
                && let Some(directions) = self.with_uniform_azimuth(poses.get(before..=after)?, gain_ratio)
            {
                return Some((before, directions));
            }
            before = before.checked_sub(1).filter(|before| *before >= floor)?;
            after = (after + 1 < poses.len()).then_some(after + 1)?;
        }
    }

    /// The directions between the first and the last of `poses` with a uniformly changing azimuth; `None` if their
    /// gain is still too large.
    fn with_uniform_azimuth(&self, poses: &[ToolPose], gain_ratio: f64) -> Option<Vec<Vector>> {
        let [axis, _] = self.rotary().map(|axis| axis.direction);
        let (first, last) = (poses.first()?.axis, poses.last()?.axis);
        let start = self.azimuth_deg(first)?;
        let whole = folded_deg(self.azimuth_deg(last)? - start);
        let steps: Vec<f64> =
            poses.windows(2).map(|pair| if let [a, b] = pair { angle_deg(a.axis, b.axis) } else { 0.0 }).collect();
        let way: f64 = steps.iter().sum();
        if libm::fabs(whole) > gain_ratio * way {
            return None;
        }
        let mut gone = 0.0;
        let mut directions = Vec::with_capacity(poses.len());
        for (pose, step) in poses.iter().skip(1).zip(&steps).take(poses.len() - 2) {
            gone += step;
            let wanted = start + whole * gone / way;
            // In the pole itself the azimuth is undefined.
            let by_deg = self.azimuth_deg(pose.axis).map_or(0.0, |own| folded_deg(wanted - own));
            directions.push(turned(pose.axis, axis, by_deg));
        }
        Some(directions)
    }

    /// Angle of a direction about the first axis; `None` in a pole's cone.
    fn azimuth_deg(&self, direction: Vector) -> Option<f64> {
        if self.is_in_pole_cone(direction) {
            return None;
        }
        let [about, second] = self.rotary().map(|axis| axis.direction);
        let x = unit(cross(about, second))?;
        Some(libm::atan2(dot(cross(about, x), direction), dot(x, direction)).to_degrees())
    }
}

/// Angle by which the first axis turns there and back again, from the point before an interval to the one after it. (2)
fn reversal_deg(rotary_deg: &[[f64; 2]], [before, after]: [usize; 2]) -> f64 {
    let moves = rotary_deg.windows(2).enumerate().skip(before.saturating_sub(1)).take_while(|(at, _)| *at <= after);
    let turns = moves.map(|(_, pair)| if let [[from, _], [to, _]] = pair { to - from } else { 0.0 });
    let (whole, net) = turns.fold((0.0, 0.0), |(whole, net), turn| (whole + libm::fabs(turn), net + turn));
    whole - libm::fabs(net)
}

/// Folds an angle by half turns into (-90, 90]: the same line through the pole.
fn folded_deg(angle_deg: f64) -> f64 {
    let wrapped = wrapped_deg(angle_deg);
    if wrapped > QUARTER_DEG {
        wrapped - HALF_TURN_DEG
    } else if wrapped <= -QUARTER_DEG {
        wrapped + HALF_TURN_DEG
    } else {
        wrapped
    }
}

/// Sets the new directions of the points after `before` if the tool allows it.
fn apply(
    poses: &mut [ToolPose],
    before: usize,
    directions: &[Vector],
    (stretch, end, limits): (Singularity, ToolEnd, &RepairLimits),
) -> Singularity {
    let within = || before + 1..before + 1 + directions.len();
    let old = poses.get(within()).unwrap_or_default();
    let error_deg = old.iter().zip(directions).map(|(pose, new)| angle_deg(pose.axis, *new)).fold(0.0, f64::max);
    let after = before + directions.len() + 1;
    let stretch = Singularity { before, after, error_deg, ..stretch };
    if end == ToolEnd::Other && error_deg > limits.error_deg {
        return Singularity { outcome: RepairOutcome::Refused, ..stretch };
    }
    for (pose, new) in poses.get_mut(within()).unwrap_or_default().iter_mut().zip(directions) {
        if let ToolEnd::Ball { radius_mm } = end {
            pose.tip_mm = sum(pose.tip_mm, scaled(difference(pose.axis, *new), radius_mm));
        }
        pose.axis = *new;
    }
    Singularity { outcome: RepairOutcome::Repaired, ..stretch }
}
