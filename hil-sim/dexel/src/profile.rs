//! Profile of a solid of revolution: lines and arcs in the plane of radius and height, from the lowest point to the highest.
//!
//! An arc is replaced by chords with their ends on the arc. For a chord over the angle a, on the radius r, the distance
//!
//! ```text
//! r (1 - cos(a/2)) <= tolerance        (1)
//! ```
//!
//! lies between chord and arc, so a convex profile loses at most the tolerance and gains nothing.
//!
//! Source: (1) the sagitta of a chord.

use std::fmt;

/// Chords an arc may have: a tolerance below that is a mistake.
const CHORDS_MAX: f64 = 4_096.0;

/// Largest distance of an arc's end from the circle through its start, as a fraction of the radius.
const ROUND_RATIO: f64 = 1e-9;

/// Vertex of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// Distance from the axis of revolution.
    pub radius_mm: f64,
    /// Coordinate along the axis of revolution.
    pub height_mm: f64,
}

/// Reason why a profile, or the tool of two profiles, is invalid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProfileError {
    /// A point is lower than the one before it, has a negative radius, or is not finite.
    Point(Knot),
    /// The ends of an arc are not at the same distance from its centre, or it has no length.
    Arc {
        /// End point of the arc.
        to: Knot,
        /// Centre of the arc.
        center: Knot,
    },
    /// The tolerance is not positive, or so small that an arc would take more than 4096 chords.
    Tolerance {
        /// Rejected tolerance.
        tolerance_mm: f64,
    },
    /// The profiles of the outside and of the hole do not begin and end at the same heights.
    Heights,
    /// The hole is wider than the outside at some height.
    InsideOut {
        /// Lower end of the heights at which it is wider.
        height_mm: f64,
    },
    /// The profile's first and last point have the same height.
    Flat,
}

impl fmt::Display for ProfileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = |knot: &Knot| format!("(radius {} mm, height {} mm)", knot.radius_mm, knot.height_mm);
        match self {
            ProfileError::Point(knot) => {
                write!(f, "the outline goes to {}: it must rise, on one side of the axis", at(knot))
            }
            ProfileError::Arc { to, center } => {
                write!(f, "no arc of at most half a turn about {} ends at {}", at(center), at(to))
            }
            ProfileError::Tolerance { tolerance_mm } => {
                write!(f, "{tolerance_mm} mm is no tolerance that chords of an arc can keep")
            }
            ProfileError::Heights => write!(f, "outside and inside must begin and end at the same heights"),
            ProfileError::InsideOut { height_mm } => {
                write!(f, "the inside lies outside of the outside at a height of {height_mm} mm")
            }
            ProfileError::Flat => write!(f, "the outline has no height"),
        }
    }
}

impl std::error::Error for ProfileError {}

/// Outline of a solid of revolution in the plane of radius and height, from the lowest point to the highest.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    knots: Vec<Knot>,
    tolerance_mm: f64,
}

impl Profile {
    /// Begins a profile at its lowest point; arcs added later become chords within `tolerance_mm`.
    ///
    /// # Errors
    /// The radius is negative, a coordinate is not finite, or the tolerance is not positive.
    pub fn from(radius_mm: f64, height_mm: f64, tolerance_mm: f64) -> Result<Self, ProfileError> {
        let first = Knot { radius_mm, height_mm };
        if !(tolerance_mm > 0.0 && tolerance_mm.is_finite()) {
            return Err(ProfileError::Tolerance { tolerance_mm });
        }
        let profile = Profile { knots: Vec::new(), tolerance_mm };
        profile.with(first)
    }

    /// Continues the profile by a straight line to this point.
    ///
    /// # Errors
    /// The point is lower than the last one, or its radius is negative.
    pub fn line(self, radius_mm: f64, height_mm: f64) -> Result<Self, ProfileError> {
        self.with(Knot { radius_mm, height_mm })
    }

    /// Continues the profile by the shorter arc about `center` from the last point to `to`, as chords. (1)
    ///
    /// # Errors
    /// There is no such arc, it leads down or to a negative radius, or it takes more than 4096 chords.
    pub fn arc(mut self, to: Knot, center: Knot) -> Result<Self, ProfileError> {
        let no_arc = ProfileError::Arc { to, center };
        let from = *self.knots.last().ok_or(no_arc)?;
        let arm = |knot: Knot| [knot.radius_mm - center.radius_mm, knot.height_mm - center.height_mm];
        let (a, b) = (arm(from), arm(to));
        let radius_mm = libm::hypot(a[0], a[1]);
        let angle_rad = libm::atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
        let off_mm = (libm::hypot(b[0], b[1]) - radius_mm).abs();
        if !(off_mm <= ROUND_RATIO * radius_mm && angle_rad != 0.0) {
            return Err(no_arc);
        }
        let chord_rad = 2.0 * libm::acos((1.0 - self.tolerance_mm / radius_mm).max(0.0)); // (1)
        let chords = (angle_rad.abs() / chord_rad).ceil();
        if chords > CHORDS_MAX {
            return Err(ProfileError::Tolerance { tolerance_mm: self.tolerance_mm });
        }
        for chord in 1..chords as usize {
            let (sin, cos) = libm::sincos(angle_rad * chord as f64 / chords);
            self = self.with(Knot {
                radius_mm: center.radius_mm + a[0] * cos - a[1] * sin,
                height_mm: center.height_mm + a[0] * sin + a[1] * cos,
            })?;
        }
        self.with(to)
    }

    /// Vertices of the profile, from bottom to top.
    pub fn knots(&self) -> &[Knot] {
        &self.knots
    }

    /// Heights of the profile's first and last point, mm.
    ///
    /// # Errors
    /// Both heights are the same.
    pub fn span_mm(&self) -> Result<[f64; 2], ProfileError> {
        match (self.knots.first(), self.knots.last()) {
            (Some(a), Some(b)) if a.height_mm < b.height_mm => Ok([a.height_mm, b.height_mm]),
            _ => Err(ProfileError::Flat),
        }
    }

    /// Radii just above the height `low_mm` and just below `high_mm`; `None` if there is a vertex between them, or the profile does not
    /// reach over both.
    pub fn radii_between(&self, low_mm: f64, high_mm: f64) -> Option<[f64; 2]> {
        let piece = self.knots.windows(2).find(|w| w[0].height_mm <= low_mm && w[1].height_mm >= high_mm)?;
        let [a, b] = [piece[0], piece[1]];
        let per_mm = (b.radius_mm - a.radius_mm) / (b.height_mm - a.height_mm);
        // The ends of a piece are its knots to the bit: neighbours meet without a step.
        let at = |height_mm: f64| match height_mm {
            h if h == a.height_mm => a.radius_mm,
            h if h == b.height_mm => b.radius_mm,
            h => a.radius_mm + (h - a.height_mm) * per_mm,
        };
        Some([at(low_mm), at(high_mm)])
    }

    fn with(mut self, knot: Knot) -> Result<Self, ProfileError> {
        let rises = self.knots.last().is_none_or(|last| knot.height_mm >= last.height_mm);
        if !(rises && knot.radius_mm >= 0.0 && knot.radius_mm.is_finite() && knot.height_mm.is_finite()) {
            return Err(ProfileError::Point(knot));
        }
        self.knots.push(knot);
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knot(radius_mm: f64, height_mm: f64) -> Knot {
        Knot { radius_mm, height_mm }
    }

    #[test]
    fn chords_stay_within_the_tolerance_of_their_arc() {
        for tolerance_mm in [0.3, 0.01, 1e-5] {
            let ball = Profile::from(0.0, 0.0, tolerance_mm).unwrap().arc(knot(5.0, 5.0), knot(0.0, 5.0)).unwrap();
            for pair in ball.knots().windows(2) {
                let [a, b] = [pair[0], pair[1]];
                let middle = libm::hypot((a.radius_mm + b.radius_mm) / 2.0, (a.height_mm + b.height_mm) / 2.0 - 5.0);
                assert!((0.0..=tolerance_mm).contains(&(5.0 - middle)), "{tolerance_mm} {middle}");
            }
        }
    }

    #[test]
    fn between_knots_the_radius_is_linear_and_at_a_step_one_sided() {
        let stepped = Profile::from(1.0, 0.0, 0.1).unwrap();
        let stepped = stepped.line(2.0, 1.0).unwrap().line(4.0, 1.0).unwrap().line(4.0, 3.0).unwrap();
        assert_eq!(stepped.radii_between(0.0, 1.0), Some([1.0, 2.0]));
        assert_eq!(stepped.radii_between(0.5, 1.0), Some([1.5, 2.0]));
        assert_eq!(stepped.radii_between(1.0, 2.0), Some([4.0, 4.0]));
        assert_eq!(stepped.radii_between(0.5, 2.0), None);
    }

    #[test]
    fn outlines_that_go_down_or_across_the_axis_are_refused() {
        let start = || Profile::from(1.0, 0.0, 0.1).unwrap();
        assert_eq!(start().line(1.0, -0.1), Err(ProfileError::Point(knot(1.0, -0.1))));
        assert_eq!(start().line(-1.0, 1.0), Err(ProfileError::Point(knot(-1.0, 1.0))));
        assert!(matches!(start().arc(knot(2.5, 1.0), knot(1.0, 1.0)), Err(ProfileError::Arc { .. })));
        assert!(matches!(Profile::from(1.0, 0.0, 0.0), Err(ProfileError::Tolerance { .. })));
    }
}
