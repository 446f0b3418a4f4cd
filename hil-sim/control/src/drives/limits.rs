//! Limits of the axes, and the resulting limits along a path.
//!
//! Along a path q(p) an axis has the speed q' v, the acceleration q'' v^2 + q' a and the jerk q''' v^3 + 3 q'' v a + q'
//! j, with v, a, j those of p. On a part of the path with the largest |q'|, |q''|, |q'''| these stay within V, A, J
//! with
//!
//! ```text
//! v <= V/|q'|    v^2 <= A/2|q''|    v^3 <= J/4|q'''|                   (1)
//! a <= (A - |q''| v^2)/|q'|         a <= J/(12 |q''| v)                (2)
//! j <= (J - |q'''| v^3 - 3 |q''| v a)/|q'|                             (3)
//! ```
//!
//! for all axes. On a straight line q'' and q''' vanish, and the path has all of A and J; else it has at least half.
//!
//! Source: the constraints are those of Beudaert, Lavernhe, Tournier, Feedrate interpolation with axis jerk constraints on
//! 5-axis NURBS and G1 tool path, Int. J. Machine Tools & Manufacture 57 (2012); the shares are ours.

/// X, Y, Z, A, B, C.
pub const AXES: usize = 6;
/// Fraction of A that curvature may use, and of J that the third derivative may use, (1).
const SHARE_OF_ACCELERATION: f64 = 0.5;
const SHARE_OF_JERK: f64 = 0.5;
const CROSS_SHARE: f64 = 0.25;

/// Limits of one axis; for a rotary axis the fields are in degrees instead of mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Greatest speed.
    pub speed_mm_per_s: f64,
    /// Greatest acceleration.
    pub acceleration_mm_per_s2: f64,
    /// Greatest jerk.
    pub jerk_mm_per_s3: f64,
}

/// Limits of a machine's drives, and how far the axes may deviate at corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// Limits of X, Y, Z, A, B, C.
    pub axes: [AxisLimits; AXES],
    /// Largest distance, mm, of the rounded path from a programmed corner.
    pub tolerance_mm: f64,
    /// Largest distance, degrees, of the rotary axes from a programmed corner.
    pub tolerance_deg: f64,
}

/// Bounds of a path's derivatives: the largest magnitudes, on a part of the path, of the first three derivatives of each axis's
/// position by the path length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bend {
    /// First derivative, |q'|.
    pub first: [f64; AXES],
    /// Second derivative, |q''|.
    pub second: [f64; AXES],
    /// Third derivative, |q'''|.
    pub third: [f64; AXES],
}

/// Limits of speed, acceleration and jerk along a part of a path, in units of its length (mm or degrees) and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathLimits {
    /// Greatest speed.
    pub(crate) speed: f64,
    /// Greatest acceleration, either way.
    pub(crate) acceleration: f64,
    /// Greatest jerk, either way.
    pub(crate) jerk: f64,
    /// The axis that sets the speed, if one does.
    pub(crate) axis: Option<usize>,
}

impl AxisLimits {
    /// No limits: all infinite.
    pub const NONE: AxisLimits = AxisLimits {
        speed_mm_per_s: f64::INFINITY,
        acceleration_mm_per_s2: f64::INFINITY,
        jerk_mm_per_s3: f64::INFINITY,
    };
}

impl DriveLimits {
    /// Limits along a part of a path whose wanted speed is at most `most`. (1) to (3)
    pub(crate) fn along(&self, bend: &Bend, most: f64) -> PathLimits {
        let mut limits = PathLimits { speed: most, acceleration: f64::INFINITY, jerk: f64::INFINITY, axis: None };
        for (index, axis) in self.axes.iter().enumerate() {
            let [first, second, third] = [bend.first[index], bend.second[index], bend.third[index]];
            let speed = [
                axis.speed_mm_per_s / first,
                libm::sqrt(SHARE_OF_ACCELERATION * axis.acceleration_mm_per_s2 / second),
                libm::cbrt(SHARE_OF_JERK * axis.jerk_mm_per_s3 / third),
            ];
            let speed = speed.into_iter().fold(f64::INFINITY, f64::min);
            if speed < limits.speed {
                (limits.speed, limits.axis) = (speed, Some(index));
            }
        }
        let speed = limits.speed;
        for (index, axis) in self.axes.iter().enumerate() {
            let [first, second] = [bend.first[index], bend.second[index]];
            limits.acceleration =
                limits.acceleration.min((axis.acceleration_mm_per_s2 - second * speed * speed) / first);
            limits.acceleration = limits.acceleration.min(CROSS_SHARE * axis.jerk_mm_per_s3 / (3.0 * second * speed));
        }
        for (index, axis) in self.axes.iter().enumerate() {
            let [first, second, third] = [bend.first[index], bend.second[index], bend.third[index]];
            let bending = third * speed * speed * speed + 3.0 * second * speed * limits.acceleration;
            limits.jerk = limits.jerk.min((axis.jerk_mm_per_s3 - bending) / first);
        }
        limits
    }
}

impl Bend {
    /// Bounds that hold for both parts of a path: the larger value for each axis and derivative.
    #[must_use]
    pub fn or(&self, other: &Bend) -> Bend {
        let greater = |one: &[f64; AXES], two: &[f64; AXES]| std::array::from_fn(|axis| one[axis].max(two[axis]));
        Bend {
            first: greater(&self.first, &other.first),
            second: greater(&self.second, &other.second),
            third: greater(&self.third, &other.third),
        }
    }
}

impl PathLimits {
    /// No limit.
    pub(crate) const NONE: PathLimits =
        PathLimits { speed: f64::INFINITY, acceleration: f64::INFINITY, jerk: f64::INFINITY, axis: None };

    /// Limits that satisfy both.
    #[must_use]
    pub(crate) fn and(&self, other: &PathLimits) -> PathLimits {
        PathLimits {
            speed: self.speed.min(other.speed),
            acceleration: self.acceleration.min(other.acceleration),
            jerk: self.jerk.min(other.jerk),
            axis: if other.speed < self.speed { other.axis } else { self.axis },
        }
    }
}
