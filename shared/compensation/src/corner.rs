//! Corners of a contour under cutter compensation: points of the tool centre between two moves, relative to the
//! programmed corner.
//!
//! With the unit tangents t1 and t2 before and behind the corner, the vectors n1 and n2 of the offset at a right angle
//! to them, and the offset r:
//!
//! ```text
//! inside:                           the intersection of the two offset paths, the one next to the corner
//! lines, inside; obtuse, outside:   (n1 + n2) / (1 + t1 t2)                    (1)
//! acute, outside:                   n1 + r t1, n2 - r t2                        (2)
//! ```
//!
//! Outside, the angle is that of the workpiece: obtuse from 90 degrees on. There an arc counts as its tangent, with a
//! line to (1) or (2) from the end of its offset path at n1, or from there to its start at n2. Source: B-62764EN,
//! 15.6.1 (angles), B-63664EN, 12.3 (intersections); the points outside are those of the figures in the manuals' section
//! on tool movement in offset mode.

use crate::element::{Branch, Circle};
use crate::vector::{Vector, cross, dot, length, minus, plus, scaled, to_left, unit};

/// Largest number of points of the tool centre at a corner.
pub const POINTS_MAX: usize = 4;
/// Distance along each axis, mm, up to which the later of two points is left out, because the control makes no move so
/// small (parameter 5010; one least increment).
pub const SMALL_MM: f64 = 1e-3;
/// Sine below which two directions are parallel.
const PARALLEL: f64 = 1e-9;

/// Points through which the tool centre goes at a corner, relative to the programmed corner: from the end of the
/// offset path before it to the start of the one after it.
pub type CornerPoints = heapless::Vec<Vector, POINTS_MAX>;

/// Whether the tool goes around the outside of the corner. A tangent joint and a reversal count as outside.
/// `offset_mm` is positive to the left.
pub fn is_outside(before: &Branch, behind: &Branch, offset_mm: f64) -> bool {
    let towards_tool = if offset_mm < 0.0 { -1.0 } else { 1.0 };
    cross(before.tangent, behind.tangent) * towards_tool <= PARALLEL
}

/// Points of the tool centre at a corner between two moves; `offset_mm` is positive to the left. `None` if the offset
/// paths inside the corner do not intersect.
pub fn corner(before: &Branch, behind: &Branch, offset_mm: f64) -> Option<CornerPoints> {
    let [first, second] = [before, behind].map(|branch| scaled(to_left(branch.tangent), offset_mm));
    let cosine = dot(before.tangent, behind.tangent);
    let meeting = scaled(plus(first, second), 1.0 / (1.0 + cosine)); // (1)
    if cosine > 0.0 && is_small(minus(second, first)) {
        return Some(one(meeting));
    }
    if !is_outside(before, behind, offset_mm) {
        return match (before.circle, behind.circle) {
            (None, None) => Some(one(meeting)),
            (Some(circle), None) => line_and_circle(second, behind.tangent, circle).map(one),
            (None, Some(circle)) => line_and_circle(first, before.tangent, circle).map(one),
            (Some(before), Some(behind)) => circles(before, behind).map(one),
        };
    }
    let reach = offset_mm.abs();
    let between = if cosine >= 0.0 {
        [meeting; 2]
    } else {
        [plus(first, scaled(before.tangent, reach)), minus(second, scaled(behind.tangent, reach))] // (2)
    };
    let mut points = CornerPoints::new();
    if before.circle.is_some() {
        add(&mut points, first);
    }
    between.into_iter().for_each(|point| add(&mut points, point));
    if behind.circle.is_some() {
        add(&mut points, second);
    }
    Some(points)
}

/// Corner at which the two offset paths meet in this single point.
pub fn one(point: Vector) -> CornerPoints {
    let mut points = CornerPoints::new();
    add(&mut points, point);
    points
}

fn add(points: &mut CornerPoints, point: Vector) {
    if points.last().is_none_or(|last| !is_small(minus(point, *last))) {
        let _full = points.push(point);
    }
}

/// Whether both components of a vector are so small that the control makes no move of it: up to [`SMALL_MM`].
pub fn is_small([x, y]: Vector) -> bool {
    x.abs() <= SMALL_MM && y.abs() <= SMALL_MM
}

/// Intersection of the line through `foot`, its point next to the corner, along `tangent`, with a circle.
fn line_and_circle(foot: Vector, tangent: Vector, circle: Circle) -> Option<Vector> {
    let from_center = minus(foot, circle.center);
    let (along, across) = (dot(from_center, tangent), cross(from_center, tangent));
    let half = root((circle.radius_mm - across) * (circle.radius_mm + across))?;
    let [a, b] = [half - along, -half - along];
    let nearest = if a.abs() <= b.abs() { a } else { b };
    Some(plus(foot, scaled(tangent, nearest)))
}

/// Intersection of two circles next to the corner.
fn circles(a: Circle, b: Circle) -> Option<Vector> {
    let way = minus(b.center, a.center);
    let distance = length(way);
    if distance == 0.0 {
        return None;
    }
    let squares = (a.radius_mm - b.radius_mm) * (a.radius_mm + b.radius_mm);
    let along = 0.5 * (distance + squares / distance);
    let half = root((a.radius_mm - along) * (a.radius_mm + along))?;
    let direction = unit(way);
    let middle = plus(a.center, scaled(direction, along));
    let sides = [half, -half].map(|half| plus(middle, scaled(to_left(direction), half)));
    let [left, right] = sides;
    Some(if length(left) <= length(right) { left } else { right })
}

/// Square root, `None` below zero.
fn root(square: f64) -> Option<f64> {
    (square >= 0.0).then(|| libm::sqrt(square))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(degrees: f64) -> Branch {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        Branch { tangent: [cos, sin], circle: None }
    }

    fn assert_near(points: &CornerPoints, wanted: &[Vector]) {
        assert_eq!(points.len(), wanted.len(), "{points:?}");
        for (point, wanted) in points.iter().zip(wanted) {
            assert!(length(minus(*point, *wanted)) < 1e-12, "{points:?}, not {wanted:?}");
        }
    }

    #[test]
    fn a_square_corner_has_one_point_inside_and_outside() {
        assert_near(&corner(&line(0.0), &line(90.0), 2.0).unwrap(), &[[-2.0, 2.0]]);
        assert_near(&corner(&line(0.0), &line(-90.0), 2.0).unwrap(), &[[2.0, 2.0]]);
        assert_near(&corner(&line(0.0), &line(90.0), -2.0).unwrap(), &[[2.0, -2.0]]);
    }

    #[test]
    fn an_acute_corner_outside_has_two_points_a_radius_beyond_the_ends() {
        let root = libm::sqrt(0.5);
        let (n2, t2) = ([root * 2.0, -root * 2.0], [-root, -root]);
        let wanted = [[2.0, 2.0], [n2[0] - 2.0 * t2[0], n2[1] - 2.0 * t2[1]]];
        assert_near(&corner(&line(0.0), &line(-135.0), 2.0).unwrap(), &wanted);
    }

    #[test]
    fn a_turn_back_goes_around_the_end() {
        let points = corner(&line(0.0), &line(180.0), 2.0).unwrap();
        assert_near(&points, &[[2.0, 2.0], [2.0, -2.0]]);
    }

    #[test]
    fn a_tangent_joint_has_the_normal_as_its_point() {
        assert_near(&corner(&line(30.0), &line(30.0), 4.0).unwrap(), &[[-2.0, 4.0 * libm::cos(30_f64.to_radians())]]);
    }

    #[test]
    fn an_arc_outside_is_reached_along_its_tangent() {
        // From the left into the lower right quarter of a circle about (0, -10), clockwise, at a corner of 45 degrees.
        let root = libm::sqrt(0.5);
        let center = [-10.0 * root, -10.0 * root];
        let behind = Branch { tangent: [root, -root], circle: Some(Circle { center, radius_mm: 12.0 }) };
        let half = libm::tan(22.5_f64.to_radians()) * 2.0;
        let wanted = [[half, 2.0], [2.0 * root, 2.0 * root]];
        assert_near(&corner(&line(0.0), &behind, 2.0).unwrap(), &wanted);
    }

    #[test]
    fn circles_that_do_not_meet_have_no_corner() {
        let circle = |x, radius_mm| Circle { center: [x, 0.0], radius_mm };
        assert_eq!(circles(circle(0.0, 1.0), circle(3.0, 1.0)), None);
        let five = circles(circle(-4.0, 5.0), circle(4.0, 5.0)).unwrap();
        assert!(length(minus(five, [0.0, 3.0])) < 1e-12 || length(minus(five, [0.0, -3.0])) < 1e-12);
        assert_eq!(line_and_circle([0.0, 2.0], [1.0, 0.0], circle(0.0, 1.0)), None);
    }
}
