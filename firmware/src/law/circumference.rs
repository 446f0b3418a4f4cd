//! Constant feed per tooth on the cutting circumference, exact.
//!
//! The tool's centre O runs on the circle (A, rho). Frame at O: y towards A, v = x the direction in which O moves. The
//! cutting circle (radius r0) meets the stock limit at B, u = (B - O)/r0. After one tooth the circle must pass through
//! C = O + (r0 + k a) u, where a is the wanted feed per tooth and k = +1 for the outer, -1 for the inner edge. The new
//! centre O' lies on (A, rho) and r0 away from C:
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
//! cancellation that costs the source's own route 8.5 % in f32; valid for p > 0, p = 0 and p < 0 alike. B is the
//! intersection with u.(A - O) >= 0 and k ux > 0, of two the one with the thicker chip (smaller path).
//!
//! Source: Petean 2004, ch. 5; docs/laws.md#circumference for the derivation, the errata and the validity.

use arcfeed_shared::cut::StockLine;
use arcfeed_shared::fmath;
use arcfeed_shared::segment::Arc;
use arcfeed_shared::tool::Edge;
use arcfeed_shared::units::{Mm, MmPerTooth, Nm};

use super::{FeedLaw, NoWish, Wish};

/// Below this square of tau / 2 rho the arc tangent's series of three terms is exact to f32.
const SERIES_LIMIT: f32 = 1e-3;

/// The law for one arc. All lengths relative to the rotation centre A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circumference {
    cut: Cut,
    /// +1 if O turns counter-clockwise about A, -1 if clockwise.
    turn: f32,
    /// Unit normal of the stock line.
    normal: [f32; 2],
    /// Distance of the stock line from A along the normal.
    offset_mm: f32,
}

/// The circles and the chip: everything the step per tooth depends on, but for the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// rho, radius of the centre's path about A.
    pub path_radius: Mm,
    /// r0, radius of the cutting circle.
    pub edge_radius: Mm,
    /// Which edge cuts: the sign k.
    pub edge: Edge,
    /// a, wanted feed per tooth on the circumference.
    pub feed_per_tooth: MmPerTooth,
}

impl Circumference {
    /// Prepares the law for an arc; the one place with f64, once per block.
    pub fn for_arc(arc: &Arc, edge_radius: Mm, edge: Edge, stock: &StockLine, feed_per_tooth: MmPerTooth) -> Self {
        let [nx, ny] = stock.normal;
        Circumference {
            cut: Cut { path_radius: Mm(arc.radius_mm() as f32), edge_radius, edge, feed_per_tooth },
            turn: f32::from(arc.turn.sign()),
            normal: [nx as f32, ny as f32],
            offset_mm: stock.distance_mm(arc.center.map(Nm::to_mm)) as f32,
        }
    }

    /// The wish at one of the two intersections, u in the plane's axes.
    fn wish_at(&self, direction: [f32; 2], u: [f32; 2]) -> Result<Wish, NoWish> {
        let ([ex, ey], [ux_plane, uy_plane]) = (direction, u);
        let along = self.turn * (uy_plane * ex - ux_plane * ey);
        let towards = -(ux_plane * ex + uy_plane * ey);
        let advance = f32::from(self.cut.edge.advance()) * along;
        if towards < 0.0 || advance <= 0.0 {
            return Err(NoWish::OutsideValidity);
        }
        let path_mm_per_tooth = self.cut.path_per_tooth(along, towards)?.0;
        Ok(Wish { path_mm_per_tooth, contact_rad: fmath::atan2(advance, towards) })
    }
}

impl FeedLaw for Circumference {
    fn wish(&self, direction: [f32; 2]) -> Result<Wish, NoWish> {
        let ([ex, ey], [nx, ny]) = (direction, self.normal);
        let (rho_mm, r0_mm) = (self.cut.path_radius.0, self.cut.edge_radius.0);
        let distance_mm = self.offset_mm - rho_mm * (nx * ex + ny * ey);
        let half_chord_squared = (r0_mm - distance_mm) * (r0_mm + distance_mm);
        // Not "not positive": NaN goes on to be refused by name.
        if half_chord_squared < 0.0 && r0_mm > 0.0 {
            return Err(NoWish::NoContact);
        }
        let along_normal = distance_mm / r0_mm;
        let along_line = fmath::sqrt(half_chord_squared) / r0_mm;
        let u = |side: f32| [along_normal * nx - side * along_line * ny, along_normal * ny + side * along_line * nx];
        thicker_chip(self.wish_at(direction, u(1.0)), self.wish_at(direction, u(-1.0)))
    }
}

impl Cut {
    /// Path of the centre per tooth, along its arc, for a contact in direction u of the moving frame:
    /// `along_ratio` = u.v, `towards_ratio` = u.(A - O)/rho.
    ///
    /// # Errors
    /// [`NoWish::OutsideValidity`] where the edge does not advance, [`NoWish::ChipUnreachable`] where no step gives
    /// the wanted chip, [`NoWish::BadInput`] for NaN, non-positive radii or feed per tooth, and an inner edge smaller than its chip.
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

/// Of the two intersections the one that takes the thicker chip; where only one is admissible, that one.
fn thicker_chip(one: Result<Wish, NoWish>, other: Result<Wish, NoWish>) -> Result<Wish, NoWish> {
    match (one, other) {
        (Ok(a), Ok(b)) => Ok(if b.path_mm_per_tooth < a.path_mm_per_tooth { b } else { a }),
        (Ok(wish), Err(_)) | (Err(_), Ok(wish)) => Ok(wish),
        (Err(a), Err(b)) => Err(if a == NoWish::OutsideValidity { b } else { a }),
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
