//! Vectors in the plane of cutter compensation, mm, and points in nanometres.

use arcfeed_nc::motion::{Plane, Pose};
use arcfeed_units::Nm;

/// Vector in the plane, mm.
pub type Vector = [f64; 2];
/// Point in the plane: coordinates along its first and second axis.
pub type Point = [Nm; 2];

/// Sum of two vectors.
pub fn plus([ax, ay]: Vector, [bx, by]: Vector) -> Vector {
    [ax + bx, ay + by]
}

/// Difference of two vectors.
pub fn minus([ax, ay]: Vector, [bx, by]: Vector) -> Vector {
    [ax - bx, ay - by]
}

/// The vector multiplied by a number.
pub fn scaled([x, y]: Vector, by_ratio: f64) -> Vector {
    [x * by_ratio, y * by_ratio]
}

/// Scalar product.
pub fn dot([ax, ay]: Vector, [bx, by]: Vector) -> f64 {
    ax * bx + ay * by
}

/// Cross product: positive if the second vector lies to the left of the first.
pub fn cross([ax, ay]: Vector, [bx, by]: Vector) -> f64 {
    ax * by - ay * bx
}

/// The vector turned by 90 degrees counter-clockwise, that is to the left.
pub fn to_left([x, y]: Vector) -> Vector {
    [-y, x]
}

/// Length of a vector.
pub fn length([x, y]: Vector) -> f64 {
    libm::hypot(x, y)
}

/// Vector of length 1 in the same direction; a zero vector stays zero.
pub fn unit(vector: Vector) -> Vector {
    let length = length(vector);
    if length > 0.0 { scaled(vector, 1.0 / length) } else { vector }
}

/// Sum of two points, nm.
pub fn add([ax, ay]: Point, [bx, by]: Point) -> Point {
    [Nm(ax.0.saturating_add(bx.0)), Nm(ay.0.saturating_add(by.0))]
}

/// Difference of two points, nm.
pub fn subtract([ax, ay]: Point, [bx, by]: Point) -> Point {
    [Nm(ax.0.saturating_sub(bx.0)), Nm(ay.0.saturating_sub(by.0))]
}

/// Vector from one point to another.
pub fn between(from: Point, to: Point) -> Vector {
    subtract(to, from).map(Nm::to_mm)
}

/// The point that `vector` (mm) leads to from `from`.
pub fn at(from: Point, vector: Vector) -> Point {
    add(from, vector.map(Nm::from_mm))
}

/// The coordinates of a pose in a plane.
pub fn in_plane(pose: &Pose, plane: Plane) -> Point {
    let (first, second, _) = plane.axes();
    [first, second].map(|axis| pose.linear.get(axis).copied().unwrap_or_default())
}

/// The pose moved to another point of the plane; all other coordinates stay.
pub fn with_point(mut pose: Pose, plane: Plane, point: Point) -> Pose {
    let (first, second, _) = plane.axes();
    for (axis, value) in [first, second].into_iter().zip(point) {
        if let Some(place) = pose.linear.get_mut(axis) {
            *place = value;
        }
    }
    pose
}
