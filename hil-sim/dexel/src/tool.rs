//! Tools and other solids of revolution, as slabs: parts between two heights, bounded by cones about the axis.
//!
//! The origin is the tool's tip, the axis points from there to the holder.

use super::monotone::MonotonePart;
use super::profile::{Knot, Profile, ProfileError};

pub use super::slab::Slab;

/// Tool as a solid of revolution about its axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    slabs: Vec<Slab>,
    parts: Vec<MonotonePart>,
    /// Radius of the ball whose lower half the slabs below its centre replace, if its upper half is in the slabs above it.
    ball_mm: Option<f64>,
    middle_mm: f64,
    reach_mm: f64,
}

impl Tool {
    /// Tool with the profile `outside` and, for a ring, the profile `inside` of its hole.
    ///
    /// # Errors
    /// A profile has no height, both have different heights, or the hole is wider than the outside.
    pub fn new(outside: &Profile, inside: Option<&Profile>) -> Result<Self, ProfileError> {
        let span_mm = outside.span_mm()?;
        if inside.map_or(Ok(span_mm), Profile::span_mm)? != span_mm {
            return Err(ProfileError::Heights);
        }
        let knots = outside.knots().iter().chain(inside.map_or(&[][..], Profile::knots));
        let mut heights_mm: Vec<f64> = knots.map(|knot| knot.height_mm).collect();
        heights_mm.sort_unstable_by(f64::total_cmp);
        heights_mm.dedup();
        let mut slabs = Vec::new();
        for pair in heights_mm.windows(2) {
            let [low_mm, high_mm] = [pair[0], pair[1]];
            let outer_mm = outside.radii_between(low_mm, high_mm).ok_or(ProfileError::Flat)?;
            let inner_mm = inside.and_then(|inside| inside.radii_between(low_mm, high_mm));
            if inner_mm.is_some_and(|inner| inner[0] > outer_mm[0] || inner[1] > outer_mm[1]) {
                return Err(ProfileError::InsideOut { height_mm: low_mm });
            }
            slabs.push(Slab { heights_mm: [low_mm, high_mm], outer_mm, inner_mm });
        }
        let middle_mm = (span_mm[0] + span_mm[1]) / 2.0;
        let from_middle = |knot: &Knot| libm::hypot(knot.radius_mm, knot.height_mm - middle_mm);
        let reach_mm = outside.knots().iter().map(from_middle).fold(0.0, f64::max);
        let parts = MonotonePart::all(&slabs);
        Ok(Tool { slabs, parts, ball_mm: None, middle_mm, reach_mm })
    }

    /// Flat end mill.
    ///
    /// # Errors
    /// The radius is negative, or the height is not positive; also for all tools below.
    pub fn cylinder(radius_mm: f64, height_mm: f64) -> Result<Self, ProfileError> {
        Tool::new(&edge(radius_mm, 0.0, height_mm, 1.0)?, None)
    }

    /// Ball end mill. On a level the ball is replaced by cones within the tolerance, on other ways only if the mill is lower than the
    /// ball.
    ///
    /// # Errors
    /// The ball is higher than the tool.
    pub fn ball(radius_mm: f64, height_mm: f64, tolerance_mm: f64) -> Result<Self, ProfileError> {
        Tool::bull_nose([radius_mm, radius_mm], height_mm, tolerance_mm)
    }

    /// End mill with a rounded corner; `radii_mm` are the radius of the tool and that of the corner.
    ///
    /// # Errors
    /// The corner is larger than the tool.
    pub fn bull_nose(radii_mm: [f64; 2], height_mm: f64, tolerance_mm: f64) -> Result<Self, ProfileError> {
        let [radius_mm, corner_mm] = radii_mm;
        let tool = Tool::new(&edge(radius_mm, -corner_mm, height_mm, tolerance_mm)?, None)?;
        let is_ball = radius_mm == corner_mm && 2.0 * radius_mm <= height_mm;
        Ok(Tool { ball_mm: is_ball.then_some(radius_mm), ..tool })
    }

    /// Ring of a cup mill; `radii_mm` are the outer and the inner radius, and `corner_mm` is the corner radius at both sides (0: square).
    ///
    /// # Errors
    /// The corners are wider than the ring.
    pub fn ring(radii_mm: [f64; 2], corner_mm: f64, height_mm: f64, tolerance_mm: f64) -> Result<Self, ProfileError> {
        let outside = edge(radii_mm[0], -corner_mm, height_mm, tolerance_mm)?;
        let inside = edge(radii_mm[1], corner_mm, height_mm, tolerance_mm)?;
        Tool::new(&outside, Some(&inside))
    }

    /// Slabs of the tool, from bottom to top: parts between two heights with conical walls.
    pub fn slabs(&self) -> &[Slab] {
        &self.slabs
    }

    /// The tool as a ball at its tip, by its radius, and the slabs above the centre of the ball; as all its slabs if it has no ball.
    pub(super) fn ball_and_slabs(&self) -> (Option<f64>, &[Slab]) {
        let below =
            self.ball_mm.map_or(0, |radius_mm| self.slabs.partition_point(|slab| slab.heights_mm[0] < radius_mm));
        (self.ball_mm, &self.slabs[below..])
    }

    /// Monotone parts of the tool, from bottom to top: groups of slabs whose walls only widen or only narrow.
    pub fn parts(&self) -> &[MonotonePart] {
        &self.parts
    }

    /// Height of the tool's middle above its tip, mm.
    pub fn middle_mm(&self) -> f64 {
        self.middle_mm
    }

    /// Radius of the smallest sphere about the axis point at `middle_mm` that contains the whole tool, mm.
    pub fn reach_mm(&self) -> f64 {
        self.reach_mm
    }

    /// Volume of the slabs, mm3; arcs of the profile count as their chords.
    pub fn volume_mm3(&self) -> f64 {
        self.slabs.iter().map(Slab::volume_mm3).sum()
    }
}

/// A wall with a rounded foot that reaches `foot_mm` to the outside at the bottom.
fn edge(radius_mm: f64, foot_mm: f64, height_mm: f64, tolerance_mm: f64) -> Result<Profile, ProfileError> {
    let corner_mm = foot_mm.abs();
    let start = Profile::from(radius_mm + foot_mm, 0.0, tolerance_mm)?;
    if corner_mm == 0.0 {
        return start.line(radius_mm, height_mm);
    }
    let center = Knot { radius_mm: radius_mm + foot_mm, height_mm: corner_mm };
    start.arc(Knot { radius_mm, height_mm: corner_mm }, center)?.line(radius_mm, height_mm)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn volumes_are_those_of_the_solids() {
        let ring = Tool::ring([5.0, 3.0], 0.0, 2.0, 1e-3).unwrap();
        assert!((ring.volume_mm3() - PI * 16.0 * 2.0).abs() < 1e-12);
        let ball = Tool::ball(5.0, 8.0, 1e-6).unwrap();
        let exact_mm3 = PI * (2.0 / 3.0 * 125.0 + 25.0 * 3.0);
        assert!((0.0..2e-4).contains(&(exact_mm3 - ball.volume_mm3())), "{exact_mm3} {}", ball.volume_mm3());
        // A quarter of a torus of tube 1 about 4, the disc inside it, and the cylinder above.
        let bull = Tool::bull_nose([5.0, 1.0], 2.0, 1e-7).unwrap();
        let exact_mm3 = PI * 16.0 + 2.0 * PI * (PI / 4.0) * (4.0 + 4.0 / (3.0 * PI)) + PI * 25.0;
        assert!((0.0..2e-5).contains(&(exact_mm3 - bull.volume_mm3())), "{exact_mm3} {}", bull.volume_mm3());
    }

    #[test]
    fn nothing_of_a_tool_is_beyond_its_reach() {
        let tool = Tool::cylinder(3.0, 8.0).unwrap();
        assert_eq!((tool.middle_mm(), tool.reach_mm()), (4.0, 5.0));
    }

    #[test]
    fn impossible_tools_are_refused() {
        assert_eq!(Tool::ring([3.0, 5.0], 0.0, 2.0, 0.1), Err(ProfileError::InsideOut { height_mm: 0.0 }));
        assert!(Tool::ring([5.0, 4.0], 0.6, 2.0, 0.1).is_err());
        assert!(Tool::bull_nose([5.0, 6.0], 9.0, 0.1).is_err());
        assert!(Tool::ball(5.0, 4.0, 0.1).is_err());
        assert!(Tool::cylinder(5.0, 0.0).is_err());
        assert!(Tool::cylinder(-5.0, 1.0).is_err());
    }
}
