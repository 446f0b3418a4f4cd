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

use super::prepared::PreparedCut;
use super::{FeedLaw, NoWish, Wish};

/// The law for one arc. All lengths relative to the rotation centre A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circumference {
    cut: PreparedCut,
    path_radius_mm: f32,
    edge_radius_mm: f32,
    /// k, times -1 if O turns clockwise about A.
    sense: f32,
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

/// An admissible intersection of cutting circle and stock line.
#[derive(Clone, Copy, Debug)]
struct Contact {
    bite_mm: f32,
    /// u: along the edge's advance, towards A.
    direction: [f32; 2],
}

impl Circumference {
    /// Prepares the law for an arc; the one place with f64, once per block.
    pub fn for_arc(arc: &Arc, edge_radius: Mm, edge: Edge, stock: &StockLine, feed_per_tooth: MmPerTooth) -> Self {
        let [nx, ny] = stock.normal;
        let cut = Cut { path_radius: Mm(arc.radius_mm() as f32), edge_radius, edge, feed_per_tooth };
        Circumference {
            cut: PreparedCut::new(&cut),
            path_radius_mm: cut.path_radius.0,
            // NaN is refused at the end of every tick, by name.
            edge_radius_mm: if edge_radius.0 > 0.0 { edge_radius.0 } else { f32::NAN },
            sense: f32::from(edge.advance()) * f32::from(arc.turn.sign()),
            normal: [nx as f32, ny as f32],
            offset_mm: stock.distance_mm(arc.center.map(Nm::to_mm)) as f32,
        }
    }

    /// Of the two intersections, at `(advance, towards) +- (line_advance, -line_towards)` mm in the moving frame, the one
    /// that takes the thicker chip; where only one is admissible, that one.
    #[cold]
    #[inline(never)]
    fn thicker_chip(
        &self,
        advance: f32,
        towards: f32,
        line_advance: f32,
        line_towards: f32,
    ) -> Result<Contact, NoWish> {
        let first = self.contact([advance + line_advance, towards - line_towards]);
        let second = self.contact([advance - line_advance, towards + line_towards]);
        match (first, second) {
            (Ok(a), Ok(b)) => Ok(if b.bite_mm > a.bite_mm { b } else { a }),
            (Ok(contact), Err(_)) | (Err(_), Ok(contact)) => Ok(contact),
            (Err(a), Err(b)) => Err(if a == NoWish::OutsideValidity { b } else { a }),
        }
    }

    fn contact(&self, direction: [f32; 2]) -> Result<Contact, NoWish> {
        let [advance, towards] = direction;
        if towards < 0.0 {
            return Err(NoWish::OutsideValidity);
        }
        Ok(Contact { bite_mm: self.cut.bite_mm(advance, towards)?, direction })
    }
}

impl FeedLaw for Circumference {
    #[inline]
    fn wish(&self, direction: [f32; 2]) -> Result<Wish, NoWish> {
        let ([ex, ey], [nx, ny]) = (direction, self.normal);
        // The line's normal in the moving frame: once, and both intersections follow by signs.
        let normal_advance = self.sense * (ny * ex - nx * ey);
        let normal_towards = -(nx * ex + ny * ey);
        let distance_mm = self.offset_mm + self.path_radius_mm * normal_towards;
        let r0_mm = self.edge_radius_mm;
        let half_chord_squared = (r0_mm - distance_mm) * (r0_mm + distance_mm);
        // Not "not positive": NaN goes on to be refused by name.
        if half_chord_squared < 0.0 {
            return Err(NoWish::NoContact);
        }
        let half_chord_mm = fmath::sqrt(half_chord_squared);
        // The sign that puts the intersection that advances more first.
        let half_chord_mm = if normal_towards < 0.0 { -half_chord_mm } else { half_chord_mm };
        let (advance, towards) = (distance_mm * normal_advance, distance_mm * normal_towards);
        let (line_advance, line_towards) = (half_chord_mm * normal_towards, half_chord_mm * normal_advance);
        let first = [advance + line_advance, towards - line_towards];
        let Contact { bite_mm, direction } = if self.cut.is_thickest_before(first) {
            Contact { bite_mm: self.cut.advancing_bite_mm(first)?, direction: first }
        } else {
            self.thicker_chip(advance, towards, line_advance, line_towards)?
        };
        Ok(Wish { path_mm_per_tooth: self.cut.path_per_tooth(bite_mm)?.0, contact: direction })
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
        let cut = PreparedCut::new(self);
        let (advance, r0) = (f32::from(self.edge.advance()) * along_ratio, self.edge_radius.0);
        cut.path_per_tooth(cut.bite_mm(advance * r0, towards_ratio * r0)?)
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
