//! Constant feed per tooth on the cutting circumference: the chip at the contact B with the stock line is a.
//!
//! B is the intersection of cutting circle and stock line with u.(A - O) >= 0 and an advancing edge, of two the one with
//! the thicker chip (smaller step). With the line n.p = d and q = d - n.O:
//!
//! ```text
//! u = (q n +- sqrt((r0 - q)(r0 + q)) t) / r0,    t square to n        (1)
//! ```
//!
//! The step for it is [`super::step`]'s.
//!
//! Source: Petean 2004, ch. 5, eqs 11-16; docs/laws.md#circumference.

use arcfeed_shared::fmath;
use arcfeed_shared::segment::Arc;
use arcfeed_shared::stock::StockLine;
use arcfeed_shared::tool::Edge;
use arcfeed_shared::units::{Mm, MmPerTooth, Nm};

use super::step::Cut;
use super::{FeedLaw, NoWish, Place, Wish};

/// The law for one arc. All lengths relative to the rotation centre A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circumference {
    cut: Cut,
    /// Unit normal of the stock line.
    normal: [f32; 2],
    /// Distance of the stock line from A along the normal.
    offset_mm: f32,
}

impl Circumference {
    /// Prepares the law for an arc; the one place with f64, once per block.
    pub fn for_arc(arc: &Arc, edge_radius: Mm, edge: Edge, stock: &StockLine, feed_per_tooth: MmPerTooth) -> Self {
        let [nx, ny] = stock.normal;
        Circumference {
            cut: Cut { path_radius: Mm(arc.radius_mm() as f32), edge_radius, edge, feed_per_tooth },
            normal: [nx as f32, ny as f32],
            offset_mm: stock.distance_mm(arc.center.map(Nm::to_mm)) as f32,
        }
    }

    /// The wish at one of the two intersections, u in the plane's axes.
    fn wish_at(&self, place: &Place, u: [f32; 2]) -> Result<Wish, NoWish> {
        let ([ux, uy], [vx, vy], [yx, yy]) = (u, place.motion, place.towards);
        let along = ux * vx + uy * vy;
        let towards = ux * yx + uy * yy;
        let advance = f32::from(self.cut.edge.advance()) * along;
        if towards < 0.0 || advance <= 0.0 {
            return Err(NoWish::OutsideValidity);
        }
        let path_mm_per_tooth = self.cut.path_per_tooth(along, towards)?.0;
        Ok(Wish { path_mm_per_tooth, contact: [advance, towards] })
    }
}

impl FeedLaw for Circumference {
    fn wish(&self, place: &Place) -> Result<Wish, NoWish> {
        let ([x, y], [nx, ny]) = (place.center_mm, self.normal);
        let r0_mm = self.cut.edge_radius.0;
        let distance_mm = self.offset_mm - (nx * x + ny * y);
        let half_chord_squared = (r0_mm - distance_mm) * (r0_mm + distance_mm);
        // Not "not positive": NaN goes on to be refused by name.
        if half_chord_squared < 0.0 && r0_mm > 0.0 {
            return Err(NoWish::NoContact);
        }
        let along_normal = distance_mm / r0_mm;
        let along_line = fmath::sqrt(half_chord_squared) / r0_mm;
        // (1)
        let u = |side: f32| [along_normal * nx - side * along_line * ny, along_normal * ny + side * along_line * nx];
        thicker_chip(self.wish_at(place, u(1.0)), self.wish_at(place, u(-1.0)))
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
