//! Engagement law: constant chip thickness of an ordinary end mill, with radial chip thinning on lines, and the larger
//! engagement in inside corners and arcs.
//!
//! With tool radius r, radial depth ae, contour radius Rc (path radius q = Rc - r) and a corner of angle b:
//!
//! ```text
//! straight:  phi_s = acos(1 - ae/r)                                                      (1)
//! thinning:  f = a / sin(phi_s) below half engagement, a from there on                   (2)
//! long arc:  phi_c = acos(1 - ae (2 Rc - ae)/(2 q r)), previous pass concentric          (3)
//!            reached once the arc is longer than psi,
//!            cos(psi) = ((Rc - ae)^2 + q^2 - r^2)/(2 q (Rc - ae))                        (4)
//! short arc: phi_c = b + acos((Rc - ae - q cos(b))/r)                                    (5)
//! factor:    phi_s / min(phi_c, pi)                                                      (6)
//! ```
//!
//! (6) with b = 90 degrees reproduces 46 of the 50 published corner factors to 0.01; the other four are the known
//! misprints. Outside arcs engage less; the law does not speed them up.
//!
//! Source: docs/laws.md#engagement (Sandvik Coromant's corner table; geometry ours).

use core::f32::consts::PI;

use arcfeed_units::fmath;
use arcfeed_units::{Mm, MmPerTooth};

use super::{FeedDemand, FeedLaw, NoDemand, Place};

/// Shape of the tool's path, as far as it changes the engagement of an end mill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathShape {
    /// A straight pass, or an arc around the outside of a contour, which counts as straight.
    Straight,
    /// An arc inside a contour, on which the engagement is larger.
    Inside {
        /// Radius of the contour, Rc.
        contour_radius: Mm,
        /// b: angle of the arc, radians.
        turn_rad: f32,
    },
}

/// Engagement law prepared for one segment of an end mill: keeps the largest chip thickness at the target. Its demand
/// is the same everywhere on the segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Engagement {
    demand: Result<FeedDemand, NoDemand>,
}

impl Engagement {
    /// Prepares the law for this tool radius (r), radial depth of cut (ae) and largest chip thickness (a).
    pub fn new(tool_radius: Mm, radial_depth: Mm, chip: MmPerTooth, shape: PathShape) -> Self {
        Engagement { demand: demand(tool_radius.0, radial_depth.0, chip.0, shape) }
    }
}

impl FeedLaw for Engagement {
    fn demand(&self, _: &Place) -> Result<FeedDemand, NoDemand> {
        self.demand
    }

    fn is_uniform(&self) -> bool {
        true
    }
}

/// Factor by which the feed of a straight pass is to be multiplied in an inside arc, so that the largest chip
/// thickness stays the same; at most 1. (6)
///
/// # Errors
/// [`NoDemand::BadInput`] for radii and depths that are not positive numbers or a depth above the diameter,
/// [`NoDemand::OutsideValidity`] for a contour into which the tool does not fit.
pub fn corner_factor(tool_radius: Mm, radial_depth: Mm, contour_radius: Mm, turn_rad: f32) -> Result<f32, NoDemand> {
    let (r, ae, rc) = (tool_radius.0, radial_depth.0, contour_radius.0);
    let straight_rad = straight_rad(r, ae)?;
    if !(rc > 0.0 && rc.is_finite() && turn_rad >= 0.0 && turn_rad.is_finite()) {
        return Err(NoDemand::BadInput);
    }
    let q = rc - r;
    if q < 0.0 {
        return Err(NoDemand::OutsideValidity);
    }
    Ok(straight_rad / largest_engagement_rad(r, ae, q, turn_rad).max(straight_rad))
}

fn demand(r: f32, ae: f32, a: f32, shape: PathShape) -> Result<FeedDemand, NoDemand> {
    straight_rad(r, ae)?;
    if !(a > 0.0 && a.is_finite()) {
        return Err(NoDemand::BadInput);
    }
    // The thickest chip is at phi_s or, from half engagement on, perpendicular to the motion.
    let cosine = (1.0 - ae / r).max(0.0);
    let thinning = fmath::sqrt((1.0 - cosine) * (1.0 + cosine)); // sin(phi_s)
    let factor = match shape {
        PathShape::Straight => 1.0,
        PathShape::Inside { contour_radius, turn_rad } => corner_factor(Mm(r), Mm(ae), contour_radius, turn_rad)?,
    };
    let path_mm_per_tooth = a / thinning * factor; // (2)
    if path_mm_per_tooth > 0.0 && path_mm_per_tooth.is_finite() {
        Ok(FeedDemand { path_mm_per_tooth, contact: [thinning, -cosine] })
    } else {
        Err(NoDemand::BadInput)
    }
}

/// (1)
fn straight_rad(r: f32, ae: f32) -> Result<f32, NoDemand> {
    if !(r > 0.0 && r.is_finite() && ae > 0.0 && ae <= 2.0 * r) {
        return Err(NoDemand::BadInput);
    }
    Ok(fmath::acos(1.0 - ae / r))
}

fn largest_engagement_rad(r: f32, ae: f32, q: f32, turn_rad: f32) -> f32 {
    let previous = q + r - ae;
    let psi_cosine = (previous * previous + q * q - r * r) / (2.0 * q * previous); // (4)
    let reaches = previous > 0.0 && psi_cosine.abs() <= 1.0 && fmath::acos(psi_cosine) <= turn_rad;
    let engaged_rad = if reaches {
        fmath::acos((1.0 - ae * (q + r + previous) / (2.0 * q * r)).clamp(-1.0, 1.0)) // (3)
    } else {
        turn_rad + fmath::acos(((previous - q * fmath::cos(turn_rad)) / r).clamp(-1.0, 1.0)) // (5)
    };
    engaged_rad.min(PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::FRAC_PI_2;

    fn feed(ae: f32, shape: PathShape) -> Result<f32, NoDemand> {
        Engagement::new(Mm(5.0), Mm(ae), MmPerTooth(0.1), shape).demand.map(|demand| demand.path_mm_per_tooth)
    }

    #[test]
    fn light_cut_gets_more_feed_per_tooth_and_a_full_slot_exactly_the_chip() {
        assert!((feed(1.0, PathShape::Straight).unwrap() - 0.1 / 0.6).abs() < 1e-7);
        assert_eq!(feed(5.0, PathShape::Straight), Ok(0.1));
        assert_eq!(feed(10.0, PathShape::Straight), Ok(0.1));
    }

    #[test]
    fn the_tighter_the_corner_the_less_feed() {
        let factors =
            [100.0, 20.0, 10.0, 6.0, 5.0].map(|radius| corner_factor(Mm(5.0), Mm(1.0), Mm(radius), FRAC_PI_2).unwrap());
        assert!(factors.is_sorted_by(|wide, tight| wide > tight), "{factors:?}");
    }

    #[test]
    fn a_short_arc_engages_less_than_a_long_one() {
        let factor = |turn_rad| corner_factor(Mm(5.0), Mm(1.0), Mm(6.0), turn_rad).unwrap();
        assert!(factor(0.05) > factor(0.3) && factor(0.3) > factor(2.0));
        assert!((factor(0.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let factor = |ae, radius| corner_factor(Mm(5.0), Mm(ae), Mm(radius), FRAC_PI_2);
        assert_eq!(factor(1.0, 4.9), Err(NoDemand::OutsideValidity));
        assert_eq!(factor(10.1, 20.0), Err(NoDemand::BadInput));
        assert_eq!(factor(f32::NAN, 20.0), Err(NoDemand::BadInput));
        assert_eq!(feed(-1.0, PathShape::Straight), Err(NoDemand::BadInput));
    }
}
