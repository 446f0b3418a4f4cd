//! Three-dimensional vectors for kinematic chains.
//!
//! ```text
//! turned:   v cos q + (u x v) sin q + u (u.v) (1 - cos q)          (1)
//! between:  2 atan2(|v - w|, |v + w|)                              (2)
//! ```
//!
//! Source: (1) Rodrigues; (2) W. Kahan, the angle of two unit vectors without cancellation at 0 and 180 degrees.

/// A point (mm) or a direction: x, y, z.
pub type Vector = [f64; 3];

/// Scalar product, v.w.
#[inline]
pub fn dot(v: Vector, w: Vector) -> f64 {
    v[0] * w[0] + v[1] * w[1] + v[2] * w[2]
}

/// Vector product, v x w.
#[inline]
pub fn cross(v: Vector, w: Vector) -> Vector {
    [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]]
}

/// Sum, v + w.
#[inline]
pub fn sum(v: Vector, w: Vector) -> Vector {
    [v[0] + w[0], v[1] + w[1], v[2] + w[2]]
}

/// Difference, v - w.
#[inline]
pub fn difference(v: Vector, w: Vector) -> Vector {
    [v[0] - w[0], v[1] - w[1], v[2] - w[2]]
}

/// The vector times a number.
#[inline]
pub fn scaled(v: Vector, by_ratio: f64) -> Vector {
    v.map(|component| component * by_ratio)
}

/// Length, |v|.
#[inline]
pub fn length(v: Vector) -> f64 {
    libm::sqrt(dot(v, v))
}

/// Vector of length 1 in the direction of v: v / |v|. `None` for a zero vector and for vectors that are not finite.
pub fn unit(v: Vector) -> Option<Vector> {
    let length = length(v);
    (length > 0.0 && length.is_finite()).then(|| v.map(|component| component / length))
}

/// v rotated about the unit vector u by the right-hand rule. (1)
pub fn turned(v: Vector, u: Vector, by_deg: f64) -> Vector {
    let (sin, cos) = libm::sincos(by_deg.to_radians());
    sum(sum(scaled(v, cos), scaled(cross(u, v), sin)), scaled(u, dot(u, v) * (1.0 - cos)))
}

/// Angle between two unit vectors, 0 to 180 degrees. (2)
pub fn angle_deg(v: Vector, w: Vector) -> f64 {
    (2.0 * libm::atan2(length(difference(v, w)), length(sum(v, w)))).to_degrees()
}

/// Unit vector at this fraction of the shortest rotation from v to w (0 at v, 1 at w); `None` for opposite vectors.
pub fn along_arc(v: Vector, w: Vector, part_ratio: f64) -> Option<Vector> {
    let Some(about) = unit(cross(v, w)) else {
        return (dot(v, w) > 0.0).then_some(v);
    };
    unit(turned(v, about, angle_deg(v, w) * part_ratio))
}

/// Angle between a unit vector and the nearest direction on the shortest rotation from v to w.
pub fn off_arc_deg(direction: Vector, v: Vector, w: Vector) -> f64 {
    let ends = angle_deg(direction, v).min(angle_deg(direction, w));
    let Some(normal) = unit(cross(v, w)) else { return ends };
    let is_abreast = dot(cross(normal, v), direction) >= 0.0 && dot(cross(w, normal), direction) >= 0.0;
    if !is_abreast {
        return ends;
    }
    let across = dot(normal, direction);
    libm::fabs(libm::asin(across.clamp(-1.0, 1.0)).to_degrees()).min(ends)
}

/// The angle minus whole turns, in (-180, 180].
pub fn wrapped_deg(angle_deg: f64) -> f64 {
    angle_deg - TURN_DEG * libm::ceil((angle_deg - HALF_TURN_DEG) / TURN_DEG)
}

/// A whole turn, degrees.
pub const TURN_DEG: f64 = 360.0;
/// Half a turn, degrees.
pub const HALF_TURN_DEG: f64 = 180.0;

#[cfg(test)]
mod tests {
    use super::*;

    const X: Vector = [1.0, 0.0, 0.0];
    const Y: Vector = [0.0, 1.0, 0.0];
    const Z: Vector = [0.0, 0.0, 1.0];

    #[test]
    fn a_turn_follows_the_right_hand() {
        for (from, about, to) in [(X, Z, Y), (Y, X, Z), (Z, Y, X)] {
            assert!(length(difference(turned(from, about, 90.0), to)) < 1e-15);
        }
    }

    #[test]
    fn small_angles_keep_their_digits() {
        let tilted = turned(Z, X, 1e-9);
        assert!((angle_deg(Z, tilted) / 1e-9 - 1.0).abs() < 1e-12);
        assert_eq!(angle_deg(X, [-1.0, 0.0, 0.0]), HALF_TURN_DEG);
    }

    #[test]
    fn half_of_an_arc_is_half_of_its_angle() {
        let half = along_arc(X, Y, 0.5).unwrap();
        assert!((angle_deg(X, half) - 45.0).abs() < 1e-13 && (angle_deg(Y, half) - 45.0).abs() < 1e-13);
        assert_eq!(along_arc(X, [-1.0, 0.0, 0.0], 0.5), None);
        assert_eq!(along_arc(X, X, 0.5), Some(X));
    }

    #[test]
    fn what_lies_behind_an_end_counts_from_that_end() {
        assert!((off_arc_deg(turned(X, Z, 45.0), X, Y)).abs() < 1e-12);
        assert!((off_arc_deg(Z, X, Y) - 90.0).abs() < 1e-12);
        assert!((off_arc_deg(turned(X, Z, -10.0), X, Y) - 10.0).abs() < 1e-12);
    }

    #[test]
    fn whole_turns_are_left_out() {
        for (angle, expected) in [(180.0, 180.0), (-180.0, 180.0), (181.0, -179.0), (-540.0, 180.0), (725.0, 5.0)] {
            assert_eq!(wrapped_deg(angle), expected);
        }
    }
}
