//! Segments as paths: length, position and direction at a distance along them.
//!
//! The radius of an arc changes linearly from its start's to its end's, so that the arc ends exactly where the program
//! says, as on a control whose end points are rounded to the last digit. A helix moves evenly across the arc's plane;
//! its feed counts along the arc in the plane (HTG = 0), so the tool runs faster than F by the ratio of path to arc.

use arcfeed_nc::modal::{Feed, PER_MIN_SCALE, Pose};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::{MICRODEG_PER_DEG, MicroDeg, Nm, S_PER_MIN};
use nalgebra::Vector3;

use crate::drives::limits::{AXES, Bend};

const DEG: f64 = MICRODEG_PER_DEG as f64;

/// Segment (one move) prepared for execution: position and derivatives as functions of the distance along its path.
#[derive(Clone, Debug)]
pub struct Travel {
    /// The segment.
    pub segment: Segment,
    /// Length of the path: of the linear axes in mm, or of the rotary ones in degrees if only they move.
    pub length_mm: f64,
    /// Factor from the feed to the speed along the path: above 1 on a helix, whose feed counts in the plane of its arc.
    pub speed_ratio: f64,
    /// Programmed speed along the path, mm/s; `None` for rapids.
    pub programmed_mm_per_s: Option<f64>,
    shape: Shape,
}

#[derive(Clone, Debug)]
enum Shape {
    Straight { start: Vector3<f64>, end: Vector3<f64> },
    Circular { start: Vector3<f64>, center: [f64; 2], axes: [usize; 3], angle: [f64; 2], radius: [f64; 2], rise: f64 },
}

impl Travel {
    /// Prepares a segment.
    pub fn new(segment: Segment) -> Self {
        let start = to_mm(&segment.start);
        let end = to_mm(&segment.end);
        let shape = match &segment.path {
            Path::Rapid | Path::Line => Shape::Straight { start, end },
            Path::Arc(arc) => circular(start, arc, segment.rise().to_mm()),
        };
        let (linear_mm, feed_length_mm) = (segment.length_mm(), segment.feed_length_mm());
        let length_mm = if linear_mm > 0.0 { linear_mm } else { rotary_deg(&segment) };
        let speed_ratio = if feed_length_mm > 0.0 { linear_mm / feed_length_mm } else { 1.0 };
        let programmed_mm_per_s = match (&segment.path, segment.feed) {
            (Path::Rapid, _) | (_, Feed::Missing) => None,
            (_, Feed::PerMinute(feed)) => Some(feed.to_mm() * speed_ratio / S_PER_MIN),
            (_, Feed::InverseTime(per_min)) => Some(length_mm * per_min as f64 / PER_MIN_SCALE as f64 / S_PER_MIN),
        };
        Travel { segment, length_mm, speed_ratio, programmed_mm_per_s, shape }
    }

    /// Position of the axes at `ratio` (0 to 1) of the path, in whole nanometres and microdegrees.
    pub fn pose_at(&self, ratio: f64) -> Pose {
        if ratio >= 1.0 { self.segment.end } else { to_pose(&self.axes_at(ratio)) }
    }

    /// Position, unrounded: X, Y, Z in mm, A, B, C in degrees.
    pub fn axes_at(&self, ratio: f64) -> [f64; AXES] {
        let point = match &self.shape {
            Shape::Straight { start, end } => start + (end - start) * ratio,
            Shape::Circular { start, center, axes, angle, radius, rise } => {
                let (sin, cos) = libm::sincos(angle[0] + angle[1] * ratio);
                let radius_mm = radius[0] + (radius[1] - radius[0]) * ratio;
                let mut point = *start;
                point[axes[0]] = center[0] + radius_mm * cos;
                point[axes[1]] = center[1] + radius_mm * sin;
                point[axes[2]] += rise * ratio;
                point
            }
        };
        let (from, to) = (self.segment.start.rotary, self.segment.end.rotary);
        let [a, b, c] = [0, 1, 2].map(|axis| from[axis].to_deg() + (to[axis].0 - from[axis].0) as f64 / DEG * ratio);
        [point[0], point[1], point[2], a, b, c]
    }

    /// First and second derivative of the positions of all axes by the path length, at `ratio` (0 to 1) of the path.
    pub fn derivatives_at(&self, ratio: f64) -> [[f64; AXES]; 2] {
        let (mut first, mut second) = ([0.0; AXES], [0.0; AXES]);
        match &self.shape {
            Shape::Straight { start, end } => {
                (0..3).for_each(|axis| first[axis] = (end[axis] - start[axis]) / self.length_mm);
            }
            Shape::Circular { axes, angle, radius, rise, .. } => {
                let (sin, cos) = libm::sincos(angle[0] + angle[1] * ratio);
                let (turn, drift) = (angle[1] / self.length_mm, (radius[1] - radius[0]) / self.length_mm);
                let radius_mm = radius[0] + (radius[1] - radius[0]) * ratio;
                let (across, inwards) = (radius_mm * turn, radius_mm * turn * turn);
                first[axes[0]] = drift * cos - across * sin;
                first[axes[1]] = drift * sin + across * cos;
                first[axes[2]] = rise / self.length_mm;
                second[axes[0]] = -2.0 * drift * turn * sin - inwards * cos;
                second[axes[1]] = 2.0 * drift * turn * cos - inwards * sin;
            }
        }
        first[3..].copy_from_slice(&self.turning());
        [first, second]
    }

    /// Bounds of the derivatives along the whole path, for each axis.
    pub fn bend(&self) -> Bend {
        let mut bend = Bend::default();
        match &self.shape {
            Shape::Straight { .. } => bend.first = self.derivatives_at(0.0)[0].map(f64::abs),
            Shape::Circular { axes, angle, radius, rise, .. } => {
                let turn = (angle[1] / self.length_mm).abs();
                let drift = ((radius[1] - radius[0]) / self.length_mm).abs();
                let radius_mm = radius[0].max(radius[1]);
                for axis in &axes[..2] {
                    bend.first[*axis] = radius_mm * turn + drift;
                    bend.second[*axis] = (radius_mm * turn + 2.0 * drift) * turn;
                    bend.third[*axis] = (radius_mm * turn + 3.0 * drift) * turn * turn;
                }
                bend.first[axes[2]] = (rise / self.length_mm).abs();
            }
        }
        bend.first[3..].copy_from_slice(&self.turning().map(f64::abs));
        bend
    }

    /// Whether only rotary axes move, so that the path length is in degrees.
    pub fn is_rotary(&self) -> bool {
        self.segment.length_mm() == 0.0
    }

    /// Turn of the rotary axes per unit of the path.
    fn turning(&self) -> [f64; 3] {
        let (from, to) = (self.segment.start.rotary, self.segment.end.rotary);
        [0, 1, 2].map(|axis| (to[axis].0 - from[axis].0) as f64 / DEG / self.length_mm)
    }

    /// Unit direction of motion of the linear axes at the start.
    pub fn direction_in(&self) -> Vector3<f64> {
        self.direction(0.0)
    }

    /// Unit direction of motion of the linear axes at the end.
    pub fn direction_out(&self) -> Vector3<f64> {
        self.direction(1.0)
    }

    fn direction(&self, ratio: f64) -> Vector3<f64> {
        match &self.shape {
            Shape::Straight { start, end } => (end - start).try_normalize(0.0).unwrap_or_default(),
            Shape::Circular { axes, angle, rise, .. } => {
                let (sin, cos) = libm::sincos(angle[0] + angle[1] * ratio);
                let in_plane = if angle[1] < 0.0 { -1.0 } else { 1.0 } / self.speed_ratio;
                let mut tangent = Vector3::zeros();
                tangent[axes[0]] = -in_plane * sin;
                tangent[axes[1]] = in_plane * cos;
                tangent[axes[2]] = rise / self.length_mm;
                tangent
            }
        }
    }
}

fn circular(start: Vector3<f64>, arc: &Arc, rise: f64) -> Shape {
    let (first, second, normal) = arc.plane.axes();
    let [x, y] = arc.from.map(Nm::to_mm);
    let [to_x, to_y] = arc.to.map(Nm::to_mm);
    Shape::Circular {
        start,
        center: arc.center.map(Nm::to_mm),
        axes: [first, second, normal],
        angle: [libm::atan2(y, x), f64::from(arc.turn.sign()) * arc.sweep_rad()],
        radius: [libm::hypot(x, y), libm::hypot(to_x, to_y)],
        rise,
    }
}

/// Position of the axes in whole nanometres and microdegrees.
pub fn to_pose(axes: &[f64; AXES]) -> Pose {
    let [x, y, z, a, b, c] = *axes;
    Pose { linear: [x, y, z].map(Nm::from_mm), rotary: [a, b, c].map(MicroDeg::from_deg) }
}

fn to_mm(pose: &Pose) -> Vector3<f64> {
    Vector3::from(pose.linear.map(Nm::to_mm))
}

fn rotary_deg(segment: &Segment) -> f64 {
    let (from, to) = (segment.start.rotary, segment.end.rotary);
    let swing = Vector3::from([0, 1, 2].map(|axis| to[axis].to_deg() - from[axis].to_deg()));
    swing.norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_nc::modal::{Plane, Turn};

    fn pose(x: f64, y: f64) -> Pose {
        Pose { linear: [Nm::from_mm(x), Nm::from_mm(y), Nm(0)], ..Pose::default() }
    }

    fn half_turn(turn: Turn) -> Travel {
        let offset = |x: f64| [Nm::from_mm(x), Nm(0)];
        let arc = Arc { plane: Plane::Xy, turn, center: [Nm(0); 2], from: offset(10.0), to: offset(-10.002) };
        Travel::new(Segment {
            sequence: None,
            start: pose(10.0, 0.0),
            end: pose(-10.002, 0.0),
            feed: Feed::PerMinute(Nm::from_mm(600.0)),
            path: Path::Arc(arc),
        })
    }

    #[test]
    fn an_arc_goes_round_the_side_its_sense_says_and_ends_where_programmed() {
        let [top, bottom] = [Turn::Ccw, Turn::Cw].map(half_turn);
        assert_eq!(top.pose_at(0.5).linear[1], Nm::from_mm(10.001));
        assert_eq!(bottom.pose_at(0.5).linear[1], Nm::from_mm(-10.001));
        assert_eq!(top.pose_at(1.0), pose(-10.002, 0.0));
        assert!((top.direction_in() - Vector3::y()).norm() < 1e-12);
        assert!((top.direction_out() + Vector3::y()).norm() < 1e-12);
    }

    /// A turn to the left and up by as much as it is long.
    fn helix(plane: Plane) -> Travel {
        let (first, second, normal) = plane.axes();
        let point = |along: f64, across: f64, up: f64| {
            let mut linear = [Nm(0); 3];
            for (axis, mm) in [(first, along), (second, across), (normal, up)] {
                linear[axis] = Nm::from_mm(mm);
            }
            Pose { linear, ..Pose::default() }
        };
        let offset = [Nm::from_mm(10.0), Nm(0)];
        let arc = Arc { plane, turn: Turn::Ccw, center: [Nm(0); 2], from: offset, to: offset };
        Travel::new(Segment {
            sequence: None,
            start: point(10.0, 0.0, 5.0),
            end: point(10.0, 0.0, 5.0 + 20.0 * core::f64::consts::PI),
            feed: Feed::PerMinute(Nm::from_mm(600.0)),
            path: Path::Arc(arc),
        })
    }

    #[test]
    fn a_helix_of_45_degrees_runs_faster_than_its_feed_by_the_root_of_two() {
        let root = libm::sqrt(2.0);
        for plane in [Plane::Xy, Plane::Zx, Plane::Yz] {
            let (travel, (first, second, normal)) = (helix(plane), plane.axes());
            assert!((travel.programmed_mm_per_s.unwrap() - 10.0 * root).abs() < 1e-8);
            let middle = travel.pose_at(0.5).linear.map(Nm::to_mm);
            assert!((middle[first] + 10.0).abs() < 1e-6 && middle[second].abs() < 1e-6);
            assert!((middle[normal] - 5.0 - 10.0 * core::f64::consts::PI).abs() < 1e-6);
            let mut tangent = Vector3::zeros();
            (tangent[second], tangent[normal]) = (1.0 / root, 1.0 / root);
            assert!((travel.direction_in() - tangent).norm() < 1e-8);
            assert!((travel.direction_out() - tangent).norm() < 1e-8);
        }
    }

    #[test]
    fn feed_per_minute_becomes_millimetres_per_second() {
        assert_eq!(half_turn(Turn::Cw).programmed_mm_per_s, Some(10.0));
    }

    #[test]
    fn inverse_time_takes_its_time_whatever_the_length() {
        let travel = Travel::new(Segment {
            sequence: None,
            start: pose(0.0, 0.0),
            end: pose(7.0, 0.0),
            feed: Feed::InverseTime(50 * PER_MIN_SCALE),
            path: Path::Line,
        });
        let time_s = travel.length_mm / travel.programmed_mm_per_s.unwrap();
        assert!((time_s - S_PER_MIN / 50.0).abs() < 1e-12);
    }
}
