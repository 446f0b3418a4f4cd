//! Direction of a tool on its move, and the angles of the laws counted from it.

use std::f64::consts::{PI, TAU};

use arcfeed_control::drives::limits::AXES;
use arcfeed_kinematics::vector::{difference, length};
use arcfeed_model::tool::Edge;
use arcfeed_nc::modal::Plane;
use arcfeed_nc::segment::Segment;
use arcfeed_units::Nm;
use nalgebra::Vector2;

/// Angles in front of the circle, from one side to the other.
pub(super) const AHEAD_DEG: [f64; 2] = [0.0, 180.0];

/// Direction of a tool on its move.
pub(super) struct Heading {
    /// Path along the move.
    pub travelled_mm: f64,
    /// Unit vector from which the angles of the laws are counted: towards an arc's centre, or to the left of a line.
    pub towards: Vector2<f64>,
    /// Unit vector of the motion.
    pub motion: Vector2<f64>,
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

    /// Directions in front of a circle: half a turn, counter-clockwise, radians.
    pub fn front_rad(&self, side: Edge) -> [f64; 2] {
        let base_rad = libm::atan2(self.towards.y, self.towards.x);
        if self.is_left_in_front(side) { [base_rad, base_rad + PI] } else { [base_rad - PI, base_rad] }
    }

    /// Part of an arc in front of a circle, in the angles of the laws. The arc is counted as [`Heading::front_rad`] is, and may reach
    /// beyond it.
    pub fn in_front_deg(&self, side: Edge, arc_rad: &[f64; 2]) -> Option<[f64; 2]> {
        let [front_from, front_to] = self.front_rad(side);
        let [from_deg, to_deg] = match self.is_left_in_front(side) {
            true => arc_rad.map(|end_rad| (end_rad - front_from).to_degrees()),
            false => [arc_rad[1], arc_rad[0]].map(|end_rad| (front_to - end_rad).to_degrees()),
        };
        let part = [from_deg.max(AHEAD_DEG[0]), to_deg.min(AHEAD_DEG[1])];
        (part[0] < part[1]).then_some(part)
    }

    /// Whether the edges of a circle advance where directions are to the left of `towards`.
    fn is_left_in_front(&self, side: Edge) -> bool {
        self.towards.perp(&(self.motion * f64::from(side.advance()))) > 0.0
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
        let near = |found: [f64; 2], expected: [f64; 2]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9);
        // Counter-clockwise about a centre to the left of the motion: straight ahead is clockwise of it.
        let ccw = heading(120.0, 1.0);
        for (side, [from, to], expected) in [
            (Edge::Outer, [80.0, 100.0], Some([20.0, 40.0])),
            (Edge::Inner, [140.0, 160.0], Some([20.0, 40.0])),
            (Edge::Outer, [130.0, 290.0], None),
            (Edge::Outer, [-100.0, 260.0], Some([0.0, 180.0])),
            (Edge::Outer, [110.0, 130.0], Some([0.0, 10.0])),
            (Edge::Outer, [-70.0, -40.0], Some([160.0, 180.0])),
        ] {
            let found = ccw.in_front_deg(side, &arc(from, to));
            let is_it = match (found, expected) {
                (Some(found), Some(expected)) => near(found, expected),
                (None, None) => true,
                _ => false,
            };
            assert!(is_it, "{side:?} {from} {to}: {found:?}");
        }
        assert!(
            near(ccw.front_rad(Edge::Outer), arc(-60.0, 120.0)) && near(ccw.front_rad(Edge::Inner), arc(120.0, 300.0))
        );
        let mirrored = heading(120.0, -1.0).in_front_deg(Edge::Outer, &arc(140.0, 160.0)).expect("in front");
        assert!((mirrored[0] - 20.0).abs() < 1e-9 && (mirrored[1] - 40.0).abs() < 1e-9, "{mirrored:?}");
    }
}
