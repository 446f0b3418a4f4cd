//! Step per tooth: the path of the tool's centre for which its cutting circle takes a chip a at a contact B.
//!
//! The centre O moves on the circle (A, rho), or straight (rho infinite). Frame at O: y towards A, v = x the direction
//! in which O moves. The cutting circle (radius r0) meets the stock at B, u = (B - O)/r0. After one tooth the circle
//! must pass through C = O + (r0 + k a) u, where a is the target feed per tooth and k = +1 for the outer, -1 for the
//! inner edge. The new centre O' lies on (A, rho) at the distance r0 from C:
//!
//! ```text
//! ux = u.v    uy = u.(A - O)/rho    L = r0 + k a    w = a (2 r0 + k a)    (1)
//! h  = L k ux                       h > 0: the edge advances              (2)
//! p  = k (1 - L uy/rho) + w/(4 rho^2)                                     (3)
//! D  = h^2 - p w                    D < 0: chip a cannot be reached       (4)
//! tau = w / (h + sqrt D)            = 2 rho tan(alpha/2)                  (5)
//! path per tooth = rho alpha = 2 rho atan(tau / 2 rho)                    (6)
//! ```
//!
//! (1)-(5) solve the two circles of the source (eqs 17-23) for the half turn alpha/2 of O about A. They avoid the
//! cancellation that causes an error of 8.5 % in f32 in the source's own formulas. They are valid for p > 0, p = 0 and
//! p < 0.
//!
//! Terms that are constant on the segment are computed once, with the contact given as r0 u:
//!
//! ```text
//! h = (L/r0) (k r0 ux)                                       (2)
//! p = (k + w/(4 rho^2)) - (k L/(r0 rho)) (r0 uy)             (3)
//! ```
//!
//! Invalid inputs (NaN, a radius or feed per tooth that is not positive, an inner edge smaller than its chip) become
//! NaN there, which is rejected at the end of every step.
//!
//! Source: Petean 2004, ch. 5; docs/laws.md#circumference for the derivation, the errata and the validity.

use arcfeed_model::tool::Edge;
use arcfeed_units::fmath;
use arcfeed_units::{Mm, MmPerTooth};

use super::NoDemand;

/// Square of a / 2 rho below which three terms of the arc sine's series are exact to f32.
const SERIES_LIMIT: f32 = 1e-3;
/// tau / 2 rho below which two terms of the arc tangent's series are exact to f32.
const SMALL_STEP_RATIO: f32 = 0.01;

/// Geometry and target chip of one cutting circle on a path: everything that the step per tooth depends on except the
/// contact with the stock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// rho: radius of the path of the tool's centre about the rotation centre A; infinite for a straight path.
    pub path_radius: Mm,
    /// r0: radius of the cutting circle.
    pub edge_radius: Mm,
    /// Outer or inner cutting circle; gives the sign k.
    pub edge: Edge,
    /// a: target feed per tooth on the cutting circle.
    pub feed_per_tooth: MmPerTooth,
}

/// Terms of a [`Cut`] that do not depend on the contact; configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedCut {
    /// L/r0.
    reach_ratio: f32,
    /// w, mm^2.
    excess_mm2: f32,
    /// k + w/(4 rho^2).
    curvature_ratio: f32,
    /// k L/(r0 rho), 1/mm.
    closing_per_mm: f32,
    /// 2 rho, mm.
    path_diameter_mm: f32,
    /// 1/(12 rho^2), 1/mm^2.
    per_bend_mm2: f32,
    /// The tau below which two terms of the arc tangent's series are exact to f32, mm.
    small_step_mm: f32,
}

impl Cut {
    /// Path of the tool's centre per tooth, along its arc, at which the chip at a contact is the target. The contact
    /// is the unit vector u from the tool's centre: `along_ratio` is its component in the direction of motion (u.v),
    /// `towards_ratio` the one towards the rotation centre (u.(A - O)/rho).
    ///
    /// # Errors
    /// [`NoDemand::OutsideValidity`] where the edge does not advance, [`NoDemand::ChipUnreachable`] where no step gives
    /// the wanted chip, [`NoDemand::BadInput`] for NaN, non-positive radii or feed per tooth, and an inner edge smaller than its chip.
    pub fn path_per_tooth(&self, along_ratio: f32, towards_ratio: f32) -> Result<Mm, NoDemand> {
        let cut = PreparedCut::new(self);
        let (advance, r0) = (f32::from(self.edge.advance()) * along_ratio, self.edge_radius.0);
        cut.path_per_tooth(cut.denominator_mm(advance * r0, towards_ratio * r0)?)
    }

    /// Path of the tool's centre per tooth whose chord is the target chip: the step for material straight ahead.
    ///
    /// # Errors
    /// [`NoDemand::BadInput`] as above, [`NoDemand::ChipUnreachable`] for a chip thicker than the path's own circle.
    pub fn path_straight_ahead(&self) -> Result<Mm, NoDemand> {
        let (rho, a) = (self.path_radius.0, self.feed_per_tooth.0);
        if !(rho > 0.0 && self.edge_radius.0 > 0.0 && a > 0.0 && a.is_finite()) {
            return Err(NoDemand::BadInput);
        }
        let half_turn_sine = a / (2.0 * rho);
        if half_turn_sine > 1.0 {
            return Err(NoDemand::ChipUnreachable);
        }
        let square = half_turn_sine * half_turn_sine;
        if square < SERIES_LIMIT {
            return Ok(Mm(a * (1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0)))));
        }
        Ok(Mm(2.0 * rho * fmath::asin(half_turn_sine)))
    }
}

impl PreparedCut {
    /// Computes the terms of a cut.
    pub fn new(cut: &Cut) -> Self {
        let (rho, r0, a) = (cut.path_radius.0, cut.edge_radius.0, cut.feed_per_tooth.0);
        let k = f32::from(cut.edge.advance());
        let reach = r0 + k * a; // (1)
        let excess_mm2 = a * (2.0 * r0 + k * a); // (1)
        // The squares must be representable in f32; otherwise the step could become zero.
        let representable = fmath::is_positive(excess_mm2) && fmath::is_positive(reach * reach);
        let possible = rho > 0.0 && r0 > 0.0 && a > 0.0 && reach > 0.0 && representable;
        PreparedCut {
            reach_ratio: if possible { reach / r0 } else { f32::NAN },
            excess_mm2,
            curvature_ratio: k + excess_mm2 / (4.0 * rho * rho),
            closing_per_mm: k * (reach / (r0 * rho)),
            path_diameter_mm: 2.0 * rho,
            per_bend_mm2: 1.0 / (12.0 * rho * rho),
            small_step_mm: 2.0 * rho * SMALL_STEP_RATIO,
        }
    }

    /// k: 1 for the outer circle, whose edges advance outward, -1 for the inner one.
    pub fn edge_sign(&self) -> i8 {
        if self.closing_per_mm < 0.0 { -1 } else { 1 }
    }

    /// a: target feed per tooth, computed back from (1) by the root that loses no digits; NaN for an invalid cut.
    pub fn feed_per_tooth(&self, edge_radius: Mm) -> MmPerTooth {
        let Mm(r0) = edge_radius;
        let k = f32::from(self.edge_sign());
        MmPerTooth(self.excess_mm2 / (r0 + fmath::sqrt(r0 * r0 + k * self.excess_mm2)))
    }

    /// h + sqrt D, mm, the divisor of the step in (5), for the contact at r0 u: `advance_mm` = k r0 u.v, `towards_mm`
    /// = r0 u.(A - O)/rho. A larger value means a thicker chip at a given feed. NaN for invalid input.
    ///
    /// # Errors
    /// [`NoDemand::OutsideValidity`] where the edge does not advance, [`NoDemand::ChipUnreachable`] where no step gives the
    /// wanted chip.
    pub fn denominator_mm(&self, advance_mm: f32, towards_mm: f32) -> Result<f32, NoDemand> {
        if self.reach_ratio * advance_mm <= 0.0 {
            return Err(NoDemand::OutsideValidity);
        }
        let (h, d) = self.advance_and_discriminant([advance_mm, towards_mm]);
        if d < 0.0 { Err(NoDemand::ChipUnreachable) } else { Ok(h + fmath::sqrt(d)) }
    }

    /// h, mm, and D, mm^2.
    fn advance_and_discriminant(&self, [advance_mm, towards_mm]: [f32; 2]) -> (f32, f32) {
        let h = self.reach_ratio * advance_mm; // (2)
        let p = self.curvature_ratio - self.closing_per_mm * towards_mm; // (3)
        (h, h * h - p * self.excess_mm2) // (4)
    }

    /// Path of the tool's centre per tooth, along its arc, from a result of [`PreparedCut::denominator_mm`]. (5), (6)
    ///
    /// # Errors
    /// [`NoDemand::BadInput`] for NaN, and for a step too large or too small for f32.
    pub fn path_per_tooth(&self, denominator_mm: f32) -> Result<Mm, NoDemand> {
        let tau = self.excess_mm2 / denominator_mm; // (5)
        let path = if tau < self.small_step_mm { self.along_narrow_arc(tau) } else { self.along_wide_arc(tau) };
        // False for NaN, which is also the result of an overflow.
        if path > 0.0 { Ok(Mm(path)) } else { Err(NoDemand::BadInput) }
    }

    /// 2 rho atan(tau / 2 rho) = tau (1 - tau^2 / 12 rho^2 + ...). (6)
    fn along_narrow_arc(&self, tau: f32) -> f32 {
        tau - tau * (tau * tau * self.per_bend_mm2)
    }

    fn along_wide_arc(&self, tau: f32) -> f32 {
        let path = self.path_diameter_mm * fmath::atan2(tau, self.path_diameter_mm);
        if path.is_finite() { path } else { f32::NAN }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOVEMENT_2: Cut = Cut {
        path_radius: Mm(128.576),
        edge_radius: Mm(128.576),
        edge: Edge::Outer,
        feed_per_tooth: MmPerTooth(0.1016),
    };

    fn at_deg(cut: Cut, contact_deg: f32) -> Result<f32, NoDemand> {
        let (sin, cos) = libm::sincos(f64::from(contact_deg).to_radians());
        let (along, towards) = (f32::from(cut.edge.advance()) * sin as f32, cos as f32);
        cut.path_per_tooth(along, towards).map(|path| path.0)
    }

    #[test]
    fn square_to_the_path_the_centre_feed_is_the_circumference_feed() {
        let path = at_deg(MOVEMENT_2, 90.0).unwrap();
        assert!((path / 0.1016 - 1.0).abs() < 1e-3, "{path}");
    }

    #[test]
    fn the_flatter_the_contact_the_more_feed() {
        let feeds = [80.0, 60.0, 40.0, 20.0].map(|deg| at_deg(MOVEMENT_2, deg).unwrap());
        assert!(feeds.is_sorted(), "{feeds:?}");
    }

    #[test]
    fn a_straight_path_is_an_arc_without_end() {
        let straight = Cut { path_radius: Mm(f32::INFINITY), ..MOVEMENT_2 };
        let wide = Cut { path_radius: Mm(1e9), ..MOVEMENT_2 };
        for deg in [15.0, 45.0, 90.0, 120.0] {
            assert_eq!(at_deg(straight, deg), at_deg(wide, deg));
        }
        assert_eq!(straight.path_straight_ahead(), Ok(Mm(0.1016)));
    }

    #[test]
    fn straight_ahead_the_chord_is_the_chip() {
        for (rho, a) in [(100.0_f32, 0.1_f32), (5.0, 0.5), (1.0, 0.9), (0.5, 0.99)] {
            let cut = Cut { path_radius: Mm(rho), feed_per_tooth: MmPerTooth(a), ..MOVEMENT_2 };
            let path = f64::from(cut.path_straight_ahead().unwrap().0);
            let chord = 2.0 * f64::from(rho) * libm::sin(path / f64::from(2.0 * rho));
            assert!((chord / f64::from(a) - 1.0).abs() < 5e-7, "{rho} {a}");
        }
        let beyond = Cut { path_radius: Mm(0.4), feed_per_tooth: MmPerTooth(1.0), ..MOVEMENT_2 };
        assert_eq!(beyond.path_straight_ahead(), Err(NoDemand::ChipUnreachable));
    }

    #[test]
    fn what_has_no_solution_says_why() {
        assert_eq!(at_deg(MOVEMENT_2, -5.0), Err(NoDemand::OutsideValidity));
        assert_eq!(at_deg(MOVEMENT_2, f32::NAN), Err(NoDemand::BadInput));
        let inner = Cut { edge: Edge::Inner, feed_per_tooth: MmPerTooth(1e3), ..MOVEMENT_2 };
        assert_eq!(at_deg(inner, 30.0), Err(NoDemand::BadInput));
        for bad in [0.0, -1.0, f32::NAN] {
            assert_eq!(at_deg(Cut { path_radius: Mm(bad), ..MOVEMENT_2 }, 60.0), Err(NoDemand::BadInput));
            assert_eq!(at_deg(Cut { edge_radius: Mm(bad), ..MOVEMENT_2 }, 60.0), Err(NoDemand::BadInput));
            assert_eq!(at_deg(Cut { feed_per_tooth: MmPerTooth(bad), ..MOVEMENT_2 }, 60.0), Err(NoDemand::BadInput));
        }
    }
}
