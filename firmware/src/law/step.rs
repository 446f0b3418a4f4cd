//! The step per tooth: how far the tool's centre moves so that its cutting circle takes a chip a at a contact B.
//!
//! The centre O runs on the circle (A, rho), or straight (rho infinite). Frame at O: y towards A, v = x the direction in
//! which O moves. The cutting circle (radius r0) meets the stock at B, u = (B - O)/r0. After one tooth the circle must
//! pass through C = O + (r0 + k a) u, where a is the wanted feed per tooth and k = +1 for the outer, -1 for the inner
//! edge. The new centre O' lies on (A, rho) and r0 away from C:
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
//! (1)-(5) are the two circles of the source (eqs 17-23) solved for the half turn alpha/2 of O about A, free of the
//! cancellation of the source's own route; valid for p > 0, p = 0 and p < 0 alike.
//!
//! Source: Petean 2004, ch. 5; docs/laws.md#circumference for the derivation and the errata.

use arcfeed_shared::fmath;
use arcfeed_shared::tool::Edge;
use arcfeed_shared::units::{Mm, MmPerTooth};

use super::NoWish;

/// Below this square of tau / 2 rho the arc tangent's series of three terms is exact to f32.
const SERIES_LIMIT: f32 = 1e-3;

/// The circles and the chip: everything the step per tooth depends on, but for the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// rho, radius of the centre's path about A; infinite for a straight path.
    pub path_radius: Mm,
    /// r0, radius of the cutting circle.
    pub edge_radius: Mm,
    /// Which edge cuts: the sign k.
    pub edge: Edge,
    /// a, wanted feed per tooth on the circumference.
    pub feed_per_tooth: MmPerTooth,
}

impl Cut {
    /// Path of the centre per tooth, along its arc, for a contact in direction u of the moving frame:
    /// `along_ratio` = u.v, `towards_ratio` = u.(A - O)/rho.
    ///
    /// # Errors
    /// [`NoWish::OutsideValidity`] where the edge does not advance, [`NoWish::ChipUnreachable`] where no step gives
    /// the wanted chip, [`NoWish::BadInput`] for NaN, non-positive radii or feed per tooth, and an inner edge smaller
    /// than its chip.
    pub fn path_per_tooth(&self, along_ratio: f32, towards_ratio: f32) -> Result<Mm, NoWish> {
        let (rho, r0, a) = (self.path_radius.0, self.edge_radius.0, self.feed_per_tooth.0);
        let k = f32::from(self.edge.advance());
        let reach = r0 + k * a; // (1)
        if !(rho > 0.0 && r0 > 0.0 && a > 0.0 && reach > 0.0) {
            return Err(NoWish::BadInput);
        }
        let w = a * (2.0 * r0 + k * a); // (1)
        let h = reach * k * along_ratio; // (2)
        if h <= 0.0 {
            return Err(NoWish::OutsideValidity);
        }
        let p = k * (1.0 - reach * towards_ratio / rho) + w / (4.0 * rho * rho); // (3)
        let d = h * h - p * w; // (4)
        if d < 0.0 {
            return Err(NoWish::ChipUnreachable);
        }
        let tau = w / (h + fmath::sqrt(d)); // (5)
        let path = path_along_arc(tau, rho); // (6)
        // NaN fails every comparison above and ends here, as do an overflow and a step too small for f32.
        if path > 0.0 && path.is_finite() { Ok(Mm(path)) } else { Err(NoWish::BadInput) }
    }

    /// Path of the centre per tooth whose chord is the wanted chip itself: the step straight into the material.
    ///
    /// # Errors
    /// [`NoWish::BadInput`] as above, [`NoWish::ChipUnreachable`] for a chip thicker than the path's own circle.
    pub fn path_straight_ahead(&self) -> Result<Mm, NoWish> {
        let (rho, a) = (self.path_radius.0, self.feed_per_tooth.0);
        if !(rho > 0.0 && self.edge_radius.0 > 0.0 && a > 0.0 && a.is_finite()) {
            return Err(NoWish::BadInput);
        }
        let half_turn_sine = a / (2.0 * rho);
        if half_turn_sine > 1.0 {
            return Err(NoWish::ChipUnreachable);
        }
        let square = half_turn_sine * half_turn_sine;
        if square < SERIES_LIMIT {
            return Ok(Mm(a * (1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0)))));
        }
        Ok(Mm(2.0 * rho * fmath::asin(half_turn_sine)))
    }
}

/// 2 rho atan(tau / 2 rho). (6)
fn path_along_arc(tau: f32, rho: f32) -> f32 {
    let x = tau / (2.0 * rho);
    let square = x * x;
    if square < SERIES_LIMIT {
        tau * (1.0 - square * (1.0 / 3.0 - square / 5.0))
    } else {
        2.0 * rho * fmath::atan2(x, 1.0)
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

    fn at_deg(cut: Cut, contact_deg: f32) -> Result<f32, NoWish> {
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
        assert_eq!(beyond.path_straight_ahead(), Err(NoWish::ChipUnreachable));
    }

    #[test]
    fn what_has_no_solution_says_why() {
        assert_eq!(at_deg(MOVEMENT_2, -5.0), Err(NoWish::OutsideValidity));
        assert_eq!(at_deg(MOVEMENT_2, f32::NAN), Err(NoWish::BadInput));
        let inner = Cut { edge: Edge::Inner, feed_per_tooth: MmPerTooth(1e3), ..MOVEMENT_2 };
        assert_eq!(at_deg(inner, 30.0), Err(NoWish::BadInput));
        for bad in [0.0, -1.0, f32::NAN] {
            assert_eq!(at_deg(Cut { path_radius: Mm(bad), ..MOVEMENT_2 }, 60.0), Err(NoWish::BadInput));
            assert_eq!(at_deg(Cut { edge_radius: Mm(bad), ..MOVEMENT_2 }, 60.0), Err(NoWish::BadInput));
            assert_eq!(at_deg(Cut { feed_per_tooth: MmPerTooth(bad), ..MOVEMENT_2 }, 60.0), Err(NoWish::BadInput));
        }
    }
}
