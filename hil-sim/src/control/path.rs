//! Segments as paths: length, position and direction at a distance along them.
//!
//! An arc's radius runs linearly from its start's to its end's, so that it ends exactly where the program says, as a
//! control does with end points that are rounded to the last digit.

use arcfeed_shared::nc::modal::{Feed, PER_MIN_SCALE, Pose};
use arcfeed_shared::segment::{Arc, Path, Segment};
use arcfeed_shared::units::{MicroDeg, Nm, S_PER_MIN};
use nalgebra::Vector3;

/// A segment with what execution needs of it.
#[derive(Clone, Debug)]
pub struct Travel {
    /// The segment.
    pub segment: Segment,
    /// Length along which feed counts: of the linear axes, mm; of the rotary ones, degrees, where only they move.
    pub length_mm: f64,
    shape: Shape,
}

#[derive(Clone, Debug)]
enum Shape {
    Straight { start: Vector3<f64>, end: Vector3<f64> },
    Circular { start: Vector3<f64>, center: [f64; 2], axes: (usize, usize), angle: [f64; 2], radius: [f64; 2] },
}

impl Travel {
    /// Prepares a segment.
    pub fn new(segment: Segment) -> Self {
        let start = to_mm(&segment.start);
        let end = to_mm(&segment.end);
        let shape = match &segment.path {
            Path::Rapid | Path::Line => Shape::Straight { start, end },
            Path::Arc(arc) => circular(start, arc),
        };
        let linear_mm = segment.length_mm();
        let length_mm = if linear_mm > 0.0 { linear_mm } else { rotary_deg(&segment) };
        Travel { segment, length_mm, shape }
    }

    /// The programmed feed along the path, mm/s; `None` for rapids.
    pub fn feed_mm_per_s(&self) -> Option<f64> {
        match (&self.segment.path, self.segment.feed) {
            (Path::Rapid, _) | (_, Feed::Missing) => None,
            (_, Feed::PerMinute(feed)) => Some(feed.to_mm() / S_PER_MIN),
            (_, Feed::InverseTime(per_min)) => Some(self.length_mm * per_min as f64 / PER_MIN_SCALE as f64 / S_PER_MIN),
        }
    }

    /// Where the axes are at `ratio` (0 to 1) of the way.
    pub fn pose_at(&self, ratio: f64) -> Pose {
        if ratio >= 1.0 {
            return self.segment.end;
        }
        let point = match &self.shape {
            Shape::Straight { start, end } => start + (end - start) * ratio,
            Shape::Circular { start, center, axes, angle, radius } => {
                let (sin, cos) = libm::sincos(angle[0] + angle[1] * ratio);
                let radius_mm = radius[0] + (radius[1] - radius[0]) * ratio;
                let mut point = *start;
                point[axes.0] = center[0] + radius_mm * cos;
                point[axes.1] = center[1] + radius_mm * sin;
                point
            }
        };
        let (from, to) = (self.segment.start.rotary, self.segment.end.rotary);
        let turned = |axis: usize| {
            let swing = (to[axis].0 - from[axis].0) as f64;
            MicroDeg(from[axis].0 + libm::round(swing * ratio) as i64)
        };
        Pose { linear: [0, 1, 2].map(|axis| Nm::from_mm(point[axis])), rotary: [0, 1, 2].map(turned) }
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
            Shape::Circular { axes, angle, .. } => {
                let (sin, cos) = libm::sincos(angle[0] + angle[1] * ratio);
                let sense = if angle[1] < 0.0 { -1.0 } else { 1.0 };
                let mut tangent = Vector3::zeros();
                tangent[axes.0] = -sense * sin;
                tangent[axes.1] = sense * cos;
                tangent
            }
        }
    }
}

fn circular(start: Vector3<f64>, arc: &Arc) -> Shape {
    let (first, second, _) = arc.plane.axes();
    let [x, y] = arc.from.map(Nm::to_mm);
    let [to_x, to_y] = arc.to.map(Nm::to_mm);
    Shape::Circular {
        start,
        center: arc.center.map(Nm::to_mm),
        axes: (first, second),
        angle: [libm::atan2(y, x), f64::from(arc.turn.sign()) * arc.sweep_rad()],
        radius: [libm::hypot(x, y), libm::hypot(to_x, to_y)],
    }
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
    use arcfeed_shared::nc::modal::{Plane, Turn};

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

    #[test]
    fn feed_per_minute_becomes_millimetres_per_second() {
        assert_eq!(half_turn(Turn::Cw).feed_mm_per_s(), Some(10.0));
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
        let time_s = travel.length_mm / travel.feed_mm_per_s().unwrap();
        assert!((time_s - S_PER_MIN / 50.0).abs() < 1e-12);
    }
}
