//! Direction of a tool on its move, and the angles of the laws counted from it.

use std::f64::consts::TAU;

use arcfeed_control::drives::limits::AXES;
use arcfeed_kinematics::vector::{difference, length};
use arcfeed_model::tool::Edge;
use arcfeed_nc::modal::Plane;
use arcfeed_nc::segment::Segment;
use arcfeed_units::Nm;
use nalgebra::Vector2;

/// Angles in front of the circle, from one side to the other.
pub(super) const AHEAD_DEG: [f64; 2] = [0.0, 180.0];
const TURN_DEG: f64 = 360.0;

/// Direction of a tool on its move.
pub(super) struct Heading {
    /// Path along the move.
    pub travelled_mm: f64,
    /// Unit vector from which the angles of the laws are counted: towards an arc's centre, or to the left of a line.
    pub towards: Vector2<f64>,
    /// Unit vector of the motion.
    pub motion: Vector2<f64>,
}

/// Interval from the lower beginning to the higher end.
pub(super) fn hull([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a.min(c), b.max(d)]
}

impl Heading {
    /// Direction of the tool; `None` if a move has no direction in the plane of the layers.
    pub fn of(segment: &Segment, axes: &[f64; AXES]) -> Option<Self> {
        let [x, y, _] = segment.start.linear.map(Nm::to_mm);
        let Some(arc) = segment.arc() else {
            let way = difference(segment.end.linear.map(Nm::to_mm), segment.start.linear.map(Nm::to_mm));
            let from = difference([axes[0], axes[1], axes[2]], segment.start.linear.map(Nm::to_mm));
            let travelled_mm = (0..3).map(|axis| from[axis] * way[axis]).sum::<f64>() / length(way);
            let motion = Vector2::new(way[0], way[1]).try_normalize(1e-9)?;
            return Some(Heading { travelled_mm, towards: Vector2::new(-motion.y, motion.x), motion });
        };
        if arc.plane != Plane::Xy {
            return None;
        }
        let [center_x, center_y] = arc.center.map(Nm::to_mm);
        let (begin, turn) = (Vector2::new(x - center_x, y - center_y), f64::from(arc.turn.sign()));
        let arm = Vector2::new(axes[0] - center_x, axes[1] - center_y).try_normalize(1e-9)?;
        let turned_rad = turn * libm::atan2(begin.perp(&arm), begin.dot(&arm));
        // Either a little before the start, or far along a long arc: the nearer one counts.
        let is_far = turned_rad < 0.0 && arc.sweep_rad() > TAU + 2.0 * turned_rad;
        let turned_rad = if is_far { turned_rad + TAU } else { turned_rad };
        Some(Heading {
            travelled_mm: arc.radius_mm() * turned_rad,
            towards: -arm,
            motion: Vector2::new(-arm.y, arm.x) * turn,
        })
    }

    /// Part of an arc (counter-clockwise, radians) in front of a circle, in the angles of the laws.
    pub fn in_front_deg(&self, side: Edge, arc_rad: &[f64; 2]) -> Option<[f64; 2]> {
        let advance = self.motion * f64::from(side.advance());
        let base_rad = libm::atan2(self.towards.y, self.towards.x);
        let [from_deg, to_deg] = arc_rad.map(|end_rad| (end_rad - base_rad).to_degrees());
        let [from_deg, to_deg] =
            if self.towards.perp(&advance) > 0.0 { [from_deg, to_deg] } else { [-to_deg, -from_deg] };
        let part = |turns: i8| {
            let [from_deg, to_deg] = [from_deg, to_deg].map(|deg| deg + TURN_DEG * f64::from(turns));
            let part = [from_deg.max(AHEAD_DEG[0]), to_deg.min(AHEAD_DEG[1])];
            (part[0] < part[1]).then_some(part)
        };
        (-2..=2).filter_map(part).reduce(hull)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heading(towards_deg: f64, turn: f64) -> Heading {
        let (sin, cos) = libm::sincos(towards_deg.to_radians());
        let towards = Vector2::new(cos, sin);
        Heading { travelled_mm: 0.0, towards, motion: Vector2::new(towards.y, -towards.x) * turn }
    }

    #[test]
    fn angles_are_counted_from_the_centre_to_where_the_edges_advance() {
        let arc = |from: f64, to: f64| [from.to_radians(), to.to_radians()];
        // Counter-clockwise about a centre to the left of the motion: straight ahead is clockwise of it.
        let ccw = heading(120.0, 1.0);
        for (side, [from, to], expected) in [
            (Edge::Outer, [80.0, 100.0], Some([20.0, 40.0])),
            (Edge::Inner, [140.0, 160.0], Some([20.0, 40.0])),
            (Edge::Outer, [130.0, 290.0], None),
            (Edge::Outer, [100.0, 460.0], Some([0.0, 180.0])),
            (Edge::Outer, [110.0, 130.0], Some([0.0, 10.0])),
            (Edge::Outer, [290.0, 320.0], Some([160.0, 180.0])),
        ] {
            let found = ccw.in_front_deg(side, &arc(from, to));
            let is_it = match (found, expected) {
                (Some(found), Some(expected)) => found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9),
                (None, None) => true,
                _ => false,
            };
            assert!(is_it, "{side:?} {from} {to}: {found:?}");
        }
        let mirrored = heading(120.0, -1.0).in_front_deg(Edge::Outer, &arc(140.0, 160.0)).expect("in front");
        assert!((mirrored[0] - 20.0).abs() < 1e-9 && (mirrored[1] - 40.0).abs() < 1e-9, "{mirrored:?}");
    }
}
